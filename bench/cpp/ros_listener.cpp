// Counts what a world publishes of its robots, in ROS: python bench/ros_bench.py starts it.
//
// Listens to /tf, /clock and odom, base_scan, base_pose_ground_truth and contact of all robots, typed and deserialized
// as any client would, and redraws every robot's cmd_vel each 2 s of simulated time. The world starts paused, and is
// resumed when all topics are connected. Says "first" when the first message comes; ends when every topic has brought
// the last step's, or after a time, and prints what came as one line of JSON.
#include <geometry_msgs/Twist.h>
#include <nav_msgs/Odometry.h>
#include <robotteamsim/Contact.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/LaserScan.h>
#include <std_srvs/Trigger.h>
#include <sys/resource.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

namespace {

using Wall = std::chrono::steady_clock;

constexpr std::int64_t kRedrawNs = 2'000'000'000;

double SecondsSince(Wall::time_point start) { return std::chrono::duration<double>(Wall::now() - start).count(); }

double BusySeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec) * 1e-6;
}

// What one topic has brought; a message is out of order when it is not one step after the last.
struct Tally {
  std::uint64_t messages = 0, numbers = 0;  // numbers: ranges of scans, transforms of tf
  std::int64_t last_ns = 0;
  std::uint64_t out_of_order = 0;
};

class Listener {
 public:
  Listener(int num_robots, std::int64_t num_steps, std::int64_t step_ns)
      : num_steps_(num_steps), step_ns_(step_ns), incomplete_(4 * static_cast<std::size_t>(num_robots) + 1) {
    tallies_.resize(incomplete_);
    std::size_t next = 0;
    Listen<tf2_msgs::TFMessage>("/tf", next++);
    for (int robot_id = 0; robot_id < num_robots; ++robot_id) {
      const std::string name = "/robot_" + std::to_string(robot_id);
      Listen<nav_msgs::Odometry>(name + "/odom", next++);
      Listen<nav_msgs::Odometry>(name + "/base_pose_ground_truth", next++);
      Listen<sensor_msgs::LaserScan>(name + "/base_scan", next++);
      Listen<robotteamsim::Contact>(name + "/contact", next++);
      commands_.push_back(node_.advertise<geometry_msgs::Twist>(name + "/cmd_vel", 10));
    }
    const boost::function<void(const rosgraph_msgs::ClockConstPtr&)> count = [this](const auto& message) {
      ++clock_messages_;
      clock_ns_ = static_cast<std::int64_t>(message->clock.toNSec());
    };
    subscribers_.push_back(node_.subscribe("/clock", 0, count, nullptr, ros::TransportHints().tcpNoDelay()));
  }

  // Subscriptions that no publisher is connected to yet: roscpp registers them one by one, and the world hears of each
  // from a busy master.
  std::ptrdiff_t NumMissing() const {
    return std::count_if(subscribers_.begin(), subscribers_.end(),
                         [](const auto& subscriber) { return subscriber.getNumPublishers() == 0; });
  }

  // All topics have brought the last step.
  bool Complete() const { return incomplete_ == 0 && clock_ns_ >= num_steps_ * step_ns_; }

  void Print() const {
    std::uint64_t messages = clock_messages_, numbers = 0, out_of_order = 0, fewest = tallies_.front().messages;
    for (const Tally& tally : tallies_) {
      messages += tally.messages;
      numbers += tally.numbers;
      out_of_order += tally.out_of_order;
      fewest = std::min(fewest, tally.messages);
    }
    std::printf(
        "{\"messages\": %lu, \"clock\": %lu, \"numbers\": %lu, \"fewest_of_a_topic\": %lu, \"out_of_order\": %lu, "
        "\"wall_s\": %.6f, \"busy_s\": %.6f}\n",
        messages, clock_messages_, numbers, fewest, out_of_order, wall_s_, busy_s_);
  }

 private:
  template <typename Message>
  void Listen(const std::string& topic, std::size_t index) {
    using Pointer = boost::shared_ptr<const Message>;
    const boost::function<void(const Pointer&)> take = [this, index](const Pointer& message) {
      Take(tallies_[index], StampNs(*message), Numbers(*message));
    };
    subscribers_.push_back(node_.subscribe(topic, 0, take, nullptr, ros::TransportHints().tcpNoDelay()));
  }

  void Take(Tally& tally, std::int64_t stamp_ns, std::size_t numbers) {
    if (!started_) {
      started_ = true;
      start_ = Wall::now();
      std::puts("first");
      std::fflush(stdout);
      busy_before_s_ = BusySeconds();
    }
    ++tally.messages;
    tally.numbers += numbers;
    if (stamp_ns != tally.last_ns + step_ns_) ++tally.out_of_order;
    const bool was_complete = tally.last_ns >= num_steps_ * step_ns_;
    tally.last_ns = stamp_ns;
    if (stamp_ns >= next_redraw_ns_) Redraw(stamp_ns);
    if (!was_complete && stamp_ns >= num_steps_ * step_ns_ && --incomplete_ == 0) {
      wall_s_ = SecondsSince(start_);
      busy_s_ = BusySeconds() - busy_before_s_;
    }
  }

  void Redraw(std::int64_t now_ns) {
    next_redraw_ns_ = now_ns + kRedrawNs;
    for (const ros::Publisher& command : commands_) {
      geometry_msgs::Twist twist;
      twist.linear.x = std::uniform_real_distribution(-0.2, 0.7)(random_);
      twist.angular.z = std::uniform_real_distribution(-1.0, 1.0)(random_);
      command.publish(twist);
    }
  }

  template <typename Message>
  static std::int64_t StampNs(const Message& message) {
    return static_cast<std::int64_t>(message.header.stamp.toNSec());
  }
  static std::int64_t StampNs(const tf2_msgs::TFMessage& message) { return StampNs(message.transforms.at(0)); }

  template <typename Message>
  static std::size_t Numbers(const Message&) {
    return 0;
  }
  static std::size_t Numbers(const sensor_msgs::LaserScan& scan) { return scan.ranges.size(); }
  static std::size_t Numbers(const tf2_msgs::TFMessage& message) { return message.transforms.size(); }

  ros::NodeHandle node_;
  std::int64_t num_steps_, step_ns_;
  std::size_t incomplete_;  // topics that have not brought the last step
  std::vector<Tally> tallies_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::Publisher> commands_;
  std::mt19937 random_;
  std::int64_t next_redraw_ns_ = 0;
  std::uint64_t clock_messages_ = 0;
  std::int64_t clock_ns_ = 0;
  bool started_ = false;
  Wall::time_point start_;
  double busy_before_s_ = 0.0, wall_s_ = 0.0, busy_s_ = 0.0;
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "listener");
  if (argc != 5) {
    std::fprintf(stderr, "usage: %s ROBOTS STEPS STEP_NS TIMEOUT_S\n", argv[0]);
    return 2;
  }
  Listener listener(std::atoi(argv[1]), std::atoll(argv[2]), std::atoll(argv[3]));
  const double timeout_s = std::atof(argv[4]);
  const auto start = Wall::now();
  while (ros::ok() && listener.NumMissing() > 0 && SecondsSince(start) < timeout_s) ros::WallDuration(0.1).sleep();
  if (listener.NumMissing() > 0) {
    std::fprintf(stderr, "%td topics are not connected after %.0f s\n", listener.NumMissing(), timeout_s);
    std::_Exit(1);
  }
  std_srvs::Trigger resume;
  ros::service::waitForService("/simulation/resume");
  ros::service::call("/simulation/resume", resume);
  while (ros::ok() && !listener.Complete() && SecondsSince(start) < timeout_s) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.05));
  }
  listener.Print();
  std::fflush(stdout);
  // Unsubscribing from 1200 topics one by one takes roscpp minutes while the world goes on.
  std::_Exit(listener.Complete() ? 0 : 1);
}

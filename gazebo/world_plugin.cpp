// The plugin of a world: clock, speed and doors.
//
//   <plugin name="robotteamsim_world" filename="librobotteamsim_gazebo_world.so">
//     <step_s>0.1</step_s>        interval of /world/doors [s]
//     <door>...</door>            see doors.hpp
//   </plugin>
//
// Parameters of the node /gazebo, all optional:
//   ~speed         simulated over wall time; 0: as fast as possible. Otherwise the world file decides
//   ~follow_clock  true: another world publishes /clock, and Gazebo never gets ahead of it
#include <robotteamsim/SetDoor.h>
#include <ros/callback_queue.h>
#include <ros/publisher.h>
#include <ros/service_server.h>
#include <ros/spinner.h>
#include <ros/subscriber.h>
#include <rosgraph_msgs/Clock.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <gazebo/common/Events.hh>
#include <gazebo/common/Plugin.hh>
#include <gazebo/physics/physics.hh>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include "doors.hpp"
#include "ros_connection.hpp"

namespace robotteamsim::gazebo_plugins {
namespace {

namespace physics = gazebo::physics;

constexpr double kTickS = 0.02;  // 50 Hz, as of our own world
constexpr int kQueue = 100;

void SetSpeed(const physics::WorldPtr& world) {
  double speed = 0.0;
  if (!ros::NodeHandle("~").getParam("speed", speed)) return;
  if (!(speed >= 0.0)) throw std::invalid_argument("~speed: " + std::to_string(speed) + "; expected at least 0");
  const physics::PhysicsEnginePtr engine = world->Physics();
  engine->SetRealTimeUpdateRate(speed / engine->GetMaxStepSize());
}

}  // namespace

// /clock, which our nodes and others follow.
class ClockOutput {
 public:
  ClockOutput()
      : tick_(kTickS), output_(StartedNode().advertise<rosgraph_msgs::Clock>("/clock", kQueue, /*latch=*/true)) {}

  // Called before a physics step: the clock of the one before, which must not overtake its data.
  void Publish(std::int64_t time_ns) {
    if (!tick_.IsDue(time_ns)) return;
    rosgraph_msgs::Clock message;
    message.clock = Stamp(time_ns);
    output_.publish(message);
  }

 private:
  Period tick_;
  ros::Publisher output_;
};

// /clock of another world, which this one follows.
class ClockInput {
 public:
  explicit ClockInput(ros::CallbackQueue* queue) {
    ros::SubscribeOptions options = ros::SubscribeOptions::create<rosgraph_msgs::Clock>(
        "/clock", kQueue, [this](const rosgraph_msgs::ClockConstPtr& message) { Put(message->clock.toNSec()); },
        ros::VoidPtr(), queue);
    options.transport_hints = ros::TransportHints().tcpNoDelay();
    subscriber_ = StartedNode().subscribe(options);
  }

  void WaitFor(std::int64_t time_ns) {
    std::unique_lock lock(mutex_);
    while (ros::ok() && now_ns_ < time_ns) changed_.wait_for(lock, std::chrono::milliseconds(100));
  }

 private:
  void Put(std::uint64_t time_ns) {
    {
      const std::lock_guard lock(mutex_);
      now_ns_ = static_cast<std::int64_t>(time_ns);
    }
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::int64_t now_ns_ = 0;
  ros::Subscriber subscriber_;
};

// /world/doors and its service.
class DoorTopics {
 public:
  DoorTopics(const physics::WorldPtr& world, const sdf::ElementPtr& settings, ros::CallbackQueue* queue)
      : doors_(world, settings), step_(settings->Get<double>("step_s", 0.1).first) {
    ros::NodeHandle node = StartedNode();
    if (!doors_.empty()) output_ = node.advertise<robotteamsim::Doors>("/world/doors", kQueue, /*latch=*/true);
    using Request = robotteamsim::SetDoor::Request;
    using Response = robotteamsim::SetDoor::Response;
    const boost::function<bool(Request&, Response&)> set = [this](Request& request, Response& response) {
      Set(request, response);
      return true;
    };
    ros::AdvertiseServiceOptions options =
        ros::AdvertiseServiceOptions::create<robotteamsim::SetDoor>("/world/set_door", set, ros::VoidPtr(), queue);
    server_ = node.advertiseService(options);
  }

  void BeforePhysicsStep(double duration_s) { doors_.Move(duration_s); }

  void AfterPhysicsStep(std::int64_t time_ns) {
    if (!step_.IsDue(time_ns) || doors_.empty()) return;
    robotteamsim::Doors message = doors_.States();
    message.header.stamp = Stamp(time_ns);
    message.header.frame_id = "map";
    output_.publish(message);
  }

 private:
  void Set(const robotteamsim::SetDoor::Request& request, robotteamsim::SetDoor::Response& response) {
    try {
      doors_.Request(request.name, request.closed);
      response.success = true;
    } catch (const std::invalid_argument& error) {
      response.success = false;
      response.message = error.what();
    }
  }

  Doors doors_;
  Period step_;
  ros::Publisher output_;
  ros::ServiceServer server_;
};

class WorldPlugin : public gazebo::WorldPlugin {
 public:
  void Load(physics::WorldPtr world, sdf::ElementPtr settings) override {
    world_ = world;
    try {
      ros::NodeHandle node = StartedNode();
      SetSpeed(world);
      doors_ = std::make_unique<DoorTopics>(world, settings, &queue_);
      if (ros::NodeHandle("~").param("follow_clock", false)) {
        followed_ = std::make_unique<ClockInput>(&queue_);
      } else {
        clock_ = std::make_unique<ClockOutput>();
      }
      spinner_ = std::make_unique<ros::AsyncSpinner>(1, &queue_);
      spinner_->start();
    } catch (const std::exception& error) {
      gzerr << "world '" << world->Name() << "', plugin robotteamsim_world: " << error.what() << std::endl;
      return;
    }
    using gazebo::event::Events;
    before_ = Events::ConnectWorldUpdateBegin([this](const gazebo::common::UpdateInfo&) { BeforePhysicsStep(); });
    after_ = Events::ConnectWorldUpdateEnd([this] { AfterPhysicsStep(); });
  }

 private:
  void BeforePhysicsStep() {
    if (clock_) clock_->Publish(last_ns_);
    // Gazebo has already counted the time of this step.
    if (followed_) followed_->WaitFor(TimeNs(world_));
    doors_->BeforePhysicsStep(world_->Physics()->GetMaxStepSize());
  }

  void AfterPhysicsStep() {
    last_ns_ = TimeNs(world_);
    doors_->AfterPhysicsStep(last_ns_);
  }

  physics::WorldPtr world_;
  std::int64_t last_ns_ = 0;
  ros::CallbackQueue queue_;
  std::unique_ptr<DoorTopics> doors_;
  std::unique_ptr<ClockOutput> clock_;
  std::unique_ptr<ClockInput> followed_;
  std::unique_ptr<ros::AsyncSpinner> spinner_;  // after what it calls, so that it stops first
  gazebo::event::ConnectionPtr before_;
  gazebo::event::ConnectionPtr after_;
};

GZ_REGISTER_WORLD_PLUGIN(WorldPlugin)

}  // namespace robotteamsim::gazebo_plugins

// The homework of the tutorial [dissertation, Appendix 2]: passes commands on to a robot, more slowly near obstacles.
//
// Nearer than 2.0 m to an obstacle the robot drives at half the speed; nearer than 0.3 m it never drives forward. The
// last command holds for 0.8 s, as in the simulator.
#include <geometry_msgs/Twist.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>

#include <algorithm>

namespace {

constexpr double kHalfSpeedBelowM = 2.0;
constexpr double kNoForwardBelowM = 0.3;
constexpr double kHoldS = 0.8;

double LimitedSpeedMps(double wanted_mps, double nearest_m) {
  const double speed_mps = nearest_m < kHalfSpeedBelowM ? wanted_mps / 2.0 : wanted_mps;
  return nearest_m < kNoForwardBelowM ? std::min(speed_mps, 0.0) : speed_mps;
}

class CarefulDriver {
 public:
  explicit CarefulDriver(ros::NodeHandle& node)
      : commands_(node.advertise<geometry_msgs::Twist>("cmd_vel", 1)),
        scans_(node.subscribe("base_scan", 1, &CarefulDriver::OnScan, this)),
        wanted_(node.subscribe("wanted_vel", 1, &CarefulDriver::OnWanted, this)) {}

 private:
  void OnScan(const sensor_msgs::LaserScan& scan) {
    if (!scan.ranges.empty()) nearest_m_ = *std::min_element(scan.ranges.begin(), scan.ranges.end());
    if (!is_wanted_) return;
    // Again, because the robot may come near an obstacle while no new command arrives.
    const double age_s = (ros::Time::now() - wanted_at_).toSec();
    is_wanted_ = 0.0 <= age_s && age_s < kHoldS;
    if (is_wanted_) {
      Publish();
    } else {
      commands_.publish(geometry_msgs::Twist());
    }
  }

  void OnWanted(const geometry_msgs::Twist& command) {
    wanted_command_ = command;
    wanted_at_ = ros::Time::now();
    is_wanted_ = true;
    Publish();
  }

  void Publish() {
    geometry_msgs::Twist limited = wanted_command_;
    limited.linear.x = LimitedSpeedMps(limited.linear.x, nearest_m_);
    commands_.publish(limited);
  }

  double nearest_m_ = 0.0;  // do not drive forward before the first scan
  geometry_msgs::Twist wanted_command_;
  ros::Time wanted_at_;
  bool is_wanted_ = false;
  ros::Publisher commands_;
  ros::Subscriber scans_, wanted_;
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "careful_driver");
  ros::NodeHandle node;
  const CarefulDriver driver(node);
  ros::spin();
}

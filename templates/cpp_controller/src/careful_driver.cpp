// The homework of the tutorial [dissertation, Appendix 2]: passes commands on to a robot, more slowly near obstacles.
//
// Nearer than 2.0 m to an obstacle the robot drives at half the speed; nearer than 0.3 m it never drives forward.
#include <geometry_msgs/Twist.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>

#include <algorithm>

namespace {

constexpr double kHalfSpeedBelowM = 2.0;
constexpr double kNoForwardBelowM = 0.3;

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
  }

  void OnWanted(geometry_msgs::Twist command) {
    command.linear.x = LimitedSpeedMps(command.linear.x, nearest_m_);
    commands_.publish(command);
  }

  double nearest_m_ = 0.0;  // do not drive forward before the first scan
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

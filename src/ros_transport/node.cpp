#include "node.hpp"

#include <ros/ros.h>

#include <cstdlib>
#include <stdexcept>

#include "callbacks.hpp"

namespace robotteamsim::ros_transport {
namespace {

constexpr double kServiceTimeoutS = 5.0;
// A parameter that says whether the time comes from /clock, where a node looks for it instead of at /use_sim_time.
constexpr const char* kOwnUseSimTime = "/use_sim_time:=/robotteamsim/use_sim_time";

}  // namespace

void StartNode(const std::string& name, std::vector<std::string> arguments) {
  // Lines must reach roslaunch when they are written.
  setenv("ROSCONSOLE_STDOUT_LINE_BUFFERED", "1", /*overwrite=*/0);
  arguments.emplace_back(kOwnUseSimTime);
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  int argc = static_cast<int>(argv.size());
  ros::init(argc, argv.data(), name, ros::init_options::NoSigintHandler);
  ros::start();
}

ros::NodeHandle StartedNode() {
  // roscpp would end the process.
  if (!ros::isInitialized()) throw std::logic_error("the node is not started");
  return {};
}

bool IsOk() { return ros::isStarted() && ros::ok() && !ros::isShuttingDown(); }

void ShutDown() {
  Threaded().Close(kServiceTimeoutS);
  ros::shutdown();
}

std::string NodeName() { return ros::this_node::getName(); }

std::string ResolvedName(const std::string& name) { return ros::names::resolve(name); }

void Log(Level level, const std::string& line) {
  switch (level) {
    case Level::kDebug:
      ROS_DEBUG("%s", line.c_str());
      break;
    case Level::kInfo:
      ROS_INFO("%s", line.c_str());
      break;
    case Level::kWarning:
      ROS_WARN("%s", line.c_str());
      break;
    case Level::kError:
      ROS_ERROR("%s", line.c_str());
      break;
    case Level::kFatal:
      ROS_FATAL("%s", line.c_str());
      break;
  }
}

}  // namespace robotteamsim::ros_transport

#include "node.hpp"

#include <netinet/in.h>
#include <ros/connection_manager.h>
#include <ros/poll_manager.h>
#include <ros/ros.h>
#include <ros/xmlrpc_manager.h>
#include <sys/socket.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "callbacks.hpp"

namespace robotteamsim::ros_transport {
namespace {

constexpr double kServiceTimeoutS = 5.0;
// Makes roscpp read another parameter instead of /use_sim_time, so that the node does not use /clock.
constexpr const char* kOwnUseSimTime = "/use_sim_time:=/robotteamsim/use_sim_time";

// Number of connections that may wait to be accepted.
constexpr int kMaxWaiting = 4096;

// Number of rounds of roscpp's thread, which queues the messages published so far and then writes them.
std::atomic<std::uint64_t> num_rounds{0};

bool ListensOn(int socket, std::uint32_t port) {
  int listens = 0;
  socklen_t size = sizeof listens;
  if (getsockopt(socket, SOL_SOCKET, SO_ACCEPTCONN, &listens, &size) != 0 || listens == 0) return false;
  sockaddr_in address{};
  size = sizeof address;
  // The port has the same offset in IPv6 addresses.
  return getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) == 0 && ntohs(address.sin_port) == port;
}

// roscpp's backlog is 5 callers and 100 subscribers. If hundreds connect at once, the kernel resets the connections of
// others, and not all clients retry.
void AcceptHundredsAtOnce() {
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    const int file = std::stoi(entry.path().filename());
    if (ListensOn(file, ros::XMLRPCManager::instance()->getServerPort()) ||
        ListensOn(file, ros::ConnectionManager::instance()->getTCPPort())) {
      listen(file, kMaxWaiting);
    }
  }
}

}  // namespace

void StartNode(const std::string& name, std::vector<std::string> arguments) {
  // Lines must reach roslaunch immediately.
  setenv("ROSCONSOLE_STDOUT_LINE_BUFFERED", "1", /*overwrite=*/0);
  arguments.emplace_back(kOwnUseSimTime);
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  int argc = static_cast<int>(argv.size());
  ros::init(argc, argv.data(), name, ros::init_options::NoSigintHandler);
  ros::start();
  AcceptHundredsAtOnce();
  ros::PollManager::instance()->addPollThreadListener([] { ++num_rounds; });
}

ros::NodeHandle StartedNode() {
  // Otherwise roscpp would end the process.
  if (!ros::isInitialized()) throw std::logic_error("the node is not started");
  return {};
}

bool IsOk() { return ros::isStarted() && ros::ok() && !ros::isShuttingDown(); }

void ShutDown() {
  Threaded().Close(kServiceTimeoutS);
  ros::shutdown();
}

void WaitUntilSent() {
  // The current round may have missed the last messages; the next one queues and writes them.
  constexpr int kRounds = 2;
  const std::uint64_t begin = num_rounds;
  const ros::WallTime until = ros::WallTime::now() + ros::WallDuration(kServiceTimeoutS);
  while (num_rounds < begin + kRounds && IsOk() && ros::WallTime::now() < until) {
    ros::PollManager::instance()->getPollSet().signal();
    ros::WallDuration(0.001).sleep();
  }
}

std::uint64_t NumWrites() { return num_rounds; }

void WaitForWrite(std::uint64_t number, double timeout_s) {
  constexpr double kNapS = 0.0002;
  const ros::WallTime until = ros::WallTime::now() + ros::WallDuration(timeout_s);
  while (num_rounds < number && IsOk() && ros::WallTime::now() < until) ros::WallDuration(kNapS).sleep();
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

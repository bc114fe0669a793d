// The one node of this process.
#pragma once

#include <ros/node_handle.h>

#include <cstdint>
#include <string>
#include <vector>

namespace robotteamsim::ros_transport {

// Registers the process as a node; arguments such as "__name:=world" and "odom:=odometry" rename it and its topics.
// The node does not listen to /clock: it takes the time from the stamps of its messages.
void StartNode(const std::string& name, std::vector<std::string> arguments);
// Throws std::logic_error if the node is not started.
ros::NodeHandle StartedNode();
// False as soon as the node is shutting down.
bool IsOk();
// Waits for running service calls, at most 5 s, and unregisters everything from the master.
void ShutDown();

// Waits until all messages published so far are written to the sockets, at most 5 s on a busy machine.
void WaitUntilSent();

// Number of times that roscpp's thread has written waiting messages; messages published now are written after two more.
std::uint64_t NumWrites();
// Waits for such a number, at most for a given time; not at all while the node is not running.
void WaitForWrite(std::uint64_t number, double timeout_s);

std::string NodeName();
std::string ResolvedName(const std::string& name);

enum class Level { kDebug, kInfo, kWarning, kError, kFatal };
// Writes a line to the console and to /rosout.
void Log(Level level, const std::string& line);

}  // namespace robotteamsim::ros_transport

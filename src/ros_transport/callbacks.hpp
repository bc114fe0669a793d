// Where roscpp's callbacks run: at once, or each in a thread of its own.
#pragma once

#include <ros/callback_queue_interface.h>

#include <condition_variable>
#include <mutex>

namespace robotteamsim::ros_transport {

// Calls back from roscpp's own thread, so the callbacks must not wait for anything.
class ImmediateCalls : public ros::CallbackQueueInterface {
 public:
  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t) override { callback->call(); }
  void removeByID(std::uint64_t) override {}
};

// Calls back from a new thread each time: services may wait for a step, and must not wait for each other.
class ThreadedCalls : public ros::CallbackQueueInterface {
 public:
  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t) override;
  void removeByID(std::uint64_t) override {}
  // Starts no more threads, and waits for those that run, but not longer than a time.
  void Close(double timeout_s);

 private:
  std::mutex mutex_;
  std::condition_variable idle_;
  int num_running_ = 0;
  bool closed_ = false;
};

// Both live as long as the process: roscpp keeps plain pointers to them.
ImmediateCalls& Immediate();
ThreadedCalls& Threaded();

}  // namespace robotteamsim::ros_transport

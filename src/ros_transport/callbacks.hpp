// Queues for roscpp's callbacks: run at once, or each in a new thread.
#pragma once

#include <ros/callback_queue_interface.h>

#include <condition_variable>
#include <mutex>

namespace robotteamsim::ros_transport {

// Runs callbacks in roscpp's own thread, so they must not block.
class ImmediateCalls : public ros::CallbackQueueInterface {
 public:
  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t) override { callback->call(); }
  void removeByID(std::uint64_t) override {}
};

// Runs each callback in a new thread: services may wait for a step, and must not wait for each other.
class ThreadedCalls : public ros::CallbackQueueInterface {
 public:
  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t) override;
  void removeByID(std::uint64_t) override {}
  // Starts no more threads, and waits for running ones, at most for a given time.
  void Close(double timeout_s);

 private:
  std::mutex mutex_;
  std::condition_variable idle_;
  int num_running_ = 0;
  bool closed_ = false;
};

// Both live as long as the process, because roscpp keeps plain pointers to them.
ImmediateCalls& Immediate();
ThreadedCalls& Threaded();

}  // namespace robotteamsim::ros_transport

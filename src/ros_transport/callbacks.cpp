#include "callbacks.hpp"

#include <chrono>
#include <thread>

namespace robotteamsim::ros_transport {

void ThreadedCalls::addCallback(const ros::CallbackInterfacePtr& to_call, std::uint64_t) {
  {
    const std::lock_guard lock(mutex_);
    if (closed_) return;
    ++num_running_;
  }
  std::thread([this, callback = to_call]() mutable {
    callback->call();
    callback.reset();
    const std::lock_guard lock(mutex_);
    if (--num_running_ == 0) idle_.notify_all();
  }).detach();
}

void ThreadedCalls::Close(double timeout_s) {
  std::unique_lock lock(mutex_);
  closed_ = true;
  idle_.wait_for(lock, std::chrono::duration<double>(timeout_s), [this] { return num_running_ == 0; });
}

ImmediateCalls& Immediate() {
  static auto* calls = new ImmediateCalls;
  return *calls;
}

ThreadedCalls& Threaded() {
  static auto* calls = new ThreadedCalls;
  return *calls;
}

}  // namespace robotteamsim::ros_transport

// Collects what comes on several topics until somebody takes it.
#pragma once

#include <ros/subscriber.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "raw_message.hpp"

namespace robotteamsim::ros_transport {

struct Received {
  std::size_t topic;      // index, in the order of subscribing
  std::int64_t stamp_ns;  // of its header; 0 where the type has none
  boost::shared_ptr<const RawMessage> message;
};

// roscpp's thread puts messages in, any other takes them out; none of the two waits for the other.
class MessageQueue {
 public:
  MessageQueue();
  ~MessageQueue();
  MessageQueue(const MessageQueue&) = delete;
  MessageQueue& operator=(const MessageQueue&) = delete;

  // Returns the topic's index. keep: of more untaken messages of this topic the oldest are dropped; 0: none is.
  std::size_t Subscribe(const std::string& topic, const MessageType& type, std::size_t keep);
  // Waits until something is there, but not longer than a time; returns all of it, in the order of arrival.
  std::deque<Received> Take(double timeout_s);
  // Lets nobody wait any more.
  void Close();
  // Closes it and takes it back from the master that this node subscribes.
  void Unsubscribe();
  bool is_closed() const;
  std::size_t num_publishers(std::size_t topic) const;

 private:
  struct Arrivals;

  std::shared_ptr<Arrivals> arrivals_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace robotteamsim::ros_transport

// Collects the messages of several topics until they are taken.
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
  std::int64_t stamp_ns;  // of its header; 0 if the type has none
  boost::shared_ptr<const RawMessage> message;
  std::string publisher;  // the node
};

// roscpp's thread adds messages, any other thread takes them; neither blocks the other.
class MessageQueue {
 public:
  MessageQueue();
  ~MessageQueue();
  MessageQueue(const MessageQueue&) = delete;
  MessageQueue& operator=(const MessageQueue&) = delete;

  // Returns the topic's index. keep: largest number of untaken messages; older ones are dropped; 0: no limit.
  // one_publisher: only messages of the node whose message comes first are taken.
  std::size_t Subscribe(const std::string& topic, const MessageType& type, std::size_t keep, bool one_publisher);
  // Waits for messages, at most for a given time, and returns all of them in the order of arrival.
  std::deque<Received> Take(double timeout_s);
  // Ends all waits.
  void Close();
  // Closes the queue and unregisters its subscriptions.
  void Unsubscribe();
  bool is_closed() const;
  std::size_t num_publishers(std::size_t topic) const;

 private:
  struct Arrivals;
  struct Owner {
    bool only = false;        // whether the topic has one publisher
    std::string name;         // of that node; empty before its first message
    bool has_warned = false;  // about another one
  };

  bool IsWanted(const Received& received);

  std::shared_ptr<Arrivals> arrivals_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<Owner> owners_;  // by topic
};

}  // namespace robotteamsim::ros_transport

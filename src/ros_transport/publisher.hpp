// Publishes serialized messages on one topic.
#pragma once

#include <ros/publisher.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "raw_message.hpp"

namespace robotteamsim::ros_transport {

class Publisher {
 public:
  // Makes what a new subscriber gets at once; called from a thread of its own.
  using Greeting = std::function<std::optional<RawMessage>()>;

  // Nothing is dropped, however slow a subscriber is. latched: a new subscriber gets the last message.
  Publisher(const std::string& topic, const MessageType& type, bool latched, Greeting greeting = {});

  // Returns at once; messages reach a subscriber in order. Does nothing where nobody gets the message.
  void Publish(const RawMessage& message) const;
  // Whether somebody gets the next message, now or (latched) later.
  bool IsWanted() const;
  int num_subscribers() const;

 private:
  struct Subscribers;

  bool latched_;
  std::shared_ptr<Subscribers> subscribers_;
  ros::Publisher publisher_;
};

}  // namespace robotteamsim::ros_transport

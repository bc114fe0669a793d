// Publishes serialized messages on one topic.
#pragma once

#include <ros/publication.h>
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

  // Nothing is dropped, however slow a subscriber is. latched: a new subscriber gets the last message, instead of a
  // greeting.
  Publisher(const std::string& topic, const MessageType& type, bool latched, Greeting greeting = {});

  // Returns at once; messages reach a subscriber in order. Does nothing where nobody gets the message.
  void Publish(const RawMessage& message) const;
  // As Publish, but roscpp may wait with the message until SendEnqueued: for the many messages of one step.
  void Enqueue(const RawMessage& message) const;
  static void SendEnqueued();
  // Whether somebody gets the next message, now or (latched) later.
  bool IsWanted() const;
  int num_subscribers() const;

 private:
  struct Shared;

  std::shared_ptr<Shared> shared_;
  ros::Publisher publisher_;
  // Messages go to it directly: ros::Publisher looks the topic up by its name among all topics of the node for each
  // message, so a world of 300 robots would be busier with that than with its physics (bench/ros_bench.py); and to a
  // subscriber that comes while messages wait, roscpp's own latch sends the last of them before the others.
  ros::PublicationPtr publication_;
};

}  // namespace robotteamsim::ros_transport

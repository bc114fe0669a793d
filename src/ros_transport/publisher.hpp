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
  // Makes the first message for a new subscriber; called in a new thread.
  using Greeting = std::function<std::optional<RawMessage>()>;

  // No message is dropped, even for slow subscribers. latched: a new subscriber gets the last message instead of a
  // greeting.
  Publisher(const std::string& topic, const MessageType& type, bool latched, Greeting greeting = {});

  // Returns at once; messages reach a subscriber in order. Does nothing if there is no subscriber and no latch.
  void Publish(const RawMessage& message) const;
  // As Publish, but roscpp may delay the message until SendEnqueued: for the many messages of one step.
  void Enqueue(const RawMessage& message) const;
  static void SendEnqueued();
  // Whether there is a receiver for the next message, now or (latched) later.
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

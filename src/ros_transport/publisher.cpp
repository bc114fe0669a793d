#include "publisher.hpp"

#include <ros/poll_manager.h>
#include <ros/single_subscriber_publisher.h>
#include <ros/topic_manager.h>

#include <atomic>
#include <mutex>

#include "callbacks.hpp"
#include "node.hpp"

namespace robotteamsim::ros_transport {

// What roscpp's thread changes when somebody comes or goes.
struct Publisher::Subscribers {
  std::atomic<int> count{0};
  Greeting greeting;
  std::mutex mutex;
  // A latched message while it is being published: roscpp would still give a new subscriber the one before, and may
  // have sent this one to the others already.
  const RawMessage* under_way = nullptr;

  void Add(const ros::SingleSubscriberPublisher& subscriber) {
    ++count;
    {
      const std::lock_guard lock(mutex);
      if (under_way != nullptr) subscriber.publish(*under_way);
    }
    if (!greeting) return;
    if (const std::optional<RawMessage> message = greeting()) subscriber.publish(*message);
  }
};

Publisher::Publisher(const std::string& topic, const MessageType& type, bool latched, Greeting greeting)
    : latched_(latched), subscribers_(std::make_shared<Subscribers>()) {
  subscribers_->greeting = std::move(greeting);
  constexpr int kUnlimited = 0;
  ros::AdvertiseOptions options(
      topic, kUnlimited, type.md5sum, type.name, type.definition,
      [subscribers = subscribers_](const ros::SingleSubscriberPublisher& subscriber) { subscribers->Add(subscriber); },
      [subscribers = subscribers_](const ros::SingleSubscriberPublisher&) { --subscribers->count; });
  options.callback_queue = &Immediate();
  if (subscribers_->greeting) options.callback_queue = &Threaded();
  options.latch = latched;
  options.has_header = type.has_header;
  publisher_ = StartedNode().advertise(options);
  if (!latched) publication_ = ros::TopicManager::instance()->lookupPublication(publisher_.getTopic());
}

void Publisher::Publish(const RawMessage& message) const {
  Enqueue(message);
  SendEnqueued();
}

void Publisher::SendEnqueued() { ros::PollManager::instance()->getPollSet().signal(); }

void Publisher::Enqueue(const RawMessage& message) const {
  if (!IsWanted()) return;
  if (publication_) {
    ros::SerializedMessage serialized = ros::serialization::serializeMessage(message);
    publication_->publish(serialized);
    return;
  }
  const auto set_under_way = [this](const RawMessage* under_way) {
    const std::lock_guard lock(subscribers_->mutex);
    subscribers_->under_way = under_way;
  };
  set_under_way(&message);
  publisher_.publish(message);
  set_under_way(nullptr);
}

bool Publisher::IsWanted() const { return latched_ || num_subscribers() > 0; }

int Publisher::num_subscribers() const { return subscribers_->count; }

}  // namespace robotteamsim::ros_transport

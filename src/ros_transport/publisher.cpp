#include "publisher.hpp"

#include <ros/poll_manager.h>
#include <ros/single_subscriber_publisher.h>
#include <ros/topic_manager.h>

#include <atomic>
#include <mutex>

#include "callbacks.hpp"
#include "node.hpp"

namespace robotteamsim::ros_transport {

// State that roscpp's thread uses when subscribers connect or disconnect.
struct Publisher::Shared {
  const bool latched;
  const Greeting greeting;
  std::atomic<int> num_subscribers{0};

  std::mutex mutex;
  ros::PublicationPtr publication;
  ros::SerializedMessage last;  // of a latched topic
  std::uint32_t num_published = 0;

  Shared(bool is_latched, Greeting greet) : latched(is_latched), greeting(std::move(greet)) {}

  void Add(const ros::SingleSubscriberPublisher& subscriber) {
    ++num_subscribers;
    if (latched) {
      if (const std::optional<RawMessage> message = LastMessage()) subscriber.publish(*message);
    } else if (greeting) {
      if (const std::optional<RawMessage> message = greeting()) subscriber.publish(*message);
    }
  }

  // None if the last message is still in roscpp's queue, which the new subscriber also receives.
  std::optional<RawMessage> LastMessage() {
    const std::lock_guard lock(mutex);
    if (!publication || !last.buf || publication->getSequence() != num_published) return std::nullopt;
    const auto* begin = reinterpret_cast<const char*>(last.message_start);
    const auto* end = reinterpret_cast<const char*>(last.buf.get()) + last.num_bytes;
    return RawMessage{std::string(begin, end)};
  }
};

Publisher::Publisher(const std::string& topic, const MessageType& type, bool latched, Greeting greeting)
    : shared_(std::make_shared<Shared>(latched, std::move(greeting))) {
  constexpr int kUnlimited = 0;
  ros::AdvertiseOptions options(
      topic, kUnlimited, type.md5sum, type.name, type.definition,
      [shared = shared_](const ros::SingleSubscriberPublisher& subscriber) { shared->Add(subscriber); },
      [shared = shared_](const ros::SingleSubscriberPublisher&) { --shared->num_subscribers; });
  options.callback_queue = &Immediate();
  if (!latched && shared_->greeting) options.callback_queue = &Threaded();
  options.latch = latched;
  options.has_header = type.has_header;
  publisher_ = StartedNode().advertise(options);
  publication_ = ros::TopicManager::instance()->lookupPublication(publisher_.getTopic());
  const std::lock_guard lock(shared_->mutex);
  shared_->publication = publication_;
}

void Publisher::Publish(const RawMessage& message) const {
  Enqueue(message);
  SendEnqueued();
}

void Publisher::Enqueue(const RawMessage& message) const {
  if (!publication_ || !IsWanted()) return;
  ros::SerializedMessage serialized = ros::serialization::serializeMessage(message);
  if (shared_->latched) {
    const std::lock_guard lock(shared_->mutex);
    shared_->last = serialized;
    ++shared_->num_published;
  }
  publication_->publish(serialized);
}

void Publisher::SendEnqueued() { ros::PollManager::instance()->getPollSet().signal(); }

bool Publisher::IsWanted() const { return shared_->latched || num_subscribers() > 0; }

int Publisher::num_subscribers() const { return shared_->num_subscribers; }

}  // namespace robotteamsim::ros_transport

#include "message_queue.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>

#include "callbacks.hpp"
#include "node.hpp"

namespace robotteamsim::ros_transport {
namespace {

// A header starts with its sequence number and the two parts of its stamp.
std::int64_t StampNs(const std::string& bytes) {
  std::uint32_t sequence_s_ns[3];
  if (bytes.size() < sizeof sequence_s_ns) return 0;
  std::memcpy(sequence_s_ns, bytes.data(), sizeof sequence_s_ns);
  return std::int64_t{1'000'000'000} * sequence_s_ns[1] + sequence_s_ns[2];
}

}  // namespace

struct MessageQueue::Arrivals {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Received> waiting;
  std::vector<std::size_t> num_waiting;  // of each topic
  bool closed = false;

  void Put(std::size_t topic, std::size_t keep, Received received) {
    const std::lock_guard lock(mutex);
    if (closed) return;
    if (keep > 0 && num_waiting[topic] >= keep) {
      waiting.erase(std::find_if(waiting.begin(), waiting.end(), [&](const Received& r) { return r.topic == topic; }));
      --num_waiting[topic];
    }
    ++num_waiting[topic];
    waiting.push_back(std::move(received));
    changed.notify_one();
  }
};

MessageQueue::MessageQueue() : arrivals_(std::make_shared<Arrivals>()) {}

MessageQueue::~MessageQueue() { Unsubscribe(); }

std::size_t MessageQueue::Subscribe(const std::string& topic, const MessageType& type, std::size_t keep,
                                    bool one_publisher) {
  const std::size_t index = subscribers_.size();
  {
    const std::lock_guard lock(arrivals_->mutex);
    arrivals_->num_waiting.push_back(0);
  }
  using Event = ros::MessageEvent<const RawMessage>;
  const boost::function<void(const Event&)> put = [arrivals = arrivals_, index, keep, one_publisher,
                                                   stamped = type.has_header](const Event& event) {
    const auto& message = event.getMessage();
    std::string publisher = one_publisher ? event.getPublisherName() : std::string();
    arrivals->Put(index, keep, {index, stamped ? StampNs(message->bytes) : 0, message, std::move(publisher)});
  };
  ros::SubscribeOptions options;
  options.initByFullCallbackType<const Event&>(topic, /*queue_size=*/0, put);
  options.md5sum = type.md5sum;
  options.datatype = type.name;
  options.callback_queue = &Immediate();
  // Otherwise a message that arrives while another one of the topic is being added would be dropped.
  options.allow_concurrent_callbacks = true;
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  owners_.push_back({one_publisher});
  subscribers_.push_back(StartedNode().subscribe(options));
  return index;
}

std::deque<Received> MessageQueue::Take(double timeout_s) {
  std::unique_lock lock(arrivals_->mutex);
  arrivals_->changed.wait_for(lock, std::chrono::duration<double>(timeout_s),
                              [this] { return arrivals_->closed || !arrivals_->waiting.empty(); });
  std::fill(arrivals_->num_waiting.begin(), arrivals_->num_waiting.end(), 0);
  std::deque<Received> taken = std::exchange(arrivals_->waiting, {});
  lock.unlock();  // roscpp's thread may wait for it while it holds the lock of the subscription
  taken.erase(std::remove_if(taken.begin(), taken.end(), [this](const Received& one) { return !IsWanted(one); }),
              taken.end());
  return taken;
}

bool MessageQueue::IsWanted(const Received& received) {
  Owner& owner = owners_[received.topic];
  if (!owner.only || received.publisher == owner.name) return true;
  if (owner.name.empty()) {
    owner.name = received.publisher;
    return true;
  }
  if (!owner.has_warned) {
    Log(Level::kWarning, subscribers_[received.topic].getTopic() + ": ignoring messages of " + received.publisher +
                             "; in lockstep a topic has one publisher, here " + owner.name);
    owner.has_warned = true;
  }
  return false;
}

void MessageQueue::Close() {
  const std::lock_guard lock(arrivals_->mutex);
  arrivals_->closed = true;
  arrivals_->changed.notify_all();
}

void MessageQueue::Unsubscribe() {
  Close();
  subscribers_.clear();
}

bool MessageQueue::is_closed() const {
  const std::lock_guard lock(arrivals_->mutex);
  return arrivals_->closed;
}

std::size_t MessageQueue::num_publishers(std::size_t topic) const {
  return topic < subscribers_.size() ? subscribers_[topic].getNumPublishers() : 0;
}

}  // namespace robotteamsim::ros_transport

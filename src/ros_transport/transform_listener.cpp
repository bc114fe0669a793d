#include "transform_listener.hpp"

#include <ros/message_event.h>
#include <tf2/utils.h>
#include <tf2_msgs/TFMessage.h>

#include "callbacks.hpp"
#include "node.hpp"

namespace robotteamsim::ros_transport {

TransformListener::TransformListener() : buffer_(std::make_shared<tf2::BufferCore>()) {
  Subscribe("/tf", /*is_static=*/false);
  Subscribe("/tf_static", /*is_static=*/true);
}

PlanarTransform TransformListener::Newest(const std::string& target, const std::string& source) const {
  const geometry_msgs::TransformStamped found = buffer_->lookupTransform(target, source, ros::Time(0));
  const auto& place = found.transform.translation;
  return {static_cast<std::int64_t>(found.header.stamp.toNSec()), place.x, place.y,
          tf2::getYaw(found.transform.rotation)};
}

void TransformListener::Clear() { buffer_->clear(); }

void TransformListener::Subscribe(const std::string& topic, bool is_static) {
  using Event = ros::MessageEvent<const tf2_msgs::TFMessage>;
  const boost::function<void(const Event&)> put = [buffer = buffer_, is_static](const Event& event) {
    for (const auto& transform : event.getConstMessage()->transforms) {
      // It reports wrong numbers itself.
      buffer->setTransform(transform, event.getPublisherName(), is_static);
    }
  };
  ros::SubscribeOptions options;
  options.initByFullCallbackType<const Event&>(topic, /*queue_size=*/0, put);
  options.callback_queue = &Immediate();
  // Otherwise a message that arrives while another one of the topic is being added would be dropped.
  options.allow_concurrent_callbacks = true;
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  subscribers_.push_back(StartedNode().subscribe(options));
}

}  // namespace robotteamsim::ros_transport

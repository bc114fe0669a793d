#include "team_publishers.hpp"

#include <algorithm>
#include <stdexcept>

namespace robotteamsim::ros_transport {
namespace {

template <class Message>
MessageType TypeOf() {
  namespace traits = ros::message_traits;
  return {traits::datatype<Message>(), traits::md5sum<Message>(), traits::definition<Message>(),
          traits::hasHeader<Message>()};
}

bool IsPresent(const Present& present, std::size_t robot_id) { return present.empty() || present[robot_id]; }

ros::Time Stamp(std::int64_t time_ns) {
  ros::Time stamp;
  stamp.fromNSec(static_cast<std::uint64_t>(time_ns));
  return stamp;
}

// Vector: geometry_msgs/Point or Vector3.
template <class Vector>
void SetPlace(const double* pose, Vector& place, geometry_msgs::Quaternion& rotation) {
  place.x = pose[0];
  place.y = pose[1];
  rotation.z = pose[2];
  rotation.w = pose[3];
}

}  // namespace

template <class Message>
TeamTopic<Message>::TeamTopic(const std::vector<std::string>& topics, const std::vector<std::string>& examples,
                              bool latched) {
  if (topics.size() != examples.size()) throw std::invalid_argument("topics and examples must have the same length");
  for (std::size_t i = 0; i < topics.size(); ++i) {
    messages_.push_back(Deserialized<Message>(examples[i]));
    publishers_.emplace_back(topics[i], TypeOf<Message>(), latched);
  }
}

template <class Message>
bool TeamTopic<Message>::IsWanted() const {
  return std::any_of(publishers_.begin(), publishers_.end(),
                     [](const Publisher& publisher) { return publisher.IsWanted(); });
}

template <class Message>
int TeamTopic<Message>::num_subscribers() const {
  int count = 0;
  for (const Publisher& publisher : publishers_) count += publisher.num_subscribers();
  return count;
}

template <class Message>
void TeamTopic<Message>::Publish(std::int64_t time_ns, const Present& present) {
  const ros::Time stamp = Stamp(time_ns);
  for (std::size_t i = 0; i < size(); ++i) {
    if (!IsPresent(present, i) || !publishers_[i].IsWanted()) continue;
    messages_[i].header.stamp = stamp;
    publishers_[i].Enqueue(Serialized(messages_[i]));
  }
  Publisher::SendEnqueued();
}

template class TeamTopic<nav_msgs::Odometry>;
template class TeamTopic<sensor_msgs::LaserScan>;
template class TeamTopic<robotteamsim::Contact>;

void OdometryTopic::PublishStep(std::int64_t time_ns, Rows poses, Rows twists, const Rows* pose_covariances,
                                const Rows* twist_covariances, const Present& present) {
  for (std::size_t i = 0; i < size(); ++i) {
    nav_msgs::Odometry& odometry = message(i);
    SetPlace(poses[i], odometry.pose.pose.position, odometry.pose.pose.orientation);
    odometry.twist.twist.linear.x = twists[i][0];
    odometry.twist.twist.linear.y = twists[i][1];
    odometry.twist.twist.angular.z = twists[i][2];
    const auto set = [i](const Rows* from, auto& to) {
      if (from != nullptr) std::copy_n((*from)[i], to.size(), to.begin());
    };
    set(pose_covariances, odometry.pose.covariance);
    set(twist_covariances, odometry.twist.covariance);
  }
  Publish(time_ns, present);
}

void ScanTopic::PublishStep(std::int64_t time_ns, const std::vector<Ranges>& ranges_m, const Present& present) {
  for (std::size_t i = 0; i < size(); ++i)
    message(i).ranges.assign(ranges_m[i].data, ranges_m[i].data + ranges_m[i].size);
  Publish(time_ns, present);
}

void ContactTopic::PublishStep(std::int64_t time_ns, const std::vector<bool>& in_contact,
                               const std::vector<std::vector<double>>& angles_rad, const Present& present) {
  for (std::size_t i = 0; i < size(); ++i) {
    message(i).in_contact = in_contact[i];
    message(i).angles_rad = angles_rad[i];
  }
  Publish(time_ns, present);
}

FramesTopic::FramesTopic(const std::string& topic, const std::vector<std::string>& examples,
                         const std::vector<std::string>& origins)
    : publisher_(topic, TypeOf<tf2_msgs::TFMessage>(), /*latched=*/false) {
  const auto frames = [](const std::vector<std::string>& messages) {
    std::vector<Frames> all;
    for (const std::string& bytes : messages) {
      all.push_back(Deserialized<tf2_msgs::TFMessage>(bytes).transforms);
      if (all.back().empty()) throw std::invalid_argument("an example has no frame");
    }
    return all;
  };
  robots_ = frames(examples);
  origins_ = frames(origins);
  if (!origins_.empty() && origins_.size() != robots_.size()) {
    throw std::invalid_argument("origins and examples must have the same length");
  }
}

void FramesTopic::PublishStep(std::int64_t time_ns, Rows poses, const Rows* origins, const Present& present) {
  if (!IsWanted()) return;
  tf2_msgs::TFMessage message;
  const auto add = [&](std::vector<Frames>& all, Rows rows) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!IsPresent(present, i)) continue;
      SetPlace(rows[i], all[i].front().transform.translation, all[i].front().transform.rotation);
      message.transforms.insert(message.transforms.end(), all[i].begin(), all[i].end());
    }
  };
  add(robots_, poses);
  if (origins != nullptr) add(origins_, *origins);
  for (geometry_msgs::TransformStamped& transform : message.transforms) transform.header.stamp = Stamp(time_ns);
  publisher_.Publish(Serialized(message));
}

}  // namespace robotteamsim::ros_transport

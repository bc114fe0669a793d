// The transforms on /tf and /tf_static, in tf2's own buffer.
#pragma once

#include <ros/subscriber.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace robotteamsim::ros_transport {

// A pose in the plane [m, rad]; height, roll and pitch are left out.
struct PlanarTransform {
  std::int64_t stamp_ns;  // 0 if all transforms between the two frames are static
  double x, y, yaw;
};

// roscpp's thread adds transforms, any other thread looks them up.
class TransformListener {
 public:
  TransformListener();

  // Returns the newest pose of a frame in another one. Throws tf2::TransformException if there is none.
  PlanarTransform Newest(const std::string& target, const std::string& source) const;
  // Forgets everything except static transforms: after time has jumped back, tf2 would ignore new ones as too old.
  void Clear();

 private:
  void Subscribe(const std::string& topic, bool is_static);

  // The callbacks share it, because roscpp may still run one of them when the listener is destroyed.
  std::shared_ptr<tf2::BufferCore> buffer_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace robotteamsim::ros_transport

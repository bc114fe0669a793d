#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::maps {

/// Poses in the plane and measurements between them; finds the poses that agree best with all measurements
/// [grisetti2010, Algorithm 1]. The first pose is fixed.
class PoseGraph {
 public:
  /// A measurement of pose `to` in the frame of pose `from`, and its information about x, y and yaw in that frame.
  struct Edge {
    std::size_t from = 0;
    std::size_t to = 0;
    base::Pose motion;
    Eigen::Matrix3d information;
  };

  /// Adds a pose and returns its index.
  std::size_t Add(const base::Pose& pose);

  /// Adds a measurement. Throws std::invalid_argument if it is not between two of the poses, or the motion or the
  /// information is not finite.
  void Connect(const Edge& edge);

  const std::vector<base::Pose>& poses() const { return poses_; }
  const std::vector<Edge>& edges() const { return edges_; }

  /// Moves the poses to those of the least error. A pose that no measurements connect with the first one stays.
  void Optimise();

  /// The squares of the errors of all measurements, in standard deviations.
  std::vector<double> Errors() const { return ErrorsAt(poses_); }

 private:
  std::vector<double> ErrorsAt(const std::vector<base::Pose>& poses) const;
  std::vector<base::Pose> Improved() const;

  std::vector<base::Pose> poses_;
  std::vector<Edge> edges_;
};

}  // namespace robotteamsim::maps

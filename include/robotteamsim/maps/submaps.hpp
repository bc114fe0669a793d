#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/maps/log_odds_map.hpp"
#include "robotteamsim/maps/occupancy_grid.hpp"
#include "robotteamsim/maps/pose_graph.hpp"
#include "robotteamsim/maps/scan_matcher.hpp"

namespace robotteamsim::maps {

/// What a robot saw along a few metres, in a frame of its own. It does not change any more.
struct Submap {
  plan::GridShape shape;
  std::vector<std::uint8_t> run_lengths;  ///< of its cells, see RunLengths
  std::vector<HitCell> hits;

  OccupancyGrid Grid() const;
};

/// The submaps of one robot, and a graph of their poses.
///
/// Each submap is measured in the frame of the one before, by the mapper while it drives, and in those of others that
/// it overlaps, by a match of their surfaces. A measurement has the information of the points from which it comes, not
/// a constant: along a corridor it has none. A match that contradicts all others is refused. So right loops do not make
/// a map worse.
class Submaps {
 public:
  /// Args: matcher: how submaps are matched with each other.
  explicit Submaps(const MatcherParameters& matcher);

  /// Adds a submap, matches it with those that it overlaps, and finds the best poses of all.
  /// Args: map: the submap.  pose: of its frame in the map that the robot uses.
  ///       drift: covariance of x, y and yaw of this pose in the frame of the submap before.
  /// Returns whether a submap has moved by more than kMoved in that map. Then the robot must use that of Draw.
  bool Add(const LogOddsMap& map, const base::Pose& pose, const Eigen::Matrix3d& drift);

  std::size_t size() const { return submaps_.size(); }
  const Submap& at(std::size_t index) const { return submaps_.at(index); }
  const std::vector<base::Pose>& poses() const { return graph_.poses(); }

  /// Draws the map of all submaps at their poses.
  LogOddsMap Draw(double cell_m) const;

  /// The memory of the submaps [bytes].
  std::size_t Bytes() const;

  static constexpr double kMoved = 0.05;  ///< of any of its cells [m]

 private:
  std::optional<PoseGraph::Edge> Loop(std::size_t other, const std::vector<SurfacePoint>& points,
                                      const Eigen::Matrix3d& prior, double cell_m) const;
  void Connect(std::vector<PoseGraph::Edge> loops);
  bool HaveMoved() const;

  ScanMatcher matcher_;
  std::vector<Submap> submaps_;
  std::vector<Eigen::Matrix3d> drifts_;  ///< of each submap, in the frame of the one before
  std::vector<base::Pose> drawn_;        ///< the poses in the map that the robot uses
  PoseGraph graph_;
};

}  // namespace robotteamsim::maps

#pragma once

#include <memory>
#include <utility>

#include "robotteamsim/network/hop_count.hpp"
#include "robotteamsim/network/link_bits.hpp"
#include "robotteamsim/propagation/cells.hpp"
#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/radio.hpp"

namespace robotteamsim::network {

/// The conditions for a link and for an endangered link.
struct LinkRule {
  bool by_distance = false;
  double lost_below_dbm = -94.0;        ///< by signal: a weaker signal is not a link
  double max_distance_m = 25.0;         ///< by distance: robots farther apart have no link
  double endangered_below_dbm = -80.0;  ///< a link with a weaker signal is endangered
};

/// The radio links of a team, step by step. Hops and the Fiedler value are computed only if a link appears or
/// disappears.
class TeamLinks {
 public:
  /// Args: faces: of walls and doors; doors may change between steps.
  TeamLinks(std::shared_ptr<const propagation::FaceSet> faces, const propagation::RadioModel& model,
            const LinkRule& rule)
      : faces_(std::move(faces)), model_(model), rule_(rule) {}

  /// Computes the links for these positions [m].
  /// Args: rssi: where to write the signals between all pairs of robots [dBm], 0 on the diagonal;
  ///       link: where to write L of eq. (16), 0 on the diagonal; for links by signal it is the same matrix.
  /// Returns whether links, or which of them are endangered, have changed.
  /// Throws std::invalid_argument, naming the robot, if a position is not finite.
  bool Step(const Eigen::Ref<const propagation::Positions>& positions, Eigen::Ref<propagation::CellValues> rssi,
            Eigen::Ref<propagation::CellValues> link);

  const Adjacency& adjacency() const { return adjacency_; }
  /// The links whose signal is below the limit.
  const Adjacency& endangered() const { return endangered_; }
  const HopCount& hops() const { return hops_; }
  double fiedler_value() const { return fiedler_value_; }

 private:
  struct Changes {
    bool links = false;
    bool endangered = false;
  };
  Changes FindLinks(const Eigen::Ref<const propagation::CellValues>& rssi,
                    const Eigen::Ref<const propagation::CellValues>& link);

  std::shared_ptr<const propagation::FaceSet> faces_;
  propagation::RadioModel model_;
  LinkRule rule_;
  Adjacency adjacency_, endangered_;
  HopCount hops_;
  double fiedler_value_ = 0.0;
};

}  // namespace robotteamsim::network

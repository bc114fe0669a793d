#pragma once

#include "robotteamsim/network/hop_count.hpp"
#include "robotteamsim/network/link_bits.hpp"
#include "robotteamsim/propagation/cells.hpp"
#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/radio.hpp"

namespace robotteamsim {

/// What makes a link, and what endangers it.
struct LinkRule {
  bool by_distance = false;
  double lost_below = -94.0;        ///< by signal: weaker than this [dBm] is no link
  double max_distance = 25.0;       ///< by distance: farther than this [m] is no link
  double endangered_below = -80.0;  ///< a link whose signal is weaker [dBm] is endangered
};

/// The radio links of a team, step by step. Hops and the Fiedler value are found anew only when a link comes or goes.
class TeamLinks {
 public:
  explicit TeamLinks(const LinkRule& rule) : rule_(rule) {}

  /// Looks at robots at these positions [m]. Returns whether a link came or went since the last step: at first, yes.
  /// Args: rssi: room for the signals between all pairs of robots [dBm], 0 on the diagonal;
  ///       link: room for L of eq. (16), 0 on the diagonal; for links by signal it is the same room.
  /// Throws std::invalid_argument, naming the robot, where a position is not finite.
  bool Step(const FaceSet& faces, const RadioModel& model, const Eigen::Ref<const Positions>& positions,
            Eigen::Ref<CellValues> rssi, Eigen::Ref<CellValues> link);

  const LinkRule& rule() const { return rule_; }
  const Adjacency& adjacency() const { return adjacency_; }
  /// The links that exist, but with a signal below the limit.
  const Adjacency& endangered() const { return endangered_; }
  const HopCount& hops() const { return hops_; }
  double fiedler_value() const { return fiedler_value_; }

 private:
  bool FindLinks(const Eigen::Ref<const CellValues>& rssi, const Eigen::Ref<const CellValues>& link);

  LinkRule rule_;
  Adjacency adjacency_, endangered_;
  HopCount hops_;
  double fiedler_value_ = 0.0;
};

}  // namespace robotteamsim

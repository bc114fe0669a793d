#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "robotteamsim/network/hop_count.hpp"
#include "robotteamsim/network/link_bits.hpp"
#include "robotteamsim/propagation/cells.hpp"
#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/radio.hpp"
#include "robotteamsim/state/state.hpp"

namespace robotteamsim::network {

/// The conditions for a link and for an endangered link.
struct LinkRule {
  bool by_distance = false;
  double lost_below_dbm = -94.0;        ///< by signal: a weaker signal is not a link
  double max_distance_m = 25.0;         ///< by distance: robots farther apart have no link
  double endangered_below_dbm = -80.0;  ///< a link with a weaker signal is endangered
};

/// The radio links of a team, step by step. Hops and the Fiedler value are computed only if a link appears or
/// disappears. An absent robot has no links, is on no path and does not count.
class TeamLinks {
 public:
  /// Args: faces: of walls and doors; doors may change between steps.
  TeamLinks(std::shared_ptr<const propagation::FaceSet> faces, const propagation::RadioModel& model,
            const LinkRule& rule);

  /// Whether `State::link` is another matrix than `rssi_dbm`.
  bool is_by_distance() const { return rule_.by_distance; }

  /// Writes the links of a mission's robots where they are.
  /// Throws std::invalid_argument if there is no such mission, or, naming the robot, if a position is not finite.
  void Step(state::State* state, std::size_t mission);

 private:
  using Matrix = Eigen::Ref<propagation::CellValues>;
  void FindLinks(const propagation::Positions& positions, bool has_new_team, Matrix rssi, Matrix link);

  const std::uint64_t id_;  // of these links, among all
  std::shared_ptr<const propagation::FaceSet> faces_;
  propagation::RadioModel model_;
  LinkRule rule_;
  // Of those who are present:
  std::vector<int> present_;
  Adjacency adjacency_, endangered_;
  HopCount hops_;
  double fiedler_value_ = 0.0;
  std::int64_t version_ = 0;
};

}  // namespace robotteamsim::network

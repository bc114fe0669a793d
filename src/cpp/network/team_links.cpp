#include "robotteamsim/network/team_links.hpp"

#include <cmath>

#include "robotteamsim/network/fiedler.hpp"

namespace robotteamsim::network {
namespace {

void WriteDistances(const Eigen::Ref<const propagation::Positions>& positions,
                    Eigen::Ref<propagation::CellValues> distances) {
  const Eigen::Index n = positions.rows();
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      distances(i, j) = std::hypot(positions(i, 0) - positions(j, 0), positions(i, 1) - positions(j, 1));
    }
  }
}

}  // namespace

bool TeamLinks::Step(const Eigen::Ref<const propagation::Positions>& positions,
                     Eigen::Ref<propagation::CellValues> rssi, Eigen::Ref<propagation::CellValues> link) {
  propagation::WriteRssiMatrixDbm(*faces_, model_, positions, rssi);
  if (rule_.by_distance) WriteDistances(positions, link);
  const Changes changes = FindLinks(rssi, link);
  if (changes.links) {
    hops_ = CountHops(adjacency_);
    fiedler_value_ = FiedlerValue(adjacency_);
  }
  return changes.links || changes.endangered;
}

TeamLinks::Changes TeamLinks::FindLinks(const Eigen::Ref<const propagation::CellValues>& rssi,
                                        const Eigen::Ref<const propagation::CellValues>& link) {
  const Eigen::Index n = link.rows();
  Changes changes{adjacency_.rows() != n, adjacency_.rows() != n};
  if (changes.links) {
    adjacency_.setConstant(n, n, false);
    endangered_.setConstant(n, n, false);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const bool is_near = rule_.by_distance ? link(i, j) <= rule_.max_distance_m : link(i, j) >= rule_.lost_below_dbm;
      const bool is_link = is_near && i != j;
      changes.links |= adjacency_(i, j) != is_link;
      adjacency_(i, j) = is_link;
      const bool is_endangered = is_link && rssi(i, j) < rule_.endangered_below_dbm;
      changes.endangered |= endangered_(i, j) != is_endangered;
      endangered_(i, j) = is_endangered;
    }
  }
  return changes;
}

}  // namespace robotteamsim::network

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

void TeamLinks::Step(const Eigen::Ref<const propagation::Positions>& positions,
                     Eigen::Ref<propagation::CellValues> rssi, Eigen::Ref<propagation::CellValues> link) {
  propagation::WriteRssiMatrixDbm(*faces_, model_, positions, rssi);
  if (rule_.by_distance) WriteDistances(positions, link);
  const std::int64_t before = version_;
  FindLinks(rssi, link);
  if (version_ == before) return;
  hops_ = CountHops(adjacency_);
  fiedler_value_ = FiedlerValue(adjacency_);
}

void TeamLinks::FindLinks(const Eigen::Ref<const propagation::CellValues>& rssi,
                          const Eigen::Ref<const propagation::CellValues>& link) {
  const Eigen::Index n = link.rows();
  bool has_changed = adjacency_.rows() != n, endangered_has_changed = has_changed;
  if (has_changed) {
    adjacency_.setConstant(n, n, false);
    endangered_.setConstant(n, n, false);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const bool is_near = rule_.by_distance ? link(i, j) <= rule_.max_distance : link(i, j) >= rule_.lost_below;
      const bool is_link = is_near && i != j;
      has_changed |= adjacency_(i, j) != is_link;
      adjacency_(i, j) = is_link;
      const bool is_endangered = is_link && rssi(i, j) < rule_.endangered_below;
      endangered_has_changed |= endangered_(i, j) != is_endangered;
      endangered_(i, j) = is_endangered;
    }
  }
  version_ += has_changed ? 1 : 0;
  endangered_version_ += endangered_has_changed ? 1 : 0;
}

}  // namespace robotteamsim::network

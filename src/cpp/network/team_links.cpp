#include "robotteamsim/network/team_links.hpp"

#include <cmath>

#include "robotteamsim/network/fiedler.hpp"

namespace robotteamsim {
namespace {

void WriteDistances(const Eigen::Ref<const Positions>& positions, Eigen::Ref<CellValues> distances) {
  const Eigen::Index n = positions.rows();
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      distances(i, j) = std::hypot(positions(i, 0) - positions(j, 0), positions(i, 1) - positions(j, 1));
    }
  }
}

}  // namespace

bool TeamLinks::Step(const FaceSet& faces, const RadioModel& model, const Eigen::Ref<const Positions>& positions,
                     Eigen::Ref<CellValues> rssi, Eigen::Ref<CellValues> link) {
  WriteRssiMatrixDbm(faces, model, positions, rssi);
  if (rule_.by_distance) WriteDistances(positions, link);
  if (!FindLinks(rssi, link)) return false;
  hops_ = CountHops(adjacency_);
  fiedler_value_ = FiedlerValue(adjacency_);
  return true;
}

// Returns whether a link came or went.
bool TeamLinks::FindLinks(const Eigen::Ref<const CellValues>& rssi, const Eigen::Ref<const CellValues>& link) {
  const Eigen::Index n = link.rows();
  bool has_changed = adjacency_.rows() != n;
  if (has_changed) adjacency_.setConstant(n, n, false);
  endangered_.resize(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const bool is_near = rule_.by_distance ? link(i, j) <= rule_.max_distance : link(i, j) >= rule_.lost_below;
      const bool is_link = is_near && i != j;
      has_changed |= adjacency_(i, j) != is_link;
      adjacency_(i, j) = is_link;
      endangered_(i, j) = is_link && rssi(i, j) < rule_.endangered_below;
    }
  }
  return has_changed;
}

}  // namespace robotteamsim

#include "robotteamsim/network/team_links.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/network/fiedler.hpp"

namespace robotteamsim::network {
namespace {

void WriteDistances(const propagation::FaceSet& faces, const propagation::Positions& positions,
                    Eigen::Ref<propagation::CellValues> distances) {
  const Eigen::Index n = positions.rows();
  const auto at = [&](Eigen::Index i) { return propagation::RoundToMm({positions(i, 0), positions(i, 1)}, "a robot"); };
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      distances(i, j) = faces.storeys().size() > 1 && faces.StoreyOf(at(i)) != faces.StoreyOf(at(j))
                            ? std::sqrt(faces.Between(at(i), at(j)).square_mm2) / 1000.0
                            : std::hypot(positions(i, 0) - positions(j, 0), positions(i, 1) - positions(j, 1));
    }
  }
}

/// Writes a matrix of the present robots into that of all robots, which has `nothing` for the others.
template <typename Matrix, typename Value>
void Spread(const Matrix& matrix, const std::vector<int>& present, std::size_t robots, Value nothing, Value* all) {
  if (present.size() == robots) {
    std::copy(matrix.data(), matrix.data() + matrix.size(), all);
    return;
  }
  std::fill(all, all + robots * robots, nothing);
  for (std::size_t i = 0; i < present.size(); ++i) {
    for (std::size_t j = 0; j < present.size(); ++j) {
      all[present[i] * robots + present[j]] =
          static_cast<Value>(matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
    }
  }
}

std::uint64_t NextId() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace

TeamLinks::TeamLinks(std::shared_ptr<const propagation::FaceSet> faces, const propagation::RadioModel& model,
                     const LinkRule& rule)
    : id_(NextId()), faces_(std::move(faces)), model_(model), rule_(rule) {}

void TeamLinks::Step(state::State* state, std::size_t mission) {
  if (mission >= state->missions) throw std::invalid_argument("no such mission");
  state->NeedLinks(rule_.by_distance);
  const std::size_t robots = state->robots;
  const std::vector<base::Point> at = state->Positions(mission);
  std::vector<int> present;
  for (std::size_t i = 0; i < robots; ++i) {
    if (std::isnan(at[i].x)) continue;
    base::Check(at[i], ("position of robot " + std::to_string(i)).c_str());
    present.push_back(static_cast<int>(i));
  }
  const auto n = static_cast<Eigen::Index>(present.size());
  propagation::Positions positions(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) positions.row(i) << at[present[i]].x, at[present[i]].y;
  const bool has_new_team = present != present_ || version_ == 0;
  if (has_new_team) {  // the links of other robots are other links
    present_ = present;
    adjacency_.setConstant(n, n, false);
    endangered_.setConstant(n, n, false);
  }
  const std::size_t cells = state->Matrix(mission);
  double* const rssi = &state->rssi_dbm[cells];
  double* const link = rule_.by_distance ? &state->link[cells] : rssi;
  if (present_.size() == robots) {
    FindLinks(positions, has_new_team, Eigen::Map<propagation::CellValues>(rssi, n, n),
              Eigen::Map<propagation::CellValues>(link, n, n));
  } else {
    propagation::CellValues signals(n, n), lengths;
    if (rule_.by_distance) lengths.resize(n, n);
    FindLinks(positions, has_new_team, signals, rule_.by_distance ? lengths : signals);
    Spread(signals, present_, robots, -std::numeric_limits<double>::infinity(), rssi);
    if (rule_.by_distance) Spread(lengths, present_, robots, 0.0, link);
  }
  // In a batch others may have links by distance.
  if (!rule_.by_distance && !state->link.empty()) std::copy_n(rssi, robots * robots, &state->link[cells]);
  // A state that is used again may have these links from an earlier step.
  if (state->links_source[mission] == id_ && state->links_version[mission] == version_) return;
  Spread(adjacency_, present_, robots, std::uint8_t{0}, &state->adjacency[cells]);
  Spread(endangered_, present_, robots, std::uint8_t{0}, &state->endangered[cells]);
  Spread(hops_, present_, robots, std::int32_t{-1}, &state->hop_count[cells]);
  state->fiedler_value[mission] = fiedler_value_;
  state->links_version[mission] = version_;
  state->links_source[mission] = id_;
}

void TeamLinks::FindLinks(const propagation::Positions& positions, bool has_new_team, Matrix rssi, Matrix link) {
  const Eigen::Index n = positions.rows();
  if (n > 0) propagation::WriteRssiMatrixDbm(*faces_, model_, positions, rssi);
  if (rule_.by_distance) WriteDistances(*faces_, positions, link);
  bool has_new_links = has_new_team, has_changed = has_new_team;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const bool is_near = rule_.by_distance ? link(i, j) <= rule_.max_distance_m : link(i, j) >= rule_.lost_below_dbm;
      const bool is_link = is_near && i != j;
      has_new_links |= adjacency_(i, j) != is_link;
      adjacency_(i, j) = is_link;
      const bool is_endangered = is_link && rssi(i, j) < rule_.endangered_below_dbm;
      has_changed |= endangered_(i, j) != is_endangered;
      endangered_(i, j) = is_endangered;
    }
  }
  if (has_new_links) {
    hops_ = CountHops(adjacency_);
    fiedler_value_ = n > 0 ? FiedlerValue(adjacency_) : 0.0;
  }
  if (has_new_links || has_changed) ++version_;
}

}  // namespace robotteamsim::network

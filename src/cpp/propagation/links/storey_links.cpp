#include "robotteamsim/propagation/links/storey_links.hpp"

namespace robotteamsim::propagation {
namespace {

/// Up to this number of targets, single links are as fast as tables of directions and faces.
constexpr std::size_t kFewTargets = 8;

}  // namespace

StoreyLinks::StoreyLinks(const FaceSet& faces, base::Simd simd)
    : faces_(faces), simd_(simd), links_(faces.storeys().size()) {}

CellValues StoreyLinks::WallsBetween(std::size_t low, const std::vector<PointMm>& below, std::size_t high,
                                     const std::vector<PointMm>& above) {
  const FaceSet::Rise& rise = faces_.RiseOf(low, high);
  const Points lower{low, below}, upper{high, above};
  CellValues weights = WeightsOn(low, lower, upper, rise.leaving);
  weights += WeightsOn(high, upper, lower, 1.0 - rise.entering).transpose();
  for (const FaceSet::Passed& passed : rise.in_between) {
    const CellValues before = WeightsOn(passed.storey, lower, upper, passed.from);
    weights += (WeightsOn(passed.storey, lower, upper, passed.to) - before).cwiseMax(0.0);
  }
  return weights;
}

/// Returns the weights of the faces of a storey from each of some points to a share of the way to each of others, all
/// as if they were on that storey.
CellValues StoreyLinks::WeightsOn(std::size_t storey, const Points& from, const Points& to, double share) {
  CellValues weights(static_cast<Eigen::Index>(from.at.size()), static_cast<Eigen::Index>(to.at.size()));
  ends_.resize(to.at.size());
  for (Eigen::Index i = 0; i < weights.rows(); ++i) {
    const PointMm start = faces_.Moved(from.at[i], from.storey, storey);
    for (std::size_t j = 0; j < ends_.size(); ++j) {
      ends_[j] = Along(start, faces_.Moved(to.at[j], to.storey, storey), share);
    }
    if (ends_.size() <= kFewTargets) {
      for (Eigen::Index j = 0; j < weights.cols(); ++j) {
        weights(i, j) = static_cast<double>(faces_.OnStorey(storey).WeightBetween(start, ends_[j]));
      }
    } else {
      const LinkTargets found = LinksOn(storey).From(start, ends_.data(), ends_.size());
      for (Eigen::Index j = 0; j < weights.cols(); ++j) weights(i, j) = found.Weight(j);
    }
  }
  return weights;
}

LinkWeights& StoreyLinks::LinksOn(std::size_t storey) {
  if (!links_[storey]) links_[storey].emplace(faces_.OnStorey(storey), simd_);
  return *links_[storey];
}

}  // namespace robotteamsim::propagation

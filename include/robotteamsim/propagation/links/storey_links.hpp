#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "robotteamsim/base/simd.hpp"
#include "robotteamsim/propagation/cells.hpp"
#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/links/link_weights.hpp"

namespace robotteamsim::propagation {

/// The weights of the walls between many points of two storeys: equal to FaceSet::WallsBetween.
class StoreyLinks {
 public:
  /// Args: faces: must outlive this object and not change.
  explicit StoreyLinks(const FaceSet& faces, base::Simd simd = base::BestSimd());

  /// Returns the weights of the walls, one row per point below and one column per point above.
  CellValues WallsBetween(std::size_t low, const std::vector<PointMm>& below, std::size_t high,
                          const std::vector<PointMm>& above);

 private:
  /// Points of the plan and the storey on which they lie.
  struct Points {
    std::size_t storey;
    const std::vector<PointMm>& at;
  };

  CellValues WeightsOn(std::size_t storey, const Points& from, const Points& to, double share);
  LinkWeights& LinksOn(std::size_t storey);

  const FaceSet& faces_;
  const base::Simd simd_;
  std::vector<std::optional<LinkWeights>> links_;  // on each storey, if it was asked for
  std::vector<PointMm> ends_;
};

}  // namespace robotteamsim::propagation

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/link_kernels.hpp"

namespace robotteamsim {

/// What the faces weigh between all pairs of many points: the same numbers as FaceSet::WeightBetween.
///
/// Seen from one point, the others are sorted by direction into bins. A face shades those between its two ends that are
/// beyond its line, so it is compared only with the bins from one end to the other. The tests of directions and sides
/// are exact in doubles where all coordinates are within 4 km; beyond that, links are counted one by one.
class LinkWeights {
 public:
  /// Args: faces: must outlive this object, and stay as they are.
  /// Throws std::invalid_argument where this machine does not have the instruction set.
  LinkWeights(const FaceSet& faces, std::vector<PointMm> points, Simd simd = BestSimd());

  /// Returns the weights from a point to each of those after it; valid until the next call.
  const std::vector<double>& After(std::size_t source);

 private:
  void AddFace(const Face& face);
  std::int32_t AddCorner(PointMm corner);
  void CountOneByOne(std::size_t source);
  void SortTargets(const LinkSource& source, std::size_t first);
  void AddFacesAt(std::size_t source);

  const FaceSet& face_set_;
  const std::vector<PointMm> points_;
  const LinkKernels& kernels_;
  bool exact_in_doubles_ = true;
  std::vector<double> point_x_, point_y_;  // [mm]
  LinkCorners corners_;
  LinkFaces faces_;
  std::vector<std::size_t> number_in_set_;  // of each of faces_
  std::vector<double> directions_;          // of the targets
  std::vector<std::int32_t> bins_;
  std::vector<std::int32_t> bin_start_;
  std::vector<std::int32_t> order_;  // of the targets, by bins
  std::vector<TargetBlock> blocks_;
  std::vector<double> weights_;
};

}  // namespace robotteamsim

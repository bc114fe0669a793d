#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/links/link_kernels.hpp"

namespace robotteamsim::propagation {

/// What is between a point and those after it, these in some order: the one i + 1 places after the point is target
/// places[i], in lane places[i] % kLinkLanes of block places[i] / kLinkLanes.
struct LinkTargets {
  int count = 0;
  const TargetBlock* blocks = nullptr;
  const std::int32_t* places = nullptr;
};

/// What the faces weigh between all pairs of many points: the same numbers as FaceSet::WeightBetween.
///
/// Seen from one point, the others are sorted by direction into bins. A face shades those between its two ends that are
/// beyond its line, so it is compared only with the bins from one end to the other. The four faces of a convex ring are
/// taken together: between its outermost corners, each target is before, in or behind it. The tests of directions and
/// sides are exact in doubles where all coordinates are within 4 km; beyond that, links are counted one by one.
class LinkWeights {
 public:
  /// Args: faces: must outlive this object, and stay as they are.
  /// Throws std::invalid_argument where this machine does not have the instruction set.
  LinkWeights(const FaceSet& faces, std::vector<PointMm> points, base::Simd simd = base::BestSimd());

  /// Returns the points after a point with the weights between; valid until the next call.
  LinkTargets After(std::size_t source);

 private:
  /// Screens of a kind, and the first face of each in the set.
  template <int kFaces>
  struct Screens {
    std::vector<ScreenBlock<kFaces>> blocks;
    std::vector<std::size_t> first_face;
  };

  void AddFaces();
  void AddScreenAt(std::size_t first_face, std::optional<std::array<Face, 4>> ring);
  template <int kFaces>
  void AddScreen(std::size_t first_face, const std::array<Face, kFaces>& faces, bool is_box, Screens<kFaces>* screens);
  void CountOneByOne(std::size_t source);
  void SortTargets(std::size_t source);
  template <int kFaces>
  void AddScreensAt(std::size_t source, const Screens<kFaces>& screens);

  const FaceSet& face_set_;
  const std::vector<PointMm> points_;
  const LinkKernels& kernels_;
  bool exact_in_doubles_ = true;
  std::vector<double> point_x_, point_y_;  // [mm]
  Screens<1> faces_;
  Screens<4> rings_;
  Screens<4> boxes_;
  std::vector<std::int32_t> scratch_;
  LinkSource seen_from_;
  std::vector<double> directions_;  // of the targets
  std::vector<std::int32_t> bins_;
  std::vector<std::int32_t> bin_start_;
  std::vector<std::int32_t> order_;   // of the targets, by bins
  std::vector<std::int32_t> places_;  // of each in that order
  std::vector<TargetBlock> blocks_;
};

}  // namespace robotteamsim::propagation

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/links/link_kernels.hpp"

namespace robotteamsim::propagation {

/// The weights between a point and others, in some order: the i-th of these is target places[i], in lane places[i] %
/// kLinkLanes of block places[i] / kLinkLanes.
struct LinkTargets {
  double Weight(std::size_t i) const { return blocks[places[i] / kLinkLanes].weight[places[i] % kLinkLanes]; }

  int count = 0;
  const TargetBlock* blocks = nullptr;
  const std::int32_t* places = nullptr;
};

/// The weights of the faces between points and many others: equal to FaceSet::WeightBetween.
///
/// For each point, the others are sorted into bins by direction. A face shades the points between its two ends that are
/// beyond its line, so only the bins from one end to the other are tested. The four faces of a convex ring are
/// processed together: between its outermost corners, each target is before, in or behind it. The tests are exact in
/// doubles if all coordinates are within 4 km; otherwise links are computed one by one.
class LinkWeights {
 public:
  /// Args: faces: must outlive this object and not change.
  /// Throws std::invalid_argument if this machine does not support the instruction set.
  explicit LinkWeights(const FaceSet& faces, base::Simd simd = base::BestSimd());

  /// Returns targets from a point with the weights between them; valid until the next call.
  LinkTargets From(PointMm source, const PointMm* targets, std::size_t count);

 private:
  /// Screens of one kind and the index of the first face of each.
  template <int kFaces>
  struct Screens {
    std::vector<ScreenBlock<kFaces>> blocks;
    std::vector<std::size_t> first_face;
  };

  void AddFaces();
  void AddScreenAt(std::size_t first_face, std::optional<std::array<Face, 4>> ring);
  template <int kFaces>
  void AddScreen(std::size_t first_face, const std::array<Face, kFaces>& faces, bool is_box, Screens<kFaces>* screens);
  void CountOneByOne(PointMm source, const PointMm* targets);
  void SortTargets(PointMm source, const PointMm* targets);
  template <int kFaces>
  void AddScreensAt(PointMm source, const PointMm* targets, const Screens<kFaces>& screens);

  const FaceSet& face_set_;
  const LinkKernels& kernels_;
  bool exact_in_doubles_ = true;
  std::vector<double> target_x_, target_y_;  // [mm]
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

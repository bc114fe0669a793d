#pragma once

#include <cstdint>

#include "robotteamsim/base/simd.hpp"

namespace robotteamsim::propagation {

// A direction (dx, dy) from a source is represented by a number from 0 to 4: 0 is down, 1 right, 2 up, 3 left. It is dy
// / (|dx| + |dy|) on the right half, shifted by whole numbers. Coordinates are whole numbers up to 2^22 here, so
// quotients of different directions differ by 2^-48 or more, and rounding, 2^-51 at most, keeps their order; equal
// directions have equal quotients.

/// Number of links or screens that are processed together.
constexpr int kLinkLanes = 8;

/// Targets of the links from a source, in the order of the bins of their directions.
struct TargetBlock {
  alignas(64) double x[kLinkLanes];  // from the source [mm]
  alignas(64) double y[kLinkLanes];
  alignas(64) double direction[kLinkLanes];
  alignas(64) double weight[kLinkLanes];  // sum over the screens so far
};

/// Screens: single faces, or convex rings of kFaces faces. Face j runs from corner j to the next, with a ring's inside
/// to its left; the second face of a single face is the same in reverse.
template <int kFaces>
struct ScreenBlock {
  static constexpr int kCorners = kFaces == 1 ? 2 : kFaces;

  // In the map frame.
  alignas(64) double x[kCorners][kLinkLanes];  // of the corners [mm]
  alignas(64) double y[kCorners][kLinkLanes];
  alignas(64) double normal_x[kFaces][kLinkLanes];  // to the left of a face, of its length [mm]; of length 1 for boxes
  alignas(64) double normal_y[kFaces][kLinkLanes];
  alignas(64) double least_left[kFaces][kLinkLanes];  // points with normal * (point - corner) >= this, 0 or 1, are left
  alignas(64) double weight[kLinkLanes];              // of each face; 0 where there is no screen

  // Relative to a source. A near face has the source outside of the ring, a far face inside. A target is beyond a near
  // face if away * target >= near_from, and beyond a far face if away * target >= far_from.
  alignas(64) double away_x[kFaces][kLinkLanes];  // across the face, away from the source
  alignas(64) double away_y[kFaces][kLinkLanes];
  alignas(64) double near_from[kFaces][kLinkLanes];  // -infinity for far faces
  alignas(64) double far_from[kFaces][kLinkLanes];   // +infinity for near faces
  alignas(64) double is_around[kLinkLanes];          // 1 if the source is in the ring, else 0
  alignas(64) double from[kLinkLanes];               // the covered directions
  alignas(64) double to[kLinkLanes];
  alignas(64) std::int32_t first[kLinkLanes];  // range of targets that contains those directions
  alignas(64) std::int32_t end[kLinkLanes];
  alignas(64) std::int32_t is_seen[kLinkLanes];  // 1 if it may shade targets
  alignas(64) double left_out[kLinkLanes];  // > 0 if the source is on a corner at the end of the covered directions
};

/// A source [mm] and the bins of the directions around it: targets bin_start[b] .. bin_start[b + 1] - 1 are in bin b.
struct LinkSource {
  double x = 0.0;
  double y = 0.0;
  int num_bins = 0;
  const std::int32_t* bin_start = nullptr;
  int num_targets = 0;
};

/// The hot loops of LinkWeights, for one instruction set.
struct LinkKernels {
  /// Sets direction and bin of each point.
  void (*find_directions)(const LinkSource& source, const double* x, const double* y, double* directions,
                          std::int32_t* bins);

  /// Fills blocks with targets in an order; unused lanes of the last block take no weight.
  void (*fill_blocks)(const LinkSource& source, const double* x, const double* y, const double* directions,
                      const std::int32_t* order, TargetBlock* blocks);

  /// Adds to the targets the weights of the faces between them and the source, except for screens left out. Returns
  /// whether any was left out. Args: scratch: one number per screen and one more.
  bool (*add_faces)(const LinkSource& source, ScreenBlock<1>* screens, int num_blocks, std::int32_t* scratch,
                    TargetBlock* targets);
  bool (*add_rings)(const LinkSource& source, ScreenBlock<4>* screens, int num_blocks, std::int32_t* scratch,
                    TargetBlock* targets);

  /// The same for boxes: rings whose normals are along x, y, x and y, so that half of each product is 0.
  bool (*add_boxes)(const LinkSource& source, ScreenBlock<4>* screens, int num_blocks, std::int32_t* scratch,
                    TargetBlock* targets);
};

/// Returns the loops. Throws std::invalid_argument if this machine does not support the instruction set.
const LinkKernels& LinkKernelsFor(base::Simd simd);

}  // namespace robotteamsim::propagation

#pragma once

#include <cstdint>
#include <vector>

#include "robotteamsim/propagation/simd.hpp"

namespace robotteamsim {

// Seen from a source, a direction (dx, dy) is a number from 0 to 4: 0 is straight down, 1 along x, 2 straight up, 3
// against x. It is dy / (|dx| + |dy|) on the right half, shifted by whole numbers. Coordinates are whole numbers up to
// 2^22 here, so quotients of different directions differ by 2^-48 or more, and rounding, 2^-51 at most, keeps their
// order; equal directions have equal quotients.

/// Targets of the links from a source, in the order of the bins of their directions; eight at a time.
struct TargetBlock {
  static constexpr int kLanes = 8;
  alignas(64) double x[kLanes];  // from the source [mm]
  alignas(64) double y[kLanes];
  alignas(64) double direction[kLanes];
  alignas(64) double weight[kLanes];  // sum over the faces so far
};

/// The points at which faces end, and where they lie among the targets.
struct LinkCorners {
  std::vector<double> x, y;             // [mm]
  std::vector<double> direction;        // seen from the source, or 2^-50 more: targets on that ray are then before it
  std::vector<std::int32_t> bin;        // of the direction
  std::vector<std::int32_t> first_run;  // targets in that bin, from
  std::vector<std::int32_t> end_run;    // .. to before
};

/// The faces that weigh: their ends among the corners, and what is seen of them.
struct LinkFaces {
  std::vector<std::int32_t> start, end;
  std::vector<double> start_x, start_y;            // [mm]
  std::vector<double> along_x, along_y;            // from start to end [mm]
  std::vector<double> tie_is_left;                 // 1 where a point on the face's line is left of it, else 0
  std::vector<double> weight;                      // of each
  std::vector<double> side;                        // of the source: > 0 left of the face, 0 on its line
  std::vector<double> normal_x, normal_y, beyond;  // a target is beyond the line where normal * target >= beyond
  std::vector<std::int32_t> right, left;           // ends as seen from the source
  std::vector<std::int32_t> seen;                  // faces with targets between their ends, and one place to spare
};

/// A source [mm] and the bins of the directions around it: targets bin_start[b] .. bin_start[b + 1] - 1 are in bin b.
struct LinkSource {
  double x = 0.0;
  double y = 0.0;
  int num_bins = 0;
  const std::int32_t* bin_start = nullptr;
};

/// The hot loops of LinkWeights, for one instruction set.
struct LinkKernels {
  /// Sets direction and bin of each point.
  void (*find_directions)(const LinkSource& source, const double* x, const double* y, int count, double* directions,
                          std::int32_t* bins);

  /// Fills blocks with targets in an order; what is left of the last block takes no weight.
  void (*fill_blocks)(const LinkSource& source, const double* x, const double* y, const double* directions,
                      const std::int32_t* order, int count, TargetBlock* blocks);

  /// Adds each face's weight to the targets behind it. Faces whose line runs through the source are left out.
  void (*add_weights)(const LinkSource& source, LinkCorners* corners, LinkFaces* faces, int count, TargetBlock* blocks);
};

/// Returns the loops. Throws std::invalid_argument where this machine does not have the instruction set.
const LinkKernels& LinkKernelsFor(Simd simd);

}  // namespace robotteamsim

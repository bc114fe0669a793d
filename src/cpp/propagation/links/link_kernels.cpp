#include "robotteamsim/propagation/links/link_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace robotteamsim::propagation {
namespace {

constexpr int kLanes = kLinkLanes;

/// Direction of a target at the source, which nothing shades, and of an unused lane.
constexpr double kNoDirection = 4.5;
constexpr double kNoTarget = 9.0;

/// Below and above all directions.
constexpr double kBeforeAll = -1.0;
constexpr double kAfterAll = 5.0;

/// Less than the smallest difference of two directions.
constexpr double kLittle = 0x1p-50;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

ROBOTTEAMSIM_INLINE double DirectionOf(double dx, double dy) {
  const double length = std::abs(dx) + std::abs(dy);
  const double along_y = dy / std::max(length, 1.0);
  const double direction = (dx < 0.0 ? 2.0 - along_y : along_y) + 1.0;
  return length > 0.0 ? direction : kNoDirection;
}

ROBOTTEAMSIM_INLINE std::int32_t BinOf(double direction, double bins_per_quarter, std::int32_t last_bin) {
  return std::min(static_cast<std::int32_t>(direction * bins_per_quarter), last_bin);
}

/// One corner of each screen of a block and the targets there.
struct Ends {
  alignas(64) double x[kLanes];  // [mm]
  alignas(64) double y[kLanes];
  alignas(64) double parts_at[kLanes];     // the direction that separates targets before and after the end
  alignas(64) std::int32_t first[kLanes];  // range of targets in the bin of the direction: from
  alignas(64) std::int32_t end[kLanes];    // .. to end - 1
};

struct Loops {
  static ROBOTTEAMSIM_INLINE void FindDirections(const LinkSource& source, const double* __restrict x,
                                                 const double* __restrict y, double* __restrict directions,
                                                 std::int32_t* __restrict bins) {
    const double source_x = source.x;
    const double source_y = source.y;
    const double bins_per_quarter = source.num_bins / 4.0;
    const std::int32_t last_bin = source.num_bins - 1;
    const int count = source.num_targets;
    for (int i = 0; i < count; ++i) {
      directions[i] = DirectionOf(x[i] - source_x, y[i] - source_y);
      bins[i] = BinOf(directions[i], bins_per_quarter, last_bin);
    }
  }

  static ROBOTTEAMSIM_INLINE void FillBlocks(const LinkSource& source, const double* __restrict x,
                                             const double* __restrict y, const double* __restrict directions,
                                             const std::int32_t* __restrict order, TargetBlock* __restrict blocks) {
    const double source_x = source.x;
    const double source_y = source.y;
    const int count = source.num_targets;
    const int whole = count / kLanes;
    for (int b = 0; b < whole; ++b) {
      const std::int32_t* const targets = order + std::ptrdiff_t{b} * kLanes;
      TargetBlock& __restrict block = blocks[b];
#pragma GCC unroll 1  // if unrolled here, the lanes would be loaded one by one
      for (int i = 0; i < kLanes; ++i) {
        block.x[i] = x[targets[i]] - source_x;
        block.y[i] = y[targets[i]] - source_y;
        block.direction[i] = directions[targets[i]];
        block.weight[i] = 0.0;
      }
    }
    TargetBlock& last = blocks[whole];
    for (int i = 0; i < kLanes; ++i) {
      const int k = whole * kLanes + i;
      last.x[i] = k < count ? x[order[k]] - source_x : 0.0;
      last.y[i] = k < count ? y[order[k]] - source_y : 0.0;
      last.direction[i] = k < count ? directions[order[k]] : kNoTarget;
      last.weight[i] = 0.0;
    }
  }

  /// Finds the region beyond each face and the outermost corners of the screens of a block: the end of the last near
  /// face and the start of the first.
  template <int kFaces>
  static ROBOTTEAMSIM_INLINE void FindEnds(const LinkSource& source, ScreenBlock<kFaces>* block, Ends* __restrict right,
                                           Ends* __restrict left) {
    constexpr int kCorners = ScreenBlock<kFaces>::kCorners;
    const double source_x = source.x;
    const double source_y = source.y;
    ScreenBlock<kFaces>& __restrict b = *block;
#pragma GCC unroll 1  // if unrolled here, the lanes would not be vectorised
    for (int i = 0; i < kLanes; ++i) {
      double is_near[kCorners];
#pragma GCC unroll 4
      for (int j = 0; j < kFaces; ++j) {
        const double from_left = b.normal_x[j][i] * (source_x - b.x[j][i]) + b.normal_y[j][i] * (source_y - b.y[j][i]) -
                                 b.least_left[j][i];  // a whole number, to the left if >= 0
        const double beyond_if_far = from_left + 1.0;
        const bool is_right = from_left < 0.0;
        const double sign = is_right ? 1.0 : -1.0;
        b.away_x[j][i] = sign * b.normal_x[j][i];
        b.away_y[j][i] = sign * b.normal_y[j][i];
        is_near[j] = is_right ? 1.0 : 0.0;
        if constexpr (kFaces == 1) {
          is_near[1] = is_right ? 0.0 : 1.0;
          b.near_from[j][i] = is_right ? -from_left : beyond_if_far;
        } else {
          b.near_from[j][i] = is_right ? -from_left : -kInfinity;
          b.far_from[j][i] = is_right ? kInfinity : beyond_if_far;
        }
      }
      double near_faces = 0.0, right_x = 0.0, right_y = 0.0, left_x = 0.0, left_y = 0.0;
#pragma GCC unroll 4
      for (int j = 0; j < kCorners; ++j) {
        const int before = (j + kCorners - 1) % kCorners;
        const bool is_right = is_near[j] < is_near[before];
        const bool is_left = is_near[j] > is_near[before];
        near_faces += is_near[j];
        right_x = is_right ? b.x[j][i] : right_x;
        right_y = is_right ? b.y[j][i] : right_y;
        left_x = is_left ? b.x[j][i] : left_x;
        left_y = is_left ? b.y[j][i] : left_y;
      }
      right->x[i] = right_x;
      right->y[i] = right_y;
      left->x[i] = left_x;
      left->y[i] = left_y;
      b.is_around[i] = near_faces == 0.0 ? 1.0 : 0.0;
    }
  }

  /// Finds the targets in the bin of each end and the direction of the end that separates targets.
  static ROBOTTEAMSIM_INLINE void FindRuns(const LinkSource& source, Ends* __restrict ends) {
    const double source_x = source.x;
    const double source_y = source.y;
    const double bins_per_quarter = source.num_bins / 4.0;
    const std::int32_t last_bin = source.num_bins - 1;
    const std::int32_t* __restrict const bin_start = source.bin_start;
    alignas(64) double directions[kLanes];
#pragma GCC unroll 1
    for (int i = 0; i < kLanes; ++i) directions[i] = DirectionOf(ends->x[i] - source_x, ends->y[i] - source_y);
#pragma GCC unroll 1
    for (int i = 0; i < kLanes; ++i) ends->first[i] = bin_start[BinOf(directions[i], bins_per_quarter, last_bin)];
#pragma GCC unroll 1
    for (int i = 0; i < kLanes; ++i) ends->end[i] = bin_start[BinOf(directions[i], bins_per_quarter, last_bin) + 1];
      // For a target on the ray through a corner: shifted by (eps, eps^2), the corner is to the right of the ray in the
      // upper half (and to the left of the source), and to the left of it in the lower half (and to the right): such
      // targets are before it.
#pragma GCC unroll 1
    for (int i = 0; i < kLanes; ++i) {
      const double direction = directions[i];
      ends->parts_at[i] = ((direction <= 1.0) | (direction > 3.0)) ? direction + kLittle : direction;
    }
  }

  /// Finds the directions that the screens of a block cover from a source.
  template <int kFaces>
  static ROBOTTEAMSIM_INLINE void LookAtBlock(const LinkSource& source, ScreenBlock<kFaces>* block) {
    Ends right, left;
    FindEnds(source, block, &right, &left);
    FindRuns(source, &right);
    FindRuns(source, &left);
    ScreenBlock<kFaces>& __restrict b = *block;
#pragma GCC unroll 1
    for (int i = 0; i < kLanes; ++i) {
      const bool is_in = b.is_around[i] > 0.0;
      const bool is_on_end = (right.parts_at[i] >= kNoDirection) | (left.parts_at[i] >= kNoDirection);
      b.from[i] = is_in ? kBeforeAll : right.parts_at[i];
      b.to[i] = is_in ? kAfterAll : left.parts_at[i];
      b.near_from[0][i] = is_in ? kInfinity : b.near_from[0][i];
      b.left_out[i] = ((!is_in) & is_on_end) ? b.weight[i] : 0.0;
    }
    const std::int32_t num_targets = source.num_targets;
#pragma GCC unroll 1
    for (int i = 0; i < kLanes; ++i) {
      const bool is_in = b.is_around[i] > 0.0;
      b.first[i] = is_in ? 0 : right.first[i];
      b.end[i] = is_in ? num_targets : left.end[i];
      // Directions may wrap around at straight down; a face seen edge-on covers none.
      const bool has_targets = ((b.from[i] < b.to[i]) & (b.first[i] < b.end[i])) | (b.from[i] > b.to[i]);
      b.is_seen[i] = (has_targets & (b.weight[i] > b.left_out[i])) ? 1 : 0;
    }
  }

  /// Adds the weight of the faces of a screen between the source and the targets within two directions. Normals of a
  /// box are along x, y, x and y.
  template <bool kIsBox, int kFaces>
  static ROBOTTEAMSIM_INLINE void Shade(const ScreenBlock<kFaces>& screen, int lane, double from, double to,
                                        std::int32_t first, std::int32_t end, TargetBlock* targets) {
    double away_x[kFaces], away_y[kFaces], near_from[kFaces], far_from[kFaces];
    for (int j = 0; j < kFaces; ++j) {
      away_x[j] = screen.away_x[j][lane];
      away_y[j] = screen.away_y[j][lane];
      near_from[j] = screen.near_from[j][lane];
      far_from[j] = kFaces > 1 ? screen.far_from[j][lane] : kInfinity;
    }
    const double weight = screen.weight[lane];
    const std::int32_t end_block = (end + kLanes - 1) / kLanes;
    for (std::int32_t b = first / kLanes; b < end_block; ++b) {
      TargetBlock& __restrict block = targets[b];
#pragma GCC unroll 1
      for (int i = 0; i < kLanes; ++i) {
        const bool is_covered = (block.direction[i] >= from) & (block.direction[i] < to);
        bool is_beyond_near = is_covered;
        bool is_before_far = true;
#pragma GCC unroll 4
        for (int j = 0; j < kFaces; ++j) {
          double away = 0.0;
          if constexpr (kIsBox) {
            away = j % 2 == 0 ? away_x[j] * block.x[i] : away_y[j] * block.y[i];
          } else {
            away = away_x[j] * block.x[i] + away_y[j] * block.y[i];
          }
          is_beyond_near &= away >= near_from[j];
          if constexpr (kFaces > 1) is_before_far &= away < far_from[j];
        }
        double crossed = is_beyond_near ? weight : 0.0;
        if constexpr (kFaces > 1) crossed += (is_covered & !is_before_far) ? weight : 0.0;
        block.weight[i] += crossed;
      }
    }
  }

  template <bool kAreBoxes, int kFaces>
  static ROBOTTEAMSIM_INLINE bool AddScreens(const LinkSource& source, ScreenBlock<kFaces>* screens, int num_blocks,
                                             std::int32_t* __restrict seen, TargetBlock* targets) {
    std::int32_t num_seen = 0, num_left_out = 0;
    for (int b = 0; b < num_blocks; ++b) {
      LookAtBlock(source, &screens[b]);
      for (int i = 0; i < kLanes; ++i) {
        seen[num_seen] = b * kLanes + i;  // kept if counted
        num_seen += screens[b].is_seen[i];
        num_left_out += screens[b].left_out[i] > 0.0 ? 1 : 0;
      }
    }
    for (std::int32_t k = 0; k < num_seen; ++k) {
      const ScreenBlock<kFaces>& screen = screens[seen[k] / kLanes];
      const int i = seen[k] % kLanes;
      if (screen.from[i] < screen.to[i]) {
        Shade<kAreBoxes>(screen, i, screen.from[i], screen.to[i], screen.first[i], screen.end[i], targets);
      } else {  // wraps around at straight down: two parts
        Shade<kAreBoxes>(screen, i, screen.from[i], kAfterAll, screen.first[i], source.num_targets, targets);
        Shade<kAreBoxes>(screen, i, kBeforeAll, screen.to[i], 0, screen.end[i], targets);
      }
    }
    return num_left_out > 0;
  }
};

// A function can be inlined only into one whose target has all of its instructions.
#define ROBOTTEAMSIM_KERNELS(Target, attributes)                                                                      \
  struct Target {                                                                                                     \
    attributes static void Find(const LinkSource& source, const double* x, const double* y, double* directions,       \
                                std::int32_t* bins) {                                                                 \
      Loops::FindDirections(source, x, y, directions, bins);                                                          \
    }                                                                                                                 \
    attributes static void Fill(const LinkSource& source, const double* x, const double* y, const double* directions, \
                                const std::int32_t* order, TargetBlock* blocks) {                                     \
      Loops::FillBlocks(source, x, y, directions, order, blocks);                                                     \
    }                                                                                                                 \
    attributes static bool AddFaces(const LinkSource& source, ScreenBlock<1>* screens, int num_blocks,                \
                                    std::int32_t* scratch, TargetBlock* targets) {                                    \
      return Loops::AddScreens<false>(source, screens, num_blocks, scratch, targets);                                 \
    }                                                                                                                 \
    attributes static bool AddRings(const LinkSource& source, ScreenBlock<4>* screens, int num_blocks,                \
                                    std::int32_t* scratch, TargetBlock* targets) {                                    \
      return Loops::AddScreens<false>(source, screens, num_blocks, scratch, targets);                                 \
    }                                                                                                                 \
    attributes static bool AddBoxes(const LinkSource& source, ScreenBlock<4>* screens, int num_blocks,                \
                                    std::int32_t* scratch, TargetBlock* targets) {                                    \
      return Loops::AddScreens<true>(source, screens, num_blocks, scratch, targets);                                  \
    }                                                                                                                 \
    static constexpr LinkKernels kKernels{Find, Fill, AddFaces, AddRings, AddBoxes};                                  \
  };

ROBOTTEAMSIM_FOR_EACH_SIMD(ROBOTTEAMSIM_KERNELS)

}  // namespace

const LinkKernels& LinkKernelsFor(base::Simd simd) {
  return *base::SimdVersion(simd, &Portable::kKernels, &Avx2::kKernels, &Avx512::kKernels);
}

}  // namespace robotteamsim::propagation

#include "robotteamsim/propagation/link_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace robotteamsim {
namespace {

constexpr int kLanes = TargetBlock::kLanes;

/// Of a target at the source, which nothing shades, and of no target.
constexpr double kNoDirection = 4.5;
constexpr double kNoTarget = 9.0;

/// Less than the least difference of two directions.
constexpr double kLittle = 0x1p-50;

/// The targets behind a face: in directions from `from` to before `to`, and beyond its line.
struct Shadow {
  double from, to, normal_x, normal_y, beyond, weight;
};

struct Loops {
  static ROBOTTEAMSIM_INLINE void FindDirections(const LinkSource& source, const double* __restrict x,
                                                 const double* __restrict y, int count, double* __restrict directions,
                                                 std::int32_t* __restrict bins) {
    const double source_x = source.x;
    const double source_y = source.y;
    const double bins_per_quarter = source.num_bins / 4.0;
    const int last_bin = source.num_bins - 1;
    for (int i = 0; i < count; ++i) {
      const double dx = x[i] - source_x;
      const double dy = y[i] - source_y;
      const double length = std::abs(dx) + std::abs(dy);
      const double along_y = dy / std::max(length, 1.0);
      const double direction = (dx < 0.0 ? 2.0 - along_y : along_y) + 1.0;
      directions[i] = length > 0.0 ? direction : kNoDirection;
      bins[i] = std::min(static_cast<std::int32_t>(directions[i] * bins_per_quarter), last_bin);
    }
  }

  static ROBOTTEAMSIM_INLINE void FillBlocks(const LinkSource& source, const double* __restrict x,
                                             const double* __restrict y, const double* __restrict directions,
                                             const std::int32_t* __restrict order, int count,
                                             TargetBlock* __restrict blocks) {
    const double source_x = source.x;
    const double source_y = source.y;
    const int whole = count / kLanes;
    for (int b = 0; b < whole; ++b) {
      const std::int32_t* const targets = order + b * kLanes;
      TargetBlock& block = blocks[b];
      for (int i = 0; i < kLanes; ++i) block.x[i] = x[targets[i]] - source_x;
      for (int i = 0; i < kLanes; ++i) block.y[i] = y[targets[i]] - source_y;
      for (int i = 0; i < kLanes; ++i) block.direction[i] = directions[targets[i]];
      for (int i = 0; i < kLanes; ++i) block.weight[i] = 0.0;
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

  /// A target on the ray through a corner: in the upper half (and against x) the corner, moved by (eps, eps^2), is
  /// right of the ray, in the lower half (and along x) left of it.
  static ROBOTTEAMSIM_INLINE void FindRuns(const LinkSource& source, const std::int32_t* __restrict bins, int count,
                                           double* __restrict directions, std::int32_t* __restrict first_run,
                                           std::int32_t* __restrict end_run) {
    const std::int32_t* __restrict const bin_start = source.bin_start;
    for (int i = 0; i < count; ++i) {
      const double direction = directions[i];
      directions[i] = ((direction <= 1.0) | (direction > 3.0)) ? direction + kLittle : direction;
      first_run[i] = bin_start[bins[i]];
      end_run[i] = bin_start[bins[i] + 1];
    }
  }

  static ROBOTTEAMSIM_INLINE void LookAtFaces(const LinkSource& source, LinkFaces* faces) {
    const double source_x = source.x;
    const double source_y = source.y;
    const double* __restrict const start_x = faces->start_x.data();
    const double* __restrict const start_y = faces->start_y.data();
    const double* __restrict const along_x = faces->along_x.data();
    const double* __restrict const along_y = faces->along_y.data();
    const double* __restrict const tie_is_left = faces->tie_is_left.data();
    const std::int32_t* __restrict const start = faces->start.data();
    const std::int32_t* __restrict const end = faces->end.data();
    double* __restrict const side = faces->side.data();
    double* __restrict const normal_x = faces->normal_x.data();
    double* __restrict const normal_y = faces->normal_y.data();
    double* __restrict const beyond = faces->beyond.data();
    std::int32_t* __restrict const right = faces->right.data();
    std::int32_t* __restrict const left = faces->left.data();
    const auto count = static_cast<int>(faces->weight.size());
    for (int i = 0; i < count; ++i) {
      const double s = along_y[i] * (start_x[i] - source_x) - along_x[i] * (start_y[i] - source_y);
      const double sign = s > 0.0 ? 1.0 : -1.0;
      const double if_left = tie_is_left[i], if_right = 1.0 - if_left;
      side[i] = s;
      normal_x[i] = sign * along_y[i];
      normal_y[i] = -sign * along_x[i];
      beyond[i] = sign * s + (s > 0.0 ? if_left : if_right);
    }
    for (int i = 0; i < count; ++i) {
      const std::int32_t first = start[i], last = end[i];
      right[i] = side[i] > 0.0 ? first : last;
      left[i] = side[i] > 0.0 ? last : first;
    }
  }

  /// Lists the faces between whose ends there are targets, or that may be around straight down.
  static ROBOTTEAMSIM_INLINE int FindSeen(const LinkCorners& corners, LinkFaces* faces) {
    const std::int32_t* __restrict const first_run = corners.first_run.data();
    const std::int32_t* __restrict const end_run = corners.end_run.data();
    const std::int32_t* __restrict const bin = corners.bin.data();
    const std::int32_t* __restrict const right = faces->right.data();
    const std::int32_t* __restrict const left = faces->left.data();
    std::int32_t* __restrict const seen = faces->seen.data();
    const auto count = static_cast<int>(faces->weight.size());
    int num_seen = 0;
    for (int i = 0; i < count; ++i) {
      seen[num_seen] = i;  // stays if counted
      num_seen += (first_run[right[i]] < end_run[left[i]]) | (bin[right[i]] > bin[left[i]]);
    }
    return num_seen;
  }

  static ROBOTTEAMSIM_INLINE void Shade(const Shadow& shadow, std::int32_t first, std::int32_t end,
                                        TargetBlock* blocks) {
    const Shadow s = shadow;
    const std::int32_t end_block = (end + kLanes - 1) / kLanes;
    for (std::int32_t b = first / kLanes; b < end_block; ++b) {
      TargetBlock& __restrict block = blocks[b];
#pragma GCC unroll 1  // unrolled at once, the lanes would be computed one by one
      for (int i = 0; i < kLanes; ++i) {
        const bool is_behind = (block.direction[i] >= s.from) & (block.direction[i] < s.to) &
                               (s.normal_x * block.x[i] + s.normal_y * block.y[i] >= s.beyond);
        block.weight[i] += is_behind ? s.weight : 0.0;
      }
    }
  }

  static ROBOTTEAMSIM_INLINE void AddWeights(const LinkSource& source, LinkCorners* corners, LinkFaces* faces,
                                             int count, TargetBlock* blocks) {
    const auto num_corners = static_cast<int>(corners->x.size());
    FindDirections(source, corners->x.data(), corners->y.data(), num_corners, corners->direction.data(),
                   corners->bin.data());
    FindRuns(source, corners->bin.data(), num_corners, corners->direction.data(), corners->first_run.data(),
             corners->end_run.data());
    LookAtFaces(source, faces);
    const int num_seen = FindSeen(*corners, faces);
    for (int k = 0; k < num_seen; ++k) {
      const std::int32_t i = faces->seen[k];
      if (faces->side[i] == 0.0) continue;
      const std::int32_t right = faces->right[i];
      const std::int32_t left = faces->left[i];
      Shadow shadow{corners->direction[right], corners->direction[left], faces->normal_x[i],
                    faces->normal_y[i],        faces->beyond[i],         faces->weight[i]};
      if (shadow.from < shadow.to) {
        Shade(shadow, corners->first_run[right], corners->end_run[left], blocks);
        continue;
      }
      const double to = shadow.to;  // beyond straight down: in two parts
      shadow.to = 5.0;
      Shade(shadow, corners->first_run[right], count, blocks);
      shadow.from = -1.0;
      shadow.to = to;
      Shade(shadow, 0, corners->end_run[left], blocks);
    }
  }
};

// A function inlines into one of a target that has all of its own target's instructions.
#define ROBOTTEAMSIM_KERNELS(Target, attributes)                                                                      \
  struct Target {                                                                                                     \
    attributes static void Find(const LinkSource& source, const double* x, const double* y, int count,                \
                                double* directions, std::int32_t* bins) {                                             \
      Loops::FindDirections(source, x, y, count, directions, bins);                                                   \
    }                                                                                                                 \
    attributes static void Fill(const LinkSource& source, const double* x, const double* y, const double* directions, \
                                const std::int32_t* order, int count, TargetBlock* blocks) {                          \
      Loops::FillBlocks(source, x, y, directions, order, count, blocks);                                              \
    }                                                                                                                 \
    attributes static void Add(const LinkSource& source, LinkCorners* corners, LinkFaces* faces, int count,           \
                               TargetBlock* blocks) {                                                                 \
      Loops::AddWeights(source, corners, faces, count, blocks);                                                       \
    }                                                                                                                 \
    static constexpr LinkKernels kKernels{Find, Fill, Add};                                                           \
  };

ROBOTTEAMSIM_KERNELS(Portable, )
#if ROBOTTEAMSIM_HAS_X86_TARGETS
ROBOTTEAMSIM_KERNELS(Avx2, ROBOTTEAMSIM_AVX2)
ROBOTTEAMSIM_KERNELS(Avx512, ROBOTTEAMSIM_AVX512)
#endif

}  // namespace

const LinkKernels& LinkKernelsFor(Simd simd) {
  if (!IsSupported(simd)) throw std::invalid_argument("this machine does not have the instruction set asked for");
#if ROBOTTEAMSIM_HAS_X86_TARGETS
  if (simd == Simd::kAvx512) return Avx512::kKernels;
  if (simd == Simd::kAvx2) return Avx2::kKernels;
#endif
  return Portable::kKernels;
}

}  // namespace robotteamsim

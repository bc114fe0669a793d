#include "robotteamsim/hazards/air.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/base/simd.hpp"

namespace robotteamsim::hazards {
namespace {

constexpr double kStefanBoltzmann = 5.670374419e-11;  // [kW/(m^2 K^4)]
constexpr double kLargestShare = 0.2;    // of the difference between two cells that flows in one pass; 1/4 is the limit
constexpr double kLongestCooling = 1.0;  // [s]
constexpr float kNothing = 1e-9F;        // [K]
constexpr double kSmallest = 1e-3;
constexpr double kHottest = 1e4;  // [K]
constexpr int kMostPasses = 1'000'000;

AirModel Checked(const AirModel& model) {
  base::CheckPositive(model.cell, "cell");
  base::CheckPositive(model.diffusivity, "diffusivity");
  base::CheckPositive(model.ambient, "ambient");
  base::CheckPositive(model.heat_capacity, "heat_capacity");
  base::CheckNotNegative(model.convection, "convection");
  base::CheckNotNegative(model.emissivity, "emissivity");
  // Temperatures have single precision and must stay finite.
  if (model.cell < kSmallest || model.heat_capacity < kSmallest || model.ambient > kHottest) {
    throw std::invalid_argument("cell and heat_capacity must be at least 0.001, ambient at most 10000");
  }
  return model;
}

/// What flows into a cell from its four neighbours: each flow leaves one cell and enters the next, so the sum over all
/// cells is conserved.
template <typename Value>
ROBOTTEAMSIM_INLINE Value Inflow(Value east, Value west, Value north, Value south, int stride, const Value* here) {
  const Value along = east * (here[1] - here[0]) - west * (here[0] - here[-1]);
  const Value across = north * (here[stride] - here[0]) - south * (here[0] - here[-stride]);
  return along + across;
}

/// One row of soot and heat, which share the links.
ROBOTTEAMSIM_INLINE void SpreadOneRow(const float* __restrict east, const float* __restrict north, int stride, int cols,
                                      double share, const double* __restrict soot, double* __restrict soot_after,
                                      const float* __restrict heat, float* __restrict heat_after) {
  const auto heat_share = static_cast<float>(share);
  for (int i = 1; i <= cols; ++i) {
    const float e = east[i], w = east[i - 1], n = north[i], s = north[i - stride];
    soot_after[i] = soot[i] + share * Inflow<double>(e, w, n, s, stride, soot + i);
    heat_after[i] = heat[i] + heat_share * Inflow<float>(e, w, n, s, stride, heat + i);
  }
}

/// Newton's law of cooling with a rate that grows with the temperature; stable for any duration.
ROBOTTEAMSIM_INLINE void CoolCells(float convection, float radiation, float ambient, int count, float* __restrict x) {
  const float linear = 6.0F * ambient * ambient, constant = 4.0F * ambient * ambient * ambient;
  for (int i = 0; i < count; ++i) {
    // ((ambient + x)^4 - ambient^4) / x
    const float fourth = ((x[i] + 4.0F * ambient) * x[i] + linear) * x[i] + constant;
    const float cooled = x[i] / (1.0F + convection + radiation * fourth);
    // Far from a fire, excess temperatures would become subnormal numbers, with which processors are slow.
    x[i] = cooled < kNothing ? 0.0F : cooled;
  }
}

/// The loops for one instruction set.
struct Loops {
  void (*spread)(const float* east, const float* north, int stride, int cols, double share, const double* soot,
                 double* soot_after, const float* heat, float* heat_after);
  void (*cool)(float convection, float radiation, float ambient, int count, float* x);
};

#define ROBOTTEAMSIM_AIR_LOOPS(Name, attributes)                                                               \
  attributes void Name##Spread(const float* east, const float* north, int stride, int cols, double share,      \
                               const double* soot, double* soot_after, const float* heat, float* heat_after) { \
    SpreadOneRow(east, north, stride, cols, share, soot, soot_after, heat, heat_after);                        \
  }                                                                                                            \
  attributes void Name##Cool(float convection, float radiation, float ambient, int count, float* x) {          \
    CoolCells(convection, radiation, ambient, count, x);                                                       \
  }                                                                                                            \
  constexpr Loops k##Name##Loops = {Name##Spread, Name##Cool};
ROBOTTEAMSIM_FOR_EACH_SIMD(ROBOTTEAMSIM_AIR_LOOPS)

const Loops& BestLoops() {
  static const Loops* const loops = base::SimdVersion(base::BestSimd(), &kPortableLoops, &kAvx2Loops, &kAvx2Loops);
  return *loops;
}

}  // namespace

Air::Air(const AirModel& model, const Links& links)
    : model_(Checked(model)),
      rows_(links.rows()),
      soot_(links.PaddedSize(), 0.0),
      excess_(links.PaddedSize(), 0.0F),
      soot_after_(links.PaddedSize(), 0.0),
      excess_after_(links.PaddedSize(), 0.0F),
      first_(links.rows() + 1),
      last_(0) {}

void Air::Add(int padded, double soot, double heat) {
  const int row = padded / (static_cast<int>(soot_.size()) / (rows_ + 2));
  first_ = std::min(first_, row);
  last_ = std::max(last_, row);
  soot_.at(padded) += soot;
  excess_.at(padded) += static_cast<float>(heat / model_.heat_capacity);
}

void Air::Advance(const Links& links, double seconds) {
  base::CheckPositive(seconds, "seconds");
  if (first_ > last_) return;
  const double total = model_.diffusivity * seconds / (model_.cell * model_.cell);
  const double passes = std::max(1.0, std::ceil(total / kLargestShare));
  if (!(passes <= kMostPasses)) throw std::invalid_argument("seconds are too many for cells of this size");
  Spread(links, total / passes, static_cast<int>(passes));
  const int coolings = std::max(1, static_cast<int>(std::min(std::ceil(seconds / kLongestCooling), 1e6)));
  for (int i = 0; i < coolings; ++i) Cool(links.stride(), seconds / coolings);
}

void Air::Spread(const Links& links, double share, int passes) {
  const Loops& loops = BestLoops();
  first_ = std::max(1, first_ - passes);
  last_ = std::min(rows_, last_ + passes);
  const int stride = links.stride();
  // Each pass is one row behind the one before it, so that rows are still in the cache. A pass overwrites a row that
  // the pass before it has read for the last time.
  for (int front = first_; front < last_ + passes; ++front) {
    for (int pass = std::max(0, front - last_); pass < passes && front - pass >= first_; ++pass) {
      const int begin = (front - pass) * stride;
      const bool is_even = pass % 2 == 0;
      std::vector<double>&soot = is_even ? soot_ : soot_after_, &soot_after = is_even ? soot_after_ : soot_;
      std::vector<float>&excess = is_even ? excess_ : excess_after_, &excess_after = is_even ? excess_after_ : excess_;
      loops.spread(links.east().data() + begin, links.north().data() + begin, stride, links.cols(), share,
                   soot.data() + begin, soot_after.data() + begin, excess.data() + begin, excess_after.data() + begin);
    }
  }
  if (passes % 2 == 0) return;
  soot_.swap(soot_after_);
  excess_.swap(excess_after_);
}

void Air::Cool(int stride, double seconds) {
  // To the floor and to the ceiling.
  const double rate = 2.0 * seconds / model_.heat_capacity;
  BestLoops().cool(static_cast<float>(rate * model_.convection),
                   static_cast<float>(rate * model_.emissivity * kStefanBoltzmann), static_cast<float>(model_.ambient),
                   (last_ - first_ + 1) * stride, excess_.data() + first_ * stride);
}

}  // namespace robotteamsim::hazards

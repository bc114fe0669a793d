#include "robotteamsim/hazards/air.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::hazards {
namespace {

constexpr double kStefanBoltzmann = 5.670374419e-11;  // [kW/(m^2 K^4)]
constexpr double kLargestShare = 2.0 / 3.0;           // of what a cell has that flows out in a pass; 1 is the limit
constexpr double kLongestCooling = 1.0;               // [s]
constexpr float kNothing = 1e-9F;                     // [K]
constexpr double kSmallest = 1e-3;
constexpr double kHottest = 1e4;      // [K]
constexpr double kGravity = 9.80665;  // [m/s^2]
// Radiation multiplies three temperatures, and a density divides soot by a height: both fit in single precision.
constexpr float kMostExcess = 1e12F;  // [K]
constexpr double kMostSoot = 1e28;    // [g/m^2]
constexpr int kMostPasses = 1'000'000;

AirModel Checked(const AirModel& model) {
  base::CheckPositive(model.cell_m, "cell");
  base::CheckPositive(model.diffusivity_m2_s, "diffusivity_m2_s");
  base::CheckPositive(model.ambient_k, "ambient");
  base::CheckPositive(model.heat_capacity_kj_m2_k, "heat_capacity_kj_m2_k");
  base::CheckNotNegative(model.convection_kw_m2_k, "convection");
  base::CheckNotNegative(model.emissivity, "emissivity");
  base::CheckPositive(model.height_m, "height_m");
  // Temperatures have single precision and must stay finite.
  if (model.cell_m < kSmallest || model.heat_capacity_kj_m2_k < kSmallest || model.ambient_k > kHottest) {
    throw std::invalid_argument("cell_m and heat_capacity_kj_m2_k must be at least 0.001, ambient_k at most 10000");
  }
  return model;
}

/// One row of soot and heat, which share the links, after exchange with the cells to the east and to the west. Each
/// flow leaves one cell and enters the next, so the sum over all cells is conserved.
void SpreadAlongRow(const float* __restrict east, int cols, double share, const double* __restrict soot,
                    double* __restrict soot_after, const float* __restrict heat, float* __restrict heat_after) {
  const auto heat_share = static_cast<float>(share);
  for (int i = 1; i <= cols; ++i) {
    const float e = east[i], w = east[i - 1];
    soot_after[i] = soot[i] + share * (e * (soot[i + 1] - soot[i]) - w * (soot[i] - soot[i - 1]));
    heat_after[i] = heat[i] + heat_share * (e * (heat[i + 1] - heat[i]) - w * (heat[i] - heat[i - 1]));
  }
}

/// The same with the rows to the north and to the south. `from_south` is what flows in from the southern row, and
/// becomes what flows from this row to the next.
void SpreadAcrossRow(const float* __restrict north, int stride, int cols, double share, const double* __restrict soot,
                     double* __restrict soot_after, double* __restrict soot_from_south, const float* __restrict heat,
                     float* __restrict heat_after, float* __restrict heat_from_south) {
  const auto heat_share = static_cast<float>(share);
  for (int i = 1; i <= cols; ++i) {
    const double soot_flow = north[i] * (soot[i + stride] - soot[i]);
    const float heat_flow = north[i] * (heat[i + stride] - heat[i]);
    soot_after[i] = soot[i] + share * (soot_flow - soot_from_south[i]);
    heat_after[i] = heat[i] + heat_share * (heat_flow - heat_from_south[i]);
    soot_from_south[i] = soot_flow;
    heat_from_south[i] = heat_flow;
  }
}

/// Newton's law of cooling with a rate that grows with the temperature; stable for any duration.
void CoolCells(float convection, float radiation, float ambient, int count, float* __restrict x) {
  const float linear = 6.0F * ambient * ambient, constant = 4.0F * ambient * ambient * ambient;
  for (int i = 0; i < count; ++i) {
    // ((ambient + x)^4 - ambient^4) / x
    const float fourth = ((x[i] + 4.0F * ambient) * x[i] + linear) * x[i] + constant;
    const float cooled = x[i] / (1.0F + convection + radiation * fourth);
    // Far from a fire, excess temperatures would become subnormal numbers, with which processors are slow.
    x[i] = cooled < kNothing ? 0.0F : cooled;
  }
}

/// Returns openings whose cells are those of arrays with a border.
std::vector<OpeningCell> WithBorder(std::vector<OpeningCell> openings, const Links& links) {
  const int cells = links.rows() * links.cols();
  for (OpeningCell& opening : openings) {
    base::CheckPositive(opening.share, "the share of an opening");
    base::CheckPositive(opening.area_m2, "the area of an opening");
    base::CheckPositive(opening.rise_m, "the rise of an opening");
    const auto is_cell = [&](int cell) { return cell >= 0 && cell < cells; };
    if (!is_cell(opening.above) || !is_cell(opening.below) || opening.above == opening.below) {
      throw std::invalid_argument("an opening must be between two cells of the grid");
    }
    opening.above = links.Padded(opening.above);
    opening.below = links.Padded(opening.below);
  }
  return openings;
}

/// Returns how much air a square metre of an opening lets up, and as much down, by buoyancy [m/s]: Cooper's exchange
/// flow without a difference of pressure, as in CFAST 7 (ventcf in flowvertical.f90). Of ideal gases at one pressure,
/// the difference of the densities over their mean is that of the temperatures.
double BuoyantExchange(double area_m2, double above_k, double below_k) {
  if (below_k <= above_k) return 0.0;
  return 0.1 * std::sqrt(std::sqrt(area_m2)) * std::sqrt(2.0 * kGravity * (below_k - above_k) / (below_k + above_k));
}

}  // namespace

Air::Air(const AirModel& model, const Links& links, std::vector<OpeningCell> openings)
    : model_(Checked(model)),
      openings_(WithBorder(std::move(openings), links)),
      rows_(links.rows()),
      soot_(links.PaddedSize(), 0.0),
      excess_(links.PaddedSize(), 0.0F),
      soot_after_(links.PaddedSize(), 0.0),
      excess_after_(links.PaddedSize(), 0.0F),
      soot_from_south_(links.stride()),
      excess_from_south_(links.stride()),
      first_(links.rows() + 1),
      last_(0) {}

void Air::Add(int padded, double soot_g_m2, double heat_kj_m2) {
  const int row = padded / (static_cast<int>(soot_.size()) / (rows_ + 2));
  first_ = std::min(first_, row);
  last_ = std::max(last_, row);
  soot_.at(padded) += soot_g_m2;
  excess_.at(padded) += static_cast<float>(heat_kj_m2 / model_.heat_capacity_kj_m2_k);
  if (!(excess_[padded] <= kMostExcess && soot_[padded] <= kMostSoot)) {
    throw std::invalid_argument("more than 1e12 K or 1e28 g/m^2 of soot in a cell: it is too small for its fire");
  }
}

void Air::Advance(const Links& links, double seconds) {
  base::CheckPositive(seconds, "seconds");
  if (first_ > last_) return;
  const double total = model_.diffusivity_m2_s * seconds / (model_.cell_m * model_.cell_m);
  const double passes = std::max(1.0, std::ceil(total * links.LargestPair() / kLargestShare));
  if (!(passes <= kMostPasses)) throw std::invalid_argument("seconds are too many for cells of this size");
  Spread(links, total / passes, static_cast<int>(passes));
  const int coolings = std::max(1, static_cast<int>(std::min(std::ceil(seconds / kLongestCooling), 1e6)));
  for (int i = 0; i < coolings; ++i) {
    Exchange(links.stride(), seconds / coolings);
    Cool(links.stride(), seconds / coolings);
  }
}

void Air::Spread(const Links& links, double share, int passes) {
  first_ = std::max(1, first_ - passes);
  last_ = std::min(rows_, last_ + passes);
  const int stride = links.stride();
  for (int pass = 0; pass < passes; ++pass) {
    // Nothing flows into the first row and out of the last: beyond them is the border, or a row that is not reached.
    std::fill(soot_from_south_.begin(), soot_from_south_.end(), 0.0);
    std::fill(excess_from_south_.begin(), excess_from_south_.end(), 0.0F);
    for (int row = first_; row <= last_ + 1; ++row) {
      const int here = row * stride, south = here - stride;
      if (row <= last_) {
        SpreadAlongRow(links.east().data() + here, links.cols(), share, soot_.data() + here, soot_after_.data() + here,
                       excess_.data() + here, excess_after_.data() + here);
      }
      if (row == first_) continue;
      // One row behind, so that rows are still in the cache.
      SpreadAcrossRow(links.north().data() + south, stride, links.cols(), share, soot_after_.data() + south,
                      soot_.data() + south, soot_from_south_.data(), excess_after_.data() + south,
                      excess_.data() + south, excess_from_south_.data());
    }
  }
}

void Air::Exchange(int stride, double seconds) {
  for (const OpeningCell& opening : openings_) {
    const int row_above = opening.above / stride, row_below = opening.below / stride;
    const auto is_reached = [&](int row) { return first_ <= row && row <= last_; };
    if (!is_reached(row_above) && !is_reached(row_below)) continue;
    first_ = std::min({first_, row_above, row_below});
    last_ = std::max({last_, row_above, row_below});
    const double above_k = model_.ambient_k + excess_[opening.above],
                 below_k = model_.ambient_k + excess_[opening.below];
    const double flow_mps =
        model_.diffusivity_m2_s / opening.rise_m + BuoyantExchange(opening.area_m2, above_k, below_k);
    // The difference of the two cells decays exponentially: stable for any duration.
    const double moved = -0.5 * std::expm1(-2.0 * opening.share * flow_mps * seconds / model_.height_m);
    const double soot = moved * (soot_[opening.below] - soot_[opening.above]);
    soot_[opening.above] += soot;
    soot_[opening.below] -= soot;
    const auto excess = static_cast<float>(moved * (below_k - above_k));
    excess_[opening.above] += excess;
    excess_[opening.below] -= excess;
  }
}

void Air::Cool(int stride, double seconds) {
  // To the floor and to the ceiling.
  const double rate = 2.0 * seconds / model_.heat_capacity_kj_m2_k;
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(first_) * stride;
  CoolCells(static_cast<float>(rate * model_.convection_kw_m2_k),
            static_cast<float>(rate * model_.emissivity * kStefanBoltzmann), static_cast<float>(model_.ambient_k),
            (last_ - first_ + 1) * stride, excess_.data() + first);
}

}  // namespace robotteamsim::hazards

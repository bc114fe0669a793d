#include "robotteamsim/world/sorted_beams.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace robotteamsim::world {
namespace {

constexpr double kHalfTurn = 3.14159265358979323846;  // rad

}  // namespace

double PseudoAngle(double x, double y) {
  const double sum = std::abs(x) + std::abs(y);
  if (sum == 0.0) return 0.0;
  const double along = x / sum;
  return y >= 0.0 ? 1.0 - along : 3.0 + along;
}

SortedBeams::SortedBeams(int beams, double angle_min_rad, double angle_max_rad)
    : zero_(std::min(angle_min_rad, angle_max_rad)), is_half_(std::abs(angle_max_rad - angle_min_rad) <= kHalfTurn) {
  const double increment = beams > 1 ? (angle_max_rad - angle_min_rad) / (beams - 1) : 0.0;
  std::vector<double> x(beams), y(beams), pseudo_angle(beams);
  for (int beam = 0; beam < beams; ++beam) {
    const double angle = angle_min_rad + beam * increment - zero_;
    x[beam] = std::cos(angle);
    y[beam] = std::sin(angle);
    pseudo_angle[beam] = PseudoAngle(x[beam], y[beam]);
  }
  std::vector<int> order(beams);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return pseudo_angle[a] < pseudo_angle[b]; });
  place_.resize(beams);
  for (int place = 0; place < beams; ++place) {
    place_[order[place]] = place;
    is_in_order_ = is_in_order_ && order[place] == place;
    x_.push_back(x[order[place]]);
    y_.push_back(y[order[place]]);
    pseudo_angle_.push_back(pseudo_angle[order[place]]);
  }
  const int num_bins = 8 * beams;
  bins_per_unit_ = num_bins / 4.0;
  int place = 0;
  for (int bin = 0; bin <= num_bins; ++bin) {
    while (place < beams && pseudo_angle_[place] < bin / bins_per_unit_) ++place;
    first_in_bin_.push_back(place);
  }
}

int SortedBeams::FirstFrom(double pseudo_angle) const {
  const double bin = std::clamp(pseudo_angle * bins_per_unit_, 0.0, static_cast<double>(first_in_bin_.size() - 1));
  int place = first_in_bin_[static_cast<std::size_t>(bin)];
  while (place < Count() && pseudo_angle_[place] < pseudo_angle) ++place;
  return place;
}

}  // namespace robotteamsim::world

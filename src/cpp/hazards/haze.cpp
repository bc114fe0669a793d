#include "robotteamsim/hazards/haze.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::hazards {

Haze::Haze(const plan::GridShape& shape, std::vector<float> soot_g_m3, double extinction_m2_g, double limit)
    : shape_(shape), soot_g_m3_(std::move(soot_g_m3)), extinction_m2_g_(extinction_m2_g), limit_(limit) {
  base::Check(shape.origin, "origin");
  base::CheckPositive(shape.resolution_m, "resolution_m");
  base::CheckPositive(extinction_m2_g, "extinction");
  base::CheckPositive(limit, "limit");
  if (shape.rows < 1 || shape.cols < 1 || soot_g_m3_.size() != static_cast<std::size_t>(shape.rows) * shape.cols) {
    throw std::invalid_argument("each cell must have its soot");
  }
  bool is_usable = true;
  for (const float value : soot_g_m3_) {
    is_usable &= value >= 0.0F && value <= static_cast<float>(base::kLargest);
    densest_g_m3_ = value > densest_g_m3_ ? value : densest_g_m3_;
  }
  if (!is_usable) throw std::invalid_argument("soot must be finite and >= 0");
}

bool Haze::IsClearAround(const base::Point& point, double length_m) const {
  if (extinction_m2_g_ * densest_g_m3_ * length_m < limit_) return true;
  const auto index = [this](double offset, int count) {
    return base::ClampedInt(std::floor(offset / shape_.resolution_m), 0, count - 1);
  };
  const int first_row = index(point.y - length_m - shape_.origin.y, shape_.rows);
  const int last_row = index(point.y + length_m - shape_.origin.y, shape_.rows);
  const int first_col = index(point.x - length_m - shape_.origin.x, shape_.cols);
  const int last_col = index(point.x + length_m - shape_.origin.x, shape_.cols);
  float densest = 0.0F;
  for (int row = first_row; row <= last_row; ++row) {
    const float* const cells = soot_g_m3_.data() + static_cast<std::size_t>(row) * shape_.cols;
    for (int col = first_col; col <= last_col; ++col) densest = std::max(densest, cells[col]);
  }
  return extinction_m2_g_ * densest * length_m < limit_;
}

double Haze::Sight(const base::Point& point, const base::Point& direction, double length_m) const {
  // Steps of at most a cell, each with the extinction at its middle.
  const double step = shape_.resolution_m;
  double depth = 0.0, begin = 0.0;
  while (begin < length_m) {
    const double part = std::min(step, length_m - begin), middle = begin + 0.5 * part;
    const double x = (point.x + direction.x * middle - shape_.origin.x) / shape_.resolution_m;
    const double y = (point.y + direction.y * middle - shape_.origin.y) / shape_.resolution_m;
    // Beyond the cells the air is clear; a line does not come back.
    if (!(x >= 0.0 && x < shape_.cols && y >= 0.0 && y < shape_.rows)) return length_m;
    const std::size_t cell = static_cast<std::size_t>(y) * shape_.cols + static_cast<std::size_t>(x);
    const double extinction = extinction_m2_g_ * soot_g_m3_[cell];
    if (depth + extinction * part >= limit_) return begin + (limit_ - depth) / extinction;
    depth += extinction * part;
    begin += step;
  }
  return length_m;
}

}  // namespace robotteamsim::hazards

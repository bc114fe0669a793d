#include "robotteamsim/hazards/haze.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::hazards {

Haze::Haze(const plan::GridShape& shape, std::vector<float> soot, double extinction, double limit)
    : shape_(shape), soot_(std::move(soot)), extinction_(extinction), limit_(limit) {
  base::Check(shape.origin, "origin");
  base::CheckPositive(shape.resolution, "resolution");
  base::CheckPositive(extinction, "extinction");
  base::CheckPositive(limit, "limit");
  if (shape.rows < 1 || shape.cols < 1 || soot_.size() != static_cast<std::size_t>(shape.rows) * shape.cols) {
    throw std::invalid_argument("each cell must have its soot");
  }
  bool is_usable = true;
  for (const float value : soot_) {
    is_usable &= value >= 0.0F && value <= static_cast<float>(base::kLargest);
    densest_ = value > densest_ ? value : densest_;
  }
  if (!is_usable) throw std::invalid_argument("soot must be finite and >= 0");
}

bool Haze::IsClearAround(const base::Point& point, double length) const {
  if (extinction_ * densest_ * length < limit_) return true;
  const auto index = [this](double offset, int count) {
    return base::ClampedInt(std::floor(offset / shape_.resolution), 0, count - 1);
  };
  const int first_row = index(point.y - length - shape_.origin.y, shape_.rows);
  const int last_row = index(point.y + length - shape_.origin.y, shape_.rows);
  const int first_col = index(point.x - length - shape_.origin.x, shape_.cols);
  const int last_col = index(point.x + length - shape_.origin.x, shape_.cols);
  float densest = 0.0F;
  for (int row = first_row; row <= last_row; ++row) {
    const float* const cells = soot_.data() + static_cast<std::size_t>(row) * shape_.cols;
    for (int col = first_col; col <= last_col; ++col) densest = std::max(densest, cells[col]);
  }
  return extinction_ * densest * length < limit_;
}

double Haze::Sight(const base::Point& point, const base::Point& direction, double length) const {
  // Steps of at most a cell, each with the extinction at its middle.
  const double step = shape_.resolution;
  double depth = 0.0, begin = 0.0;
  while (begin < length) {
    const double part = std::min(step, length - begin), middle = begin + 0.5 * part;
    const double x = (point.x + direction.x * middle - shape_.origin.x) / shape_.resolution;
    const double y = (point.y + direction.y * middle - shape_.origin.y) / shape_.resolution;
    // Beyond the cells the air is clear; a line does not come back.
    if (!(x >= 0.0 && x < shape_.cols && y >= 0.0 && y < shape_.rows)) return length;
    const std::size_t cell = static_cast<std::size_t>(y) * shape_.cols + static_cast<std::size_t>(x);
    const double extinction = extinction_ * soot_[cell];
    if (depth + extinction * part >= limit_) return begin + (limit_ - depth) / extinction;
    depth += extinction * part;
    begin += step;
  }
  return length;
}

}  // namespace robotteamsim::hazards

#include "robotteamsim/hazards/grid_values.hpp"

#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::hazards {
namespace {

void CheckShape(const plan::GridShape& shape) {
  base::Check(shape.origin, "origin_m");
  base::CheckPositive(shape.resolution_m, "resolution_m");
  if (shape.rows < 0 || shape.cols < 0) throw std::invalid_argument("rows and columns must not be negative");
}

}  // namespace

std::vector<double> ValuesAt(const GridValues& values, const std::vector<base::Point>& points, double outside) {
  const plan::GridShape& shape = values.shape;
  CheckShape(shape);
  base::Check(outside, "outside");
  std::vector<double> found;
  found.reserve(points.size());
  for (const base::Point& point : points) {
    const double col = std::floor((point.x - shape.origin.x) / shape.resolution_m);
    const double row = std::floor((point.y - shape.origin.y) / shape.resolution_m);
    const bool is_inside = col >= 0.0 && col < shape.cols && row >= 0.0 && row < shape.rows;
    found.push_back(is_inside ? values.data[static_cast<std::size_t>(row) * shape.cols + static_cast<std::size_t>(col)]
                              : outside);
    if (!std::isfinite(found.back())) throw std::invalid_argument("values must be finite");
  }
  return found;
}

std::vector<base::Point> HotInSight(const GridValues& temperatures, double limit_c, const plan::PlanningGrid& sight,
                                    const base::Point& place, double range_m) {
  const plan::GridShape& shape = temperatures.shape;
  CheckShape(shape);
  base::Check(place, "place_m");
  base::CheckNotNegative(range_m, "range_m");
  std::vector<base::Point> found;
  const auto index = [&](double offset, int count) {
    return base::ClampedInt(std::floor(offset / shape.resolution_m), 0, count - 1);
  };
  if (shape.rows == 0 || shape.cols == 0) return found;
  const int last_row = index(place.y + range_m - shape.origin.y, shape.rows);
  const int first_col = index(place.x - range_m - shape.origin.x, shape.cols);
  const int last_col = index(place.x + range_m - shape.origin.x, shape.cols);
  for (int row = index(place.y - range_m - shape.origin.y, shape.rows); row <= last_row; ++row) {
    for (int col = first_col; col <= last_col; ++col) {
      if (!(temperatures.data[static_cast<std::size_t>(row) * shape.cols + col] >= limit_c)) continue;
      const base::Point hot{shape.origin.x + (col + 0.5) * shape.resolution_m,
                            shape.origin.y + (row + 0.5) * shape.resolution_m};
      const double x = hot.x - place.x, y = hot.y - place.y;
      if (x * x + y * y <= range_m * range_m && sight.IsLineFree(place, hot)) found.push_back(hot);
    }
  }
  return found;
}

}  // namespace robotteamsim::hazards

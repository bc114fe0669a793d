#include "robotteamsim/propagation/face_set.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

namespace robotteamsim {
namespace {

/// Where a point lies exactly on the line through a and b, the point moved by (eps, eps^2) lies to the left of it when
/// this holds: the cross product (b - a) x (eps, eps^2) is dx * eps^2 - dy * eps.
bool MovedPointIsLeft(std::int64_t dx, std::int64_t dy) { return dy < 0 || (dy == 0 && dx > 0); }

/// The same for a point that stays while the line from p to q is moved.
bool PointIsLeftOfMoved(std::int64_t dx, std::int64_t dy) { return dy > 0 || (dy == 0 && dx < 0); }

/// Whole numbers from low to high; empty where low > high.
struct Range {
  std::int64_t low;
  std::int64_t high;
};

std::int64_t FloorDivide(std::int64_t numerator, std::int64_t positive) {
  const std::int64_t quotient = numerator / positive;
  return quotient - (numerator % positive < 0 ? 1 : 0);
}

/// Keeps of the range the u with slope * u + offset >= 0.
void KeepNotNegative(std::int64_t slope, std::int64_t offset, Range* u) {
  if (slope > 0) {
    u->low = std::max(u->low, -FloorDivide(offset, slope));
  } else if (slope < 0) {
    u->high = std::min(u->high, FloorDivide(offset, -slope));
  } else if (offset < 0) {
    u->high = u->low - 1;
  }
}

/// Keeps of the range the u where the orientation slope * u + offset is left, or right, of a line; zero counts as left
/// when `tie_is_left`.
void KeepSide(std::int64_t slope, std::int64_t offset, bool tie_is_left, bool left, Range* u) {
  const std::int64_t shifted = tie_is_left ? offset : offset - 1;  // left is shifted >= 0, right is shifted < 0
  if (left) {
    KeepNotNegative(slope, shifted, u);
  } else {
    KeepNotNegative(-slope, -shifted - 1, u);
  }
}

}  // namespace

PointMm RoundToMm(const Point& point, std::string_view place) {
  const double x = std::round(point.x * 1000.0);
  const double y = std::round(point.y * 1000.0);
  const double limit = static_cast<double>(kMaxCoordinateMm);
  if (!(std::abs(x) <= limit && std::abs(y) <= limit)) {
    std::ostringstream message;
    message << place << " must be finite and within 1000 km, got (" << point.x << ", " << point.y << ")";
    throw std::invalid_argument(message.str());
  }
  return {static_cast<std::int64_t>(x), static_cast<std::int64_t>(y)};
}

double DistanceM(PointMm a, PointMm b) {
  const std::int64_t dx = b.x - a.x;
  const std::int64_t dy = b.y - a.y;
  return std::sqrt(static_cast<double>(dx * dx + dy * dy)) / 1000.0;
}

FaceSet::FaceSet(const std::vector<std::array<std::int64_t, 4>>& ends, const std::vector<std::int32_t>& weights)
    : weight_(weights), full_weight_(weights) {
  if (ends.size() != weights.size()) {
    throw std::invalid_argument("weights must hold one value per face: wanted " + std::to_string(ends.size()) +
                                ", got " + std::to_string(weights.size()));
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const auto& [x1, y1, x2, y2] = ends[i];
    const auto out_of_range = [](std::int64_t value) { return value < -kMaxCoordinateMm || value > kMaxCoordinateMm; };
    if (std::any_of(ends[i].begin(), ends[i].end(), out_of_range)) {
      throw std::invalid_argument("face " + std::to_string(i) + " must lie within 1000 km");
    }
    if (x1 == x2 && y1 == y2) {
      throw std::invalid_argument("face " + std::to_string(i) + " must have two different ends");
    }
    if (weights[i] < 0) {
      throw std::invalid_argument("weight of face " + std::to_string(i) + " must be >= 0, got " +
                                  std::to_string(weights[i]));
    }
    start_x_.push_back(x1);
    start_y_.push_back(y1);
    end_x_.push_back(x2);
    end_y_.push_back(y2);
  }
}

void FaceSet::SetActive(std::size_t face, bool active) {
  if (face >= Size()) {
    throw std::invalid_argument("there is no face " + std::to_string(face) + ", only " + std::to_string(Size()));
  }
  weight_[face] = active ? full_weight_[face] : 0;
}

std::int64_t FaceSet::WeightBetween(PointMm a, PointMm b) const {
  const std::int64_t dx = b.x - a.x;
  const std::int64_t dy = b.y - a.y;
  const std::int64_t left_from = MovedPointIsLeft(dx, dy) ? 0 : 1;
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < Size(); ++i) {
    const bool start_left = dx * (start_y_[i] - a.y) - dy * (start_x_[i] - a.x) >= left_from;
    const bool end_left = dx * (end_y_[i] - a.y) - dy * (end_x_[i] - a.x) >= left_from;
    if (start_left == end_left) continue;
    const std::int64_t ex = end_x_[i] - start_x_[i];
    const std::int64_t ey = end_y_[i] - start_y_[i];
    const std::int64_t face_left_from = PointIsLeftOfMoved(ex, ey) ? 0 : 1;
    const bool a_left = ex * (a.y - start_y_[i]) - ey * (a.x - start_x_[i]) >= face_left_from;
    const bool b_left = ex * (b.y - start_y_[i]) - ey * (b.x - start_x_[i]) >= face_left_from;
    if (a_left != b_left) sum += weight_[i];
  }
  return sum;
}

std::vector<std::int64_t> FaceSet::WeightsAlongRow(PointMm source, std::int64_t row_y,
                                                   const std::vector<std::int64_t>& columns_x) const {
  std::vector<std::int64_t> sums(columns_x.size(), 0);
  const std::int64_t dy = row_y - source.y;
  if (columns_x.empty()) return sums;
  if (dy == 0) {  // all rays run along the row
    for (std::size_t i = 0; i < columns_x.size(); ++i) sums[i] = WeightBetween(source, {columns_x[i], row_y});
    return sums;
  }
  // A face shades one run of the row: the points beyond its line and between the rays through its two ends. Each of
  // the three conditions is linear in the point's x, so the run's ends follow by division, exactly.
  std::vector<std::int64_t> steps(columns_x.size() + 1, 0);
  const bool end_tie_is_left = dy < 0;  // MovedPointIsLeft of every ray to this row
  for (std::size_t i = 0; i < Size(); ++i) {
    if (weight_[i] == 0 || std::max(start_y_[i], end_y_[i]) < std::min(source.y, row_y) ||
        std::min(start_y_[i], end_y_[i]) > std::max(source.y, row_y)) {
      continue;
    }
    const std::int64_t ex = end_x_[i] - start_x_[i];
    const std::int64_t ey = end_y_[i] - start_y_[i];
    const std::int64_t px = start_x_[i] - source.x;
    const std::int64_t py = start_y_[i] - source.y;
    const bool tie_is_left = PointIsLeftOfMoved(ex, ey);
    const bool source_left = ey * px - ex * py >= (tie_is_left ? 0 : 1);
    Range u{columns_x.front() - source.x, columns_x.back() - source.x};  // x of the point, from the source's x
    KeepSide(-ey, ex * (dy - py) + ey * px, tie_is_left, !source_left, &u);
    KeepSide(py, -dy * px, end_tie_is_left, !source_left, &u);
    KeepSide(end_y_[i] - source.y, -dy * (end_x_[i] - source.x), end_tie_is_left, source_left, &u);
    if (u.low > u.high) continue;
    const auto first = std::lower_bound(columns_x.begin(), columns_x.end(), u.low + source.x);
    const auto last = std::upper_bound(first, columns_x.end(), u.high + source.x);
    steps[first - columns_x.begin()] += weight_[i];
    steps[last - columns_x.begin()] -= weight_[i];
  }
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = sum += steps[i];
  return sums;
}

}  // namespace robotteamsim

#include "robotteamsim/propagation/face_set.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace robotteamsim::propagation {
namespace {

/// Returns whether a point exactly on the line through a and b is to its left after a shift by (eps, eps^2): the cross
/// product (b - a) x (eps, eps^2) is dx * eps^2 - dy * eps.
bool MovedPointIsLeft(std::int64_t dx, std::int64_t dy) { return dy < 0 || (dy == 0 && dx > 0); }

/// The same for a fixed point and a shifted line from p to q.
bool PointIsLeftOfMoved(std::int64_t dx, std::int64_t dy) { return dy > 0 || (dy == 0 && dx < 0); }

/// A coordinate this near to half a millimetre is half a millimetre [mm]: 8.0255 m is 8025.499999999999 mm in doubles.
constexpr double kHalfTolerance = 1e-6;

double WholeMm(double metres) {
  const double mm = metres * 1000.0;
  return std::round(mm + std::copysign(kHalfTolerance, mm));
}

/// About the number of faces of a wall and its neighbours: most boxes are far from most segments.
constexpr std::size_t kFacesPerBox = 8;

}  // namespace

PointMm RoundToMm(const base::Point& point, std::string_view place) {
  const double x = WholeMm(point.x);
  const double y = WholeMm(point.y);
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

bool IsLeftOf(const Face& face, PointMm point) {
  const std::int64_t dx = face.end.x - face.start.x;
  const std::int64_t dy = face.end.y - face.start.y;
  return dx * (point.y - face.start.y) - dy * (point.x - face.start.x) >= (PointIsLeftOfMoved(dx, dy) ? 0 : 1);
}

FaceSet::FaceSet(const std::vector<std::array<std::int64_t, 4>>& ends, const std::vector<std::int32_t>& weights,
                 std::vector<Storey> storeys)
    : weight_(weights), full_weight_(weights), storeys_(std::move(storeys)) {
  if (ends.size() != weights.size()) {
    throw std::invalid_argument("weights must have one value per face: expected " + std::to_string(ends.size()) +
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
    total_weight_ += weights[i];
  }
  NumberVertices();
  BoxFaces();
  CheckStoreys();
  if (storeys_.size() > 1) DivideFaces();
}

void FaceSet::NumberVertices() {
  std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> numbers;
  const auto number = [&](std::int64_t x, std::int64_t y) {
    const auto [entry, is_new] = numbers.try_emplace({x, y}, vertices_.size());
    if (is_new) vertices_.push_back({x, y});
    return entry->second;
  };
  for (std::size_t i = 0; i < Size(); ++i) {
    const std::size_t start = number(start_x_[i], start_y_[i]);
    vertices_of_face_.push_back({start, number(end_x_[i], end_y_[i])});
  }
}

void FaceSet::BoxFaces() {
  for (std::size_t i = 0; i < Size(); ++i) {
    const auto& [x_least, x_most] = std::minmax(start_x_[i], end_x_[i]);
    const auto& [y_least, y_most] = std::minmax(start_y_[i], end_y_[i]);
    if (i % kFacesPerBox == 0) boxes_.push_back({{x_least, y_least}, {x_most, y_most}});
    Box& box = boxes_.back();
    box.least = {std::min(box.least.x, x_least), std::min(box.least.y, y_least)};
    box.most = {std::max(box.most.x, x_most), std::max(box.most.y, y_most)};
  }
}

Face FaceSet::At(std::size_t face) const {
  const auto& [start_vertex, end_vertex] = vertices_of_face_[face];
  return {vertices_[start_vertex], vertices_[end_vertex], weight_[face], start_vertex, end_vertex};
}

void FaceSet::SetActive(std::size_t face, bool active) {
  if (face >= Size()) {
    throw std::invalid_argument("no face " + std::to_string(face) + ", only " + std::to_string(Size()));
  }
  weight_[face] = active ? full_weight_[face] : 0;
  if (on_storey_.empty()) return;
  const auto& [storey, index] = place_on_storey_[face];
  on_storey_[storey].SetActive(index, active);
}

std::int64_t FaceSet::WeightBetween(PointMm a, PointMm b) const {
  const std::int64_t dx = b.x - a.x;
  const std::int64_t dy = b.y - a.y;
  const std::int64_t left_from = dx * a.y - dy * a.x + (MovedPointIsLeft(dx, dy) ? 0 : 1);
  const auto is_left = [&](std::int64_t x, std::int64_t y) { return dx * y - dy * x >= left_from; };
  const auto& [x_least, x_most] = std::minmax(a.x, b.x);
  const auto& [y_least, y_most] = std::minmax(a.y, b.y);
  std::int64_t sum = 0;
  for (std::size_t k = 0; k < boxes_.size(); ++k) {
    // An infinitely small shift can make faces cross only what they touch. All tests are combined into one branch,
    // which is rarely mispredicted.
    const Box& box = boxes_[k];
    const bool is_apart = static_cast<int>(box.most.x < x_least) | static_cast<int>(box.least.x > x_most) |
                          static_cast<int>(box.most.y < y_least) | static_cast<int>(box.least.y > y_most);
    if (is_apart) continue;
    for (std::size_t i = k * kFacesPerBox; i < std::min((k + 1) * kFacesPerBox, Size()); ++i) {
      const bool start_left = is_left(start_x_[i], start_y_[i]);
      const bool end_left = is_left(end_x_[i], end_y_[i]);
      if (start_left == end_left) continue;
      const std::int64_t ex = end_x_[i] - start_x_[i];
      const std::int64_t ey = end_y_[i] - start_y_[i];
      const std::int64_t face_left_from = PointIsLeftOfMoved(ex, ey) ? 0 : 1;
      const bool a_left = ex * (a.y - start_y_[i]) - ey * (a.x - start_x_[i]) >= face_left_from;
      const bool b_left = ex * (b.y - start_y_[i]) - ey * (b.x - start_x_[i]) >= face_left_from;
      if (a_left != b_left) sum += weight_[i];
    }
  }
  return sum;
}

}  // namespace robotteamsim::propagation

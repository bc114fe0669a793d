#include "robotteamsim/world/nearby_edges.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::world {
namespace {

/// In buildings of square kilometres cells are larger, so that all fit into the memory.
constexpr double kMostCells = 5e5;

/// Few edges over a large area need no more, since no list is longer than that of all edges.
constexpr double kMostCellsPerEdge = 1e3;

}  // namespace

double DistanceToSegment(const base::Point& point, const base::Segment& segment) {
  const double dx = segment.b.x - segment.a.x, dy = segment.b.y - segment.a.y;
  const double px = point.x - segment.a.x, py = point.y - segment.a.y;
  const double length2 = dx * dx + dy * dy;
  const double along = length2 > 0.0 ? std::clamp((px * dx + py * dy) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(px - along * dx, py - along * dy);
}

std::vector<Edge> EdgesOf(const std::vector<Solid>& solids, const std::vector<Door>& doors) {
  std::vector<Edge> edges;
  const auto add = [&](const Polygon& outline, int door) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      edges.push_back({{outline[i], outline[(i + 1) % outline.size()]}, door});
    }
  };
  for (const Solid& solid : solids) add(solid.outline, Edge::kNoDoor);
  for (std::size_t door = 0; door < doors.size(); ++door) {
    if (doors[door].motion.time_s == 0.0) add(doors[door].leaf.outline, static_cast<int>(door));
  }
  return edges;
}

NearbyEdges::NearbyEdges(std::vector<Edge> edges, double reach_m) : all_(std::move(edges)) {
  base::CheckPositive(reach_m, "reach_m");
  if (all_.empty()) return;
  const double infinity = std::numeric_limits<double>::infinity();
  base::Point low{infinity, infinity}, high{-infinity, -infinity};
  for (const auto& [segment, door] : all_) {
    base::Check(segment.a, "a corner");
    base::Check(segment.b, "a corner");
    low = {std::min({low.x, segment.a.x, segment.b.x}), std::min({low.y, segment.a.y, segment.b.y})};
    high = {std::max({high.x, segment.a.x, segment.b.x}), std::max({high.y, segment.a.y, segment.b.y})};
  }
  origin_ = low;
  // Smaller cells have shorter lists, but there are more of them; lists for a long reach are long for any cell size.
  const double width = high.x - low.x, height = high.y - low.y;
  const double most = std::min(kMostCells, kMostCellsPerEdge * static_cast<double>(all_.size()));
  cell_m_ = std::max({0.2 * reach_m, 0.5, std::sqrt(width * height / most), (width + height) / most});
  columns_ = static_cast<int>(width / cell_m_) + 1;
  rows_ = static_cast<int>(height / cell_m_) + 1;
  cells_.resize(static_cast<std::size_t>(columns_) * rows_);
  for (const Edge& edge : all_) AddToCells(edge, reach_m);
}

const std::vector<Edge>& NearbyEdges::Near(const base::Point& point) const {
  const int column = Column(point.x), row = Row(point.y);
  const bool inside = column >= 0 && column < columns_ && row >= 0 && row < rows_;
  return inside ? cells_[static_cast<std::size_t>(row) * columns_ + column] : all_;
}

int NearbyEdges::Column(double x) const {
  return base::ClampedInt(std::floor((x - origin_.x) / cell_m_), -1, columns_);
}

int NearbyEdges::Row(double y) const { return base::ClampedInt(std::floor((y - origin_.y) / cell_m_), -1, rows_); }

void NearbyEdges::AddToCells(const Edge& edge, double reach_m) {
  const base::Segment& segment = edge.segment;
  const double far = reach_m + 0.7072 * cell_m_;  // from a cell's centre: its half diagonal is cell * sqrt(1/2)
  const int first_column = std::max(Column(std::min(segment.a.x, segment.b.x) - far), 0);
  const int last_column = std::min(Column(std::max(segment.a.x, segment.b.x) + far), columns_ - 1);
  const int first_row = std::max(Row(std::min(segment.a.y, segment.b.y) - far), 0);
  const int last_row = std::min(Row(std::max(segment.a.y, segment.b.y) + far), rows_ - 1);
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      const base::Point center{origin_.x + (column + 0.5) * cell_m_, origin_.y + (row + 0.5) * cell_m_};
      if (DistanceToSegment(center, segment) <= far) {
        cells_[static_cast<std::size_t>(row) * columns_ + column].push_back(edge);
      }
    }
  }
}

}  // namespace robotteamsim::world

#include "robotteamsim/world/disc_grid.hpp"

#include <algorithm>
#include <cmath>

namespace robotteamsim {
namespace {

// Two robots a cell on average: smaller cells would mostly be empty.
constexpr double kRobotsPerCell = 2.0;
constexpr double kSmallestCell = 0.5;  // [m]

}  // namespace

void DiscGrid::Rebuild(const std::vector<Pose>& poses) {
  robots_.resize(poses.size());
  poses_.resize(poses.size());
  if (poses.empty()) return;
  origin_ = {poses[0].x, poses[0].y};
  Point high = origin_;
  for (const Pose& pose : poses) {
    origin_ = {std::min(origin_.x, pose.x), std::min(origin_.y, pose.y)};
    high = {std::max(high.x, pose.x), std::max(high.y, pose.y)};
  }
  const double width = high.x - origin_.x, height = high.y - origin_.y;
  const auto count = static_cast<double>(poses.size());
  // Robots in a row cover no area: then it is the cells along the row that are counted.
  const double cell =
      std::max({kSmallestCell, std::sqrt(kRobotsPerCell * width * height / count), (width + height) / count});
  cells_per_metre_ = 1.0 / cell;
  columns_ = static_cast<int>(width * cells_per_metre_) + 1;
  rows_ = static_cast<int>(height * cells_per_metre_) + 1;
  start_.assign(static_cast<std::size_t>(columns_) * rows_ + 2, 0);
  for (const Pose& pose : poses) ++start_[Cell(pose) + 2];
  for (std::size_t cell_index = 2; cell_index < start_.size(); ++cell_index)
    start_[cell_index] += start_[cell_index - 1];
  for (std::size_t robot = 0; robot < poses.size(); ++robot) {
    const int place = start_[Cell(poses[robot]) + 1]++;
    robots_[place] = static_cast<int>(robot);
    poses_[place] = poses[robot];
  }
}

int DiscGrid::Column(double x) const {
  return static_cast<int>(std::clamp((x - origin_.x) * cells_per_metre_, 0.0, columns_ - 1.0));
}

int DiscGrid::Row(double y) const {
  return static_cast<int>(std::clamp((y - origin_.y) * cells_per_metre_, 0.0, rows_ - 1.0));
}

}  // namespace robotteamsim

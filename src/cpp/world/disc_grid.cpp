#include "robotteamsim/world/disc_grid.hpp"

#include <algorithm>
#include <cmath>

namespace robotteamsim::world {
namespace {

// Two robots per cell on average: smaller cells would mostly be empty.
constexpr double kRobotsPerCell = 2.0;
constexpr double kSmallestCell = 0.5;  // [m]

}  // namespace

void DiscGrid::Rebuild(const std::vector<base::Pose>& poses) {
  const auto is_there = [](const base::Pose& pose) { return pose.x == pose.x; };
  const auto first = std::find_if(poses.begin(), poses.end(), is_there);
  const auto num_there = static_cast<std::size_t>(std::count_if(first, poses.end(), is_there));
  robots_.resize(num_there);
  poses_.resize(num_there);
  if (num_there == 0) {
    columns_ = rows_ = 1;
    start_.assign(2, 0);
    return;
  }
  origin_ = {first->x, first->y};
  base::Point high = origin_;
  for (const base::Pose& pose : poses) {
    if (!is_there(pose)) continue;
    origin_ = {std::min(origin_.x, pose.x), std::min(origin_.y, pose.y)};
    high = {std::max(high.x, pose.x), std::max(high.y, pose.y)};
  }
  const double width = high.x - origin_.x, height = high.y - origin_.y;
  const auto count = static_cast<double>(num_there);
  // Robots in a line cover no area: then the number of cells along the line decides.
  const double cell =
      std::max({kSmallestCell, std::sqrt(kRobotsPerCell * width * height / count), (width + height) / count});
  cells_per_metre_ = 1.0 / cell;
  columns_ = static_cast<int>(width * cells_per_metre_) + 1;
  rows_ = static_cast<int>(height * cells_per_metre_) + 1;
  start_.assign(static_cast<std::size_t>(columns_) * rows_ + 2, 0);
  for (const base::Pose& pose : poses) {
    if (is_there(pose)) ++start_[Cell(pose) + 2];
  }
  for (std::size_t cell_index = 2; cell_index < start_.size(); ++cell_index)
    start_[cell_index] += start_[cell_index - 1];
  for (std::size_t robot = 0; robot < poses.size(); ++robot) {
    if (!is_there(poses[robot])) continue;
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

}  // namespace robotteamsim::world

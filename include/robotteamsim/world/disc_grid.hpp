#pragma once

#include <cstddef>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/world/drive.hpp"

namespace robotteamsim::world {

/// Finds the robots near a point: they are sorted by square cells of the floor.
class DiscGrid {
 public:
  /// Takes over the poses of the robots; one whose x is NaN is not there.
  void Rebuild(const std::vector<base::Pose>& poses);

  /// Calls meet(robot, pose) for all robots whose centre is within reach of the point, and for some beyond it.
  template <typename Meet>
  void ForEachNear(const base::Point& point, double reach_m, const Meet& meet) const {
    const int first_column = Column(point.x - reach_m), last_column = Column(point.x + reach_m);
    const int first_row = Row(point.y - reach_m), last_row = Row(point.y + reach_m);
    for (int row = first_row; row <= last_row; ++row) {
      const int* const start = start_.data() + static_cast<std::ptrdiff_t>(row) * columns_;
      for (int k = start[first_column]; k < start[last_column + 1]; ++k) meet(robots_[k], poses_[k]);
    }
  }

 private:
  // Clamped to the grid: its border cells also hold all that is beyond them.
  int Column(double x) const;
  int Row(double y) const;
  int Cell(const base::Pose& pose) const { return Row(pose.y) * columns_ + Column(pose.x); }

  base::Point origin_;
  double cells_per_metre_ = 1.0;
  int columns_ = 1;
  int rows_ = 1;
  // index of each cell's first robot in the lists below, row by row, and one past the end
  std::vector<int> start_{0, 0};
  std::vector<int> robots_;
  std::vector<base::Pose> poses_;
};

}  // namespace robotteamsim::world

#include "robotteamsim/control/voice_losses.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/base/hypot.hpp"
#include "robotteamsim/base/log10.hpp"
#include "robotteamsim/propagation/cells.hpp"
#include "robotteamsim/propagation/maps/field_maps.hpp"

namespace robotteamsim::control {
namespace {

plan::GridShape CheckedGrid(const plan::GridShape& grid) {
  base::Check(grid.origin, "origin_m");
  base::CheckPositive(grid.resolution_m, "cell_m");
  if (grid.rows < 1 || grid.cols < 1 || grid.rows > VoiceLosses::kMostCells / grid.cols) {
    throw std::invalid_argument("a grid of the belief must have 1 to 65536 cells");
  }
  return grid;
}

AssumedFading CheckedFading(const AssumedFading& fading) {
  base::CheckPositive(fading.slope_db, "slope_db");
  base::CheckNotNegative(fading.wall_unit_db, "wall_unit_db");
  base::CheckPositive(fading.min_distance_m, "min_distance_m");
  base::CheckNotNegative(fading.nearer_m, "nearer_m");
  base::CheckPositive(fading.step_db, "step_db");
  return fading;
}

/// Returns a number of steps rounded up, from 0 to kSilent. Unlike with std::ceil, loops of it are vectorised.
std::uint8_t RoundedUp(float steps) {
  const float limited = std::min(std::max(0.0F, steps), static_cast<float>(VoiceLosses::kSilent));
  const auto whole = static_cast<int>(limited);
  return static_cast<std::uint8_t>(whole + (static_cast<float>(whole) < limited ? 1 : 0));
}

}  // namespace

VoiceLosses::VoiceLosses(propagation::FaceSet faces, const plan::GridShape& grid, const AssumedFading& fading)
    : faces_(std::move(faces)), grid_(CheckedGrid(grid)), fading_(CheckedFading(fading)) {
  rows_.resize(static_cast<std::size_t>(grid_.rows) * grid_.cols);
  over_distance_.reserve(static_cast<std::size_t>(grid_.rows) * (2 * grid_.cols - 1));
  for (int row = 0; row < grid_.rows; ++row) {
    for (int col = 1 - grid_.cols; col < grid_.cols; ++col) {
      const double apart = grid_.resolution_m * base::Hypot(1.0 * col, 1.0 * row);
      const double distance = std::max(apart - fading_.nearer_m, fading_.min_distance_m);
      over_distance_.push_back(static_cast<float>(fading_.slope_db * base::Log10(distance)));
    }
  }
}

const std::vector<std::uint8_t>& VoiceLosses::From(int cell) const {
  if (cell < 0 || static_cast<std::size_t>(cell) >= rows_.size()) {
    throw std::invalid_argument("there is no cell " + std::to_string(cell));
  }
  std::vector<std::uint8_t>& losses = rows_[cell];
  if (!losses.empty()) return losses;
  const int from_row = cell / grid_.cols, from_col = cell % grid_.cols;
  const std::vector<float> walls_db = WallsFromDb(propagation::CellCenter(grid_, from_row, from_col));
  const auto steps_per_db = static_cast<float>(1.0 / fading_.step_db);
  losses.resize(rows_.size());
  const int middle = grid_.cols - 1;  // of a row of over_distance_
  for (int row = 0; row < grid_.rows; ++row) {
    const std::size_t apart = static_cast<std::size_t>(std::abs(row - from_row)) * (2 * grid_.cols - 1);
    const float* const over_distance = &over_distance_[apart + middle - from_col];
    const std::size_t first = static_cast<std::size_t>(row) * grid_.cols;
    const float* const walls = &walls_db[first];
    std::uint8_t* const in_row = &losses[first];
    for (int col = 0; col < grid_.cols; ++col)
      in_row[col] = RoundedUp((over_distance[col] + walls[col]) * steps_per_db);
  }
  if (faces_.storeys().size() > 1) {
    const auto storey_of = [&](int row, int col) {
      return faces_.StoreyOf(propagation::RoundToMm(propagation::CellCenter(grid_, row, col), "a cell"));
    };
    const std::size_t own = storey_of(from_row, from_col);
    for (int row = 0; row < grid_.rows; ++row) {
      for (int col = 0; col < grid_.cols; ++col) {
        if (storey_of(row, col) != own) losses[static_cast<std::size_t>(row) * grid_.cols + col] = kSilent;
      }
    }
  }
  return losses;
}

std::uint8_t VoiceLosses::WithoutWalls(int rows, int cols) const {
  const std::size_t middle = static_cast<std::size_t>(rows) * (2 * grid_.cols - 1) + grid_.cols - 1;
  return RoundedUp(over_distance_.at(middle + cols) * static_cast<float>(1.0 / fading_.step_db));
}

int VoiceLosses::ReachOf(int steps) const {
  int reach = 0;
  const int longest = std::max(grid_.rows, grid_.cols);
  for (int apart = 1; apart < longest; ++apart) {
    // Without walls, and along a row or a column, the loss is smallest.
    const double distance = std::max(apart * grid_.resolution_m - fading_.nearer_m, fading_.min_distance_m);
    if (std::ceil(fading_.slope_db * base::Log10(distance) / fading_.step_db) < steps) reach = apart;
  }
  return reach;
}

std::vector<float> VoiceLosses::WallsFromDb(const base::Point& place) const {
  std::vector<float> walls_db;
  walls_db.reserve(rows_.size());
  for (const std::int32_t weight : propagation::WeightsFrom(faces_, propagation::RoundToMm(place, "place_m"), grid_)) {
    walls_db.push_back(static_cast<float>(fading_.wall_unit_db * weight));
  }
  return walls_db;
}

}  // namespace robotteamsim::control

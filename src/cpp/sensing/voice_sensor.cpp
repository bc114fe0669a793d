#include "robotteamsim/sensing/voice_sensor.hpp"

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::sensing {

VoiceSensor::VoiceSensor(const plan::GridShape& grid, propagation::MapValues map, double radius_m)
    : grid_(grid), map_(std::move(map)), radius_m_(radius_m) {
  if (map_.rows() != grid.rows || map_.cols() != grid.cols) throw std::invalid_argument("the map must fit the grid");
  base::Check(grid.origin, "origin_m");
  base::CheckPositive(grid.resolution_m, "resolution_m");
  base::CheckNotNegative(radius_m, "radius_m");
  if (!map_.allFinite()) throw std::invalid_argument("levels_db must be finite");
}

void VoiceSensor::Hear(state::State* state, std::size_t mission) {
  if (mission >= state->missions) throw std::invalid_argument("no such mission");
  last_.resize(state->robots);
  for (std::size_t i = 0; i < state->robots; ++i) HearAt(state->First(mission) + i, &last_[i], state);
}

void VoiceSensor::HearAt(std::size_t row, std::optional<propagation::Cell>* last, state::State* state) const {
  const base::Point position{state->true_pose[row].x, state->true_pose[row].y};
  state->voice_level_db[row] = 0.0;
  state->voice_heard[row] = 0;
  state->local_best[row] = position;
  state->local_best_level_db[row] = 0.0;
  if (std::isnan(position.x) && std::isnan(position.y)) return;
  base::Check(position, "position_m");
  const double cell_row = std::floor((position.y - grid_.origin.y) / grid_.resolution_m);
  const double cell_col = std::floor((position.x - grid_.origin.x) / grid_.resolution_m);
  const bool is_inside = cell_row >= 0.0 && cell_row < grid_.rows && cell_col >= 0.0 && cell_col < grid_.cols;
  if (is_inside) state->voice_level_db[row] = map_(static_cast<int>(cell_row), static_cast<int>(cell_col));
  *last = propagation::LoudestCell(grid_, map_, position, radius_m_, *last);
  if (!*last) return;
  state->voice_heard[row] = 1;
  state->local_best[row] = propagation::CellCenter(grid_, (*last)->row, (*last)->col);
  state->local_best_level_db[row] = (*last)->value;
}

}  // namespace robotteamsim::sensing

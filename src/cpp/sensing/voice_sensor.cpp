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

std::vector<VoiceReading> VoiceSensor::Hear(const std::vector<base::Point>& positions) {
  last_.resize(positions.size());
  std::vector<VoiceReading> heard;
  heard.reserve(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) heard.push_back(HearAt(positions[i], &last_[i]));
  return heard;
}

VoiceReading VoiceSensor::HearAt(const base::Point& position, std::optional<propagation::Cell>* last) const {
  VoiceReading reading;
  reading.local_best = position;
  if (std::isnan(position.x) && std::isnan(position.y)) return reading;
  base::Check(position, "position_m");
  const double row = std::floor((position.y - grid_.origin.y) / grid_.resolution_m);
  const double col = std::floor((position.x - grid_.origin.x) / grid_.resolution_m);
  const bool is_inside = row >= 0.0 && row < grid_.rows && col >= 0.0 && col < grid_.cols;
  reading.level_db = is_inside ? map_(static_cast<int>(row), static_cast<int>(col)) : 0.0F;
  *last = propagation::LoudestCell(grid_, map_, position, radius_m_, *last);
  reading.heard = last->has_value();
  reading.local_best = *last ? propagation::CellCenter(grid_, (*last)->row, (*last)->col) : position;
  reading.local_best_level_db = *last ? (*last)->value : 0.0;
  return reading;
}

}  // namespace robotteamsim::sensing

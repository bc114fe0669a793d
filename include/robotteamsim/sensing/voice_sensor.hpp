#pragma once

#include <optional>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/propagation/voice.hpp"

namespace robotteamsim::sensing {

/// A robot's reading of the voice map.
struct VoiceReading {
  double level_db = 0.0;             ///< of its own cell; 0 beyond the map
  bool heard = false;                ///< whether a cell within the radius is above 0
  base::Point local_best;            ///< centre of the loudest such cell; the robot's position if there is none [m]
  double local_best_level_db = 0.0;  ///< 0 if there is none
};

/// Reads one voice map at the robots' positions.
class VoiceSensor {
 public:
  /// Args: map: the levels of the cells of `grid` [dB]; radius_m: of the search for the loudest cell [m].
  /// Throws std::invalid_argument if the map does not fit the grid.
  VoiceSensor(const plan::GridShape& grid, propagation::MapValues map, double radius_m);

  /// Returns the reading of each robot; one whose position is NaN is absent and hears nothing.
  /// Throws std::invalid_argument if another position is not finite.
  std::vector<VoiceReading> Hear(const std::vector<base::Point>& positions);

 private:
  VoiceReading HearAt(const base::Point& position, std::optional<propagation::Cell>* last) const;

  plan::GridShape grid_;
  propagation::MapValues map_;
  double radius_m_;
  std::vector<std::optional<propagation::Cell>> last_;  ///< the last loudest cell of each robot
};

}  // namespace robotteamsim::sensing

#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/propagation/voice.hpp"
#include "robotteamsim/state/state.hpp"

namespace robotteamsim::sensing {

/// Reads one voice map at the robots' positions.
class VoiceSensor {
 public:
  /// Args: map: the levels of the cells of `grid` [dB]; radius_m: of the search for the loudest cell [m].
  /// Throws std::invalid_argument if the map does not fit the grid.
  VoiceSensor(const plan::GridShape& grid, propagation::MapValues map, double radius_m);

  /// Writes what the robots of a mission hear where they are; an absent one hears nothing.
  /// Throws std::invalid_argument if there is no such mission, or another position is not finite.
  void Hear(state::State* state, std::size_t mission);

 private:
  void HearAt(std::size_t row, std::optional<propagation::Cell>* last, state::State* state) const;

  plan::GridShape grid_;
  propagation::MapValues map_;
  double radius_m_;
  std::vector<std::optional<propagation::Cell>> last_;  ///< the last loudest cell of each robot
};

}  // namespace robotteamsim::sensing

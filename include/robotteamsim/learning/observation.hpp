#pragma once

#include <cstddef>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/base/table.hpp"
#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/radio.hpp"

namespace robotteamsim::learning {

/// Divides the levels of voices [dB].
constexpr double kLoudestDb = 100.0;

/// Signals become 0 to 1 between these [dBm].
constexpr double kWeakestDbm = -100.0, kStrongestDbm = -20.0;

/// Ages of messages become 0 to 1 up to this [s].
constexpr double kOldestS = 10.0;

/// What the numbers of n agents are divided by.
struct Units {
  std::vector<float> range_max_m;                     ///< of each agent
  std::vector<double> max_speed_mps, max_turn_radps;  ///< of each agent
  base::Point low_m, extent_m;                        ///< of the plan
  double diagonal_m = 0.0;                            ///< of the plan
  double voice_radius_m = 0.0;
};

/// What n agents of some missions perceive: a row per mission and agent, except that areas have one per mission.
/// Columns are those of `Percepts` in learning/observe.py.
struct Percepts {
  base::Table<const float> ranges_m;
  base::Table<const double> poses, twists, voices, areas;
  base::Table<const double> heard;  ///< `said + 4` numbers per teammate
  base::Table<const double> remembered;
  std::size_t said = 0;

  /// How many numbers the vector of an agent has.
  std::size_t VectorSize() const { return ranges_m.cols + 13 + heard.cols / (4 + said) * (5 + said) + remembered.cols; }
};

/// Writes the vector of each agent, within [-1, 1]: a row per mission and agent.
/// Throws std::invalid_argument if units are not positive, tables do not fit together, a number is NaN, or the position
/// of a teammate who was heard of is not finite.
void WriteVectors(const Units& units, const propagation::FaceSet& faces, const propagation::RadioModel& radio,
                  const Percepts& percepts, const base::Table<float>& vectors);

}  // namespace robotteamsim::learning

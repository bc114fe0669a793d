#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "robotteamsim/base/nearest.hpp"
#include "robotteamsim/base/table.hpp"
#include "robotteamsim/network/team_links.hpp"
#include "robotteamsim/sensing/team_sensors.hpp"
#include "robotteamsim/sensing/voice_sensor.hpp"
#include "robotteamsim/state/state.hpp"
#include "robotteamsim/world/world.hpp"

namespace robotteamsim::simulation {

/// The numeric half of a mission: what moves and measures, and nothing that decides.
struct Team {
  std::shared_ptr<world::World> world;
  std::shared_ptr<sensing::TeamSensors> sensors;
  std::shared_ptr<network::TeamLinks> links;
  std::shared_ptr<sensing::VoiceSensor> ear;   ///< of its current voice map
  std::shared_ptr<const base::Places> places;  ///< that its mission watches
};

/// Missions that make their steps together, on several threads. Each has its own team; none knows of the others, so the
/// results do not depend on their number, nor on that of the threads.
class Batch {
 public:
  /// Args: robots, beams: of the largest team.  threads: 0: one per core.
  /// Throws std::invalid_argument as `State` does, or if threads is negative.
  Batch(std::size_t missions, std::size_t robots, std::size_t beams, int threads);

  /// Lets another team take part as this mission from now on.
  /// Throws std::invalid_argument if a part is missing or another mission has it, or the team does not fit.
  void Put(std::size_t mission, Team team);

  /// Lets the robots of some missions move for a step. Args: twists: one row per robot of the largest team and mission,
  /// in base_link.  missions: their numbers.
  /// Throws std::invalid_argument, naming the mission: a command is not finite, and the others have moved; or there is
  /// no such mission, or one is named twice, and nothing has moved.
  void Move(const base::Table<const double>& twists, const std::vector<int>& missions);

  /// Lets the robots of some missions measure, hear each other and victims, and returns the state, in which the rows of
  /// other missions mean nothing. Throws std::invalid_argument, naming the mission, like `Move`.
  std::shared_ptr<state::State> Sense(const std::vector<int>& missions);

 private:
  struct Mission {
    Team team;
    std::int64_t doors_version = 0;
    std::int64_t links_version = 0;
    std::vector<base::Point> loudest;  // cells near the robots when they last heard a voice
  };

  void CheckMissions(const std::vector<int>& missions) const;
  void ForEach(const std::vector<int>& missions, const std::function<void(int)>& job) const;
  std::shared_ptr<state::State> UnusedState();
  void SenseOne(int mission, state::State* state);

  std::size_t robots_, beams_;
  int threads_;
  // The last ones, whose memory serves again: fresh pages cost large teams more than the numbers in them.
  std::vector<std::shared_ptr<state::State>> states_;
  std::vector<Mission> missions_;
};

}  // namespace robotteamsim::simulation

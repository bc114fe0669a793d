#include "robotteamsim/simulation/batch.hpp"

#include <exception>
#include <stdexcept>
#include <string>
#include <utility>

#include "robotteamsim/base/parallel.hpp"

namespace robotteamsim::simulation {
namespace {

// Two are in use while a step is made of the one before, and one by somebody who looks at the last record.
constexpr std::size_t kMostKept = 3;

}  // namespace

Batch::Batch(std::size_t missions, std::size_t robots, std::size_t beams, int threads)
    : robots_(robots),
      beams_(beams),
      threads_(base::NumThreads(threads)),
      states_{std::make_shared<state::State>(missions, robots, beams)},
      missions_(missions) {}

void Batch::Put(std::size_t mission, Team team) {
  if (mission >= missions_.size()) throw std::invalid_argument("no such mission");
  if (!team.world || !team.sensors || !team.links || !team.ear || !team.places) {
    throw std::invalid_argument("a team needs a world, sensors, links, an ear and places");
  }
  const std::size_t robots = team.world->robots().size();
  if (robots > robots_ || team.sensors->robots() != robots || team.sensors->beams() > beams_) {
    throw std::invalid_argument("the team has more robots or beams than the batch");
  }
  for (std::size_t other = 0; other < missions_.size(); ++other) {
    const Team& known = missions_[other].team;
    if (other != mission && (known.world == team.world || known.sensors == team.sensors || known.links == team.links ||
                             known.ear == team.ear)) {
      throw std::invalid_argument("another mission has a part of this team");
    }
  }
  const std::int64_t doors_version = team.world->doors_version();
  missions_[mission] = {std::move(team), doors_version, -1, {}};
}

void Batch::CheckMissions(const std::vector<int>& missions) const {
  std::vector<bool> is_named(missions_.size());
  for (const int mission : missions) {
    const std::string name = "mission " + std::to_string(mission);
    if (mission < 0 || mission >= static_cast<int>(missions_.size()) || !missions_[mission].team.world) {
      throw std::invalid_argument(name + ": there is none");
    }
    if (is_named[mission]) throw std::invalid_argument(name + ": is named twice");
    is_named[mission] = true;
  }
}

void Batch::ForEach(const std::vector<int>& missions, const std::function<void(int)>& job) const {
  std::vector<std::string> problems(missions.size());
  base::ForEachInParallel(static_cast<int>(missions.size()), threads_, [&](int i) {
    try {
      job(missions[i]);
    } catch (const std::exception& problem) {  // the others go on
      problems[i] = problem.what();
    }
  });
  for (std::size_t i = 0; i < missions.size(); ++i) {
    if (!problems[i].empty()) {
      throw std::invalid_argument("mission " + std::to_string(missions[i]) + ": " + problems[i]);
    }
  }
}

void Batch::Move(const base::Table<const double>& twists, const std::vector<int>& missions) {
  if (!twists.HasShape(missions_.size() * robots_, 3)) {
    throw std::invalid_argument("twists must have a row of three numbers per robot and mission");
  }
  CheckMissions(missions);
  ForEach(missions, [&](int mission) {
    world::World& world = *missions_[mission].team.world;
    std::vector<base::Twist> commands(world.robots().size());
    for (std::size_t i = 0; i < commands.size(); ++i) {
      const double* const row = twists.Row(mission * robots_ + i);
      commands[i] = {row[0], row[1], row[2]};
    }
    world.Step(commands);
  });
}

std::shared_ptr<state::State> Batch::UnusedState() {
  for (const std::shared_ptr<state::State>& state : states_) {
    if (state.use_count() == 1) return state;
  }
  auto state = std::make_shared<state::State>(missions_.size(), robots_, beams_);
  if (states_.size() < kMostKept) states_.push_back(state);
  return state;
}

std::shared_ptr<state::State> Batch::Sense(const std::vector<int>& missions) {
  CheckMissions(missions);
  std::shared_ptr<state::State> state = UnusedState();
  bool by_distance = false;
  for (const int mission : missions) by_distance |= missions_[mission].team.links->is_by_distance();
  state->NeedLinks(by_distance);  // here, because threads must not
  ForEach(missions, [&](int mission) { SenseOne(mission, state.get()); });
  return state;
}

void Batch::SenseOne(int mission, state::State* state) {
  Mission& own = missions_[mission];
  const Team& team = own.team;
  const std::size_t first = state->First(mission), robots = team.world->robots().size();
  for (std::size_t row = first + robots; row < first + robots_; ++row) {
    state->true_pose[row] = state::ReadingOf(world::kNowhere);
  }
  team.sensors->Read(*team.world, state, mission);
  team.ear->Hear(state, mission);
  team.links->Step(state, mission);
  std::uint8_t happened = 0;
  if (!team.places->Reached(state->Positions(mission)).empty()) happened |= state::kPlaceReached;
  if (state->links_version[mission] != own.links_version) happened |= state::kLinksChanged;
  own.links_version = state->links_version[mission];
  own.loudest.resize(robots, {0.0, 0.0});
  for (std::size_t i = 0; i < robots; ++i) {
    const std::size_t row = first + i;
    if (state->contact[row] != 0) happened |= state::kContact;
    if (state->voice_heard[row] == 0) continue;
    const base::Point& loudest = state->local_best[row];
    if (loudest.x != own.loudest[i].x || loudest.y != own.loudest[i].y) happened |= state::kVoiceChanged;
    own.loudest[i] = loudest;
  }
  if (team.world->doors_version() != own.doors_version) happened |= state::kDoorMoved;
  own.doors_version = team.world->doors_version();
  state->happened[mission] = happened;
}

}  // namespace robotteamsim::simulation

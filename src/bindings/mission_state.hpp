#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <memory>
#include <stdexcept>
#include <utility>

#include "robotteamsim/state/state.hpp"

namespace robotteamsim::bindings {

/// A state as Python has it: of all missions, whose arrays have a leading axis for them, or of one of them, without it.
class MissionState {
 public:
  MissionState(std::shared_ptr<state::State> state, bool is_of_one) : state_(std::move(state)), is_of_one_(is_of_one) {}

  const state::State& state() const { return *state_; }
  bool is_of_one() const { return is_of_one_; }

  /// The state of the mission. Throws std::invalid_argument if it is of several.
  state::State& one() const {
    if (!is_of_one_) throw std::invalid_argument("expected the state of one mission: state.of(mission)");
    return *state_;
  }
  /// The state of the mission. Throws std::out_of_range, too, if it has no such robot.
  state::State& WithRobot(std::size_t robot) const {
    if (robot >= state_->robots) throw std::out_of_range("no such robot");
    return one();
  }

  /// What each robot's additional sensors measured, by id and name.
  nanobind::dict sensors;

 private:
  std::shared_ptr<state::State> state_;
  bool is_of_one_;
};

}  // namespace robotteamsim::bindings

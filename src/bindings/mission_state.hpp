#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "robotteamsim/state/state.hpp"

namespace robotteamsim::bindings {

/// A state as Python has it: of all missions, whose arrays have a leading axis for them, or of one of them, without it.
class MissionState {
 public:
  MissionState(std::shared_ptr<state::State> state, std::optional<std::size_t> mission)
      : state_(std::move(state)), mission_(mission) {
    if (mission_.value_or(0) >= state_->missions) throw std::out_of_range("no such mission");
  }

  const state::State& state() const { return *state_; }
  state::State* written() const { return state_.get(); }
  bool is_of_one() const { return mission_.has_value(); }

  /// The number of the mission. Throws std::invalid_argument if the state is of several.
  std::size_t mission() const {
    if (!mission_) throw std::invalid_argument("expected the state of one mission: state.of(mission)");
    return *mission_;
  }
  /// The row of one of its robots.
  std::size_t Row(std::size_t robot) const {
    if (robot >= state_->robots) throw std::out_of_range("no such robot");
    return state_->First(mission()) + robot;
  }

  /// What each robot's additional sensors measured, by id and name.
  nanobind::dict sensors;

 private:
  std::shared_ptr<state::State> state_;
  std::optional<std::size_t> mission_;
};

}  // namespace robotteamsim::bindings

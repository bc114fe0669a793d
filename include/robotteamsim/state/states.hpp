#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "robotteamsim/state/state.hpp"

namespace robotteamsim::state {

/// Gives a state for each step, and reuses the memory of those that nobody holds any more: fresh pages cost large teams
/// more than the numbers in them.
class States {
 public:
  /// Throws std::invalid_argument as `State` does.
  States(std::size_t missions, std::size_t robots, std::size_t beams);

  /// Returns a state whose numbers are still to be written.
  std::shared_ptr<State> Next();

 private:
  std::size_t missions_, robots_, beams_;
  std::vector<std::shared_ptr<State>> kept_;
};

}  // namespace robotteamsim::state

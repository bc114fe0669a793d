#include "robotteamsim/state/states.hpp"

namespace robotteamsim::state {
namespace {

// Two are in use while a step is made of the one before, and one by somebody who looks at the last record.
constexpr std::size_t kMostKept = 3;

}  // namespace

States::States(std::size_t missions, std::size_t robots, std::size_t beams)
    : missions_(missions), robots_(robots), beams_(beams), kept_{std::make_shared<State>(missions, robots, beams)} {}

std::shared_ptr<State> States::Next() {
  for (const std::shared_ptr<State>& state : kept_) {
    if (state.use_count() == 1) return state;
  }
  auto state = std::make_shared<State>(missions_, robots_, beams_);
  if (kept_.size() < kMostKept) kept_.push_back(state);
  return state;
}

}  // namespace robotteamsim::state

// The last velocity command of a robot; it holds for some time, then the robot stops.
#pragma once

#include <cmath>
#include <cstdint>

#include "planar.hpp"

namespace robotteamsim::gazebo_plugins {

class HeldCommand {
 public:
  explicit HeldCommand(double hold_s) : hold_ns_(std::llround(hold_s * 1e9)) {}

  // Returns false if the command is not finite and therefore ignored.
  bool Put(const PlanarTwist& command, std::int64_t now_ns) {
    if (!std::isfinite(command.forward_mps + command.left_mps + command.turn_radps)) return false;
    command_ = command;
    until_ns_ = now_ns + hold_ns_;
    return true;
  }

  PlanarTwist At(std::int64_t now_ns) const { return now_ns < until_ns_ ? command_ : PlanarTwist{}; }

  void Clear() { until_ns_ = 0; }

 private:
  std::int64_t hold_ns_;
  std::int64_t until_ns_ = 0;
  PlanarTwist command_;
};

}  // namespace robotteamsim::gazebo_plugins

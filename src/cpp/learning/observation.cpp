#include "robotteamsim/learning/observation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::learning {
namespace {

/// What the numbers of a robot say of places.
struct Viewpoint {
  const double* pose;  // x, y, qz, qw

  double cos() const { return 1.0 - 2.0 * pose[2] * pose[2]; }
  double sin() const { return 2.0 * pose[2] * pose[3]; }

  /// Returns how far a place in `map` is ahead and to the left.
  base::Point Seen(const double* place_m) const {
    const double x = place_m[0] - pose[0], y = place_m[1] - pose[1];
    return {cos() * x + sin() * y, cos() * y - sin() * x};
  }
};

/// Writes numbers one after the other.
class Vector {
 public:
  explicit Vector(float* next) : next_(next), begin_(next) {}

  void Add(float number) {
    if (std::isnan(number)) {
      throw std::invalid_argument("number " + std::to_string(next_ - begin_) + " of its vector is NaN");
    }
    *next_++ = std::clamp(number, -1.0F, 1.0F);
  }
  void Add(double number) { Add(static_cast<float>(number)); }
  void Add(const base::Point& place, double factor) {
    Add(place.x * factor);
    Add(place.y * factor);
  }

 private:
  float *next_, *begin_;
};

void CheckUnits(const Units& units) {
  for (const float range_m : units.range_max_m) base::CheckPositive(range_m, "range_max_m");
  for (const double speed_mps : units.max_speed_mps) base::CheckPositive(speed_mps, "max_speed_mps");
  for (const double turn_radps : units.max_turn_radps) base::CheckPositive(turn_radps, "max_turn_radps");
  base::Check(units.low_m, "low_m");
  base::CheckPositive(units.extent_m.x, "extent_m");
  base::CheckPositive(units.extent_m.y, "extent_m");
  base::CheckPositive(units.diagonal_m, "diagonal_m");
  base::CheckPositive(units.voice_radius_m, "voice_radius_m");
}

void CheckTables(const Units& units, const Percepts& percepts, const base::Table<float>& vectors) {
  const std::size_t agents = units.range_max_m.size(), rows = percepts.poses.rows;
  const bool fit = agents > 0 && units.max_speed_mps.size() == agents && units.max_turn_radps.size() == agents &&
                   rows % agents == 0 && percepts.ranges_m.rows == rows && percepts.poses.cols == 4 &&
                   percepts.twists.HasShape(rows, 3) && percepts.voices.HasShape(rows, 4) &&
                   percepts.areas.HasShape(rows / agents, 3) && percepts.heard.rows == rows &&
                   percepts.heard.cols % (4 + percepts.said) == 0 && percepts.remembered.rows == rows &&
                   vectors.HasShape(rows, percepts.VectorSize());
  if (!fit) throw std::invalid_argument("the parts of percepts do not have the shapes of the same agents");
}

}  // namespace

void WriteVectors(const Units& units, const propagation::FaceSet& faces, const propagation::RadioModel& radio,
                  const Percepts& percepts, const base::Table<float>& vectors) {
  CheckUnits(units);
  CheckTables(units, percepts, vectors);
  const std::size_t agents = units.range_max_m.size(), each = 4 + percepts.said;
  for (std::size_t row = 0; row < vectors.rows; ++row) {
    try {
      const std::size_t agent = row % agents;
      const Viewpoint from{percepts.poses.Row(row)};
      const double *const pose = from.pose, *const twist = percepts.twists.Row(row);
      const double *const voice = percepts.voices.Row(row), *const area = percepts.areas.Row(row / agents);
      Vector vector(vectors.Row(row));
      for (std::size_t beam = 0; beam < percepts.ranges_m.cols; ++beam) {
        vector.Add(percepts.ranges_m.Row(row)[beam] / units.range_max_m[agent]);
      }
      vector.Add(2.0 * (pose[0] - units.low_m.x) / units.extent_m.x - 1.0);
      vector.Add(2.0 * (pose[1] - units.low_m.y) / units.extent_m.y - 1.0);
      vector.Add(from.cos());
      vector.Add(from.sin());
      vector.Add(twist[0] / units.max_speed_mps[agent]);
      vector.Add(twist[2] / units.max_turn_radps[agent]);
      vector.Add(voice[0]);
      vector.Add(voice[1] / kLoudestDb);
      vector.Add(from.Seen(voice + 2), voice[0] / units.voice_radius_m);
      vector.Add(area[0]);
      vector.Add(from.Seen(area + 1), area[0] / units.diagonal_m);
      for (const double* heard = percepts.heard.Row(row); heard != percepts.heard.Row(row + 1); heard += each) {
        double signal = 0.0;
        if (heard[0] != 0.0) {
          const auto here = propagation::RoundToMm({pose[0], pose[1]}, "position of an agent");
          const auto there = propagation::RoundToMm({heard[1], heard[2]}, "position of a teammate");
          const double signal_dbm = radio.tx_power_dbm - propagation::PathLossDb(faces, radio, here, there);
          signal = std::max((signal_dbm - kWeakestDbm) / (kStrongestDbm - kWeakestDbm), 0.0);
        }
        vector.Add(heard[0]);
        vector.Add(from.Seen(heard + 1), heard[0] / units.diagonal_m);
        vector.Add(heard[0] * signal);
        vector.Add(heard[0] * heard[3] / kOldestS);
        for (std::size_t k = 4; k < each; ++k) vector.Add(heard[k]);
      }
      for (std::size_t k = 0; k < percepts.remembered.cols; ++k) vector.Add(percepts.remembered.Row(row)[k]);
    } catch (const std::invalid_argument& problem) {
      throw std::invalid_argument("agent " + std::to_string(row % agents) + ": " + problem.what());
    }
  }
}

}  // namespace robotteamsim::learning

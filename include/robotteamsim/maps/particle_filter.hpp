#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/base/table.hpp"
#include "robotteamsim/maps/beam_model.hpp"
#include "robotteamsim/sensing/odometry.hpp"
#include "robotteamsim/state/state.hpp"

namespace robotteamsim::maps {

/// How a particle filter weighs scans.
struct ScanWeighing {
  double sigma_m = 0.1;    ///< standard deviation of a range: noise, cells, and what the map leaves out
  double outliers = 0.05;  ///< likelihood of a range that does not fit, relative to one that fits
  /// Exponent of a scan's likelihood. Beams of a scan are not independent: what is wrong with the map shifts many.
  double power = 0.3;
};

/// Particles for the pose of one robot in a map: Monte Carlo localisation [thrun2005, Table 8.2].
///
/// All random numbers come from the caller, so equal calls have equal results. Poses are those of base_link in `map`.
class ParticleFilter {
 public:
  /// The weighted mean of the particles, and their covariance about it.
  struct Estimate {
    base::Pose pose;
    state::PoseCovariance covariance;
  };

  /// Places a particle for each row of `noise`, three standard normal numbers, around `mean`.
  /// Args: spread: standard deviations of x, y [m] and yaw [rad].
  /// Throws std::invalid_argument if there is no row or they have another length, or a number is not usable, or
  /// negative where it must not be, or `outliers` is not between 0 and 1.
  ParticleFilter(std::shared_ptr<const BeamModel> beams, const ScanWeighing& weighing, const base::Pose& mean,
                 const base::Pose& spread, const base::Table<const double>& noise);

  /// Moves each particle by one step of odometry with errors of its own.
  /// Args: noise: three standard normal numbers for each particle, see `OdometryNoise`.
  /// Throws std::invalid_argument if it has another shape, or a number in it is not usable.
  void Move(const sensing::ModelledMotion& motion, const base::Table<const double>& noise);

  /// Shifts all particles in `map` [m], such as when a lift has taken the robot to another level.
  void Shift(const base::Point& by);

  /// Multiplies the weight of each particle by the likelihood of a scan, to the power of `ScanWeighing`.
  void Weigh(const std::vector<Beam>& scan);

  /// Draws particles again by their weights, if these have become too different: if fewer than half of the particles
  /// count, by the effective sample size. Systematic resampling [thrun2005, Table 4.4].
  /// Args: draw: a random number from 0 to below 1.
  void Resample(double draw);

  /// Some of the particles, drawn by their weights: each stands for the same share. Systematic resampling.
  /// Args: draw: as for `Resample`.
  /// Throws std::invalid_argument if there are fewer particles than `count`, or the draw is not usable.
  std::vector<base::Pose> Drawn(std::size_t count, double draw) const;

  Estimate Mean() const;

  const BeamModel& beams() const { return *beams_; }
  const std::vector<base::Pose>& particles() const { return particles_; }
  /// The weights of the particles, whose sum is 1.
  const std::vector<double>& weights() const { return weights_; }

 private:
  std::shared_ptr<const BeamModel> beams_;
  ScanWeighing weighing_;
  std::vector<base::Pose> particles_;
  std::vector<double> weights_;
};

}  // namespace robotteamsim::maps

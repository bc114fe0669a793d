#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/maps/distance_field.hpp"
#include "robotteamsim/world/fan_caster.hpp"

namespace robotteamsim::maps {

/// One beam of a scan, and the range that it measured, within the limits of the laser [m].
struct Beam {
  int index;
  double range_m;
};

/// How well a scan fits a map at a pose: measured ranges compared with those that beams have in the map.
///
/// A beam without a return counts as one of the longest range, on both sides: so it is evidence of free space.
class BeamModel {
 public:
  /// Beams that a scan has in common with a map: how many hit something in the scan or in the map, and how many of
  /// these contradict the map.
  struct Agreement {
    int informative = 0;
    int contradicting = 0;
  };

  /// How far a pose may be wrong before a beam contradicts the map.
  struct Tolerance {
    double range_m;
    double angle_rad;
  };

  /// Args: range_min_m: shortest range that the laser measures; all ranges are limited to it and to the fan's longest.
  /// Throws std::invalid_argument if there are no beams, or the limits are not 0 <= shortest < longest.
  BeamModel(std::shared_ptr<const DistanceField> field, const world::Fan& fan, double range_min_m);

  const DistanceField& field() const { return *field_; }
  const world::Fan& fan() const { return fan_; }

  /// Returns some beams of a scan; those that measured NaN are left out.
  /// Args: ranges_m: of all `size` beams, as the laser reports them; infinite ones allowed.
  /// Throws std::invalid_argument if there are not as many as beams, or an index is not that of a beam.
  std::vector<Beam> BeamsOf(const float* ranges_m, std::size_t size, const std::vector<int>& indices) const;

  /// Returns the logarithm of the likelihood of beams at a pose, each of which has the density
  ///
  ///     (1 - outliers) exp(-(measured - expected)^2 / (2 sigma^2)) + outliers
  ///
  /// up to a factor: the beam model [thrun2005, Table 6.1] with one uniform part for all that is not in the map.
  double LogLikelihood(const base::Pose& robot, const std::vector<Beam>& beams, double sigma_m, double outliers) const;

  /// Returns how many beams contradict the map: those whose range lies outside all that a pose within the tolerance
  /// would measure.
  Agreement AgreementOf(const base::Pose& robot, const std::vector<Beam>& beams, const Tolerance& tolerance) const;

 private:
  double Limited(double range_m) const;

  std::shared_ptr<const DistanceField> field_;
  world::Fan fan_;
  double range_min_m_;
  std::vector<base::Point> directions_;  ///< of the beams, in base_link
};

}  // namespace robotteamsim::maps

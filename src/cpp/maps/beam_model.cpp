#include "robotteamsim/maps/beam_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::maps {
namespace {

/// Farther apart, in standard deviations, the Gaussian part of the likelihood counts as 0.
constexpr double kGaussianReach = 6.0;

constexpr int kMostBeams = 1'000'000;

base::Point Rotated(const base::Point& direction, double cos, double sin) {
  return {cos * direction.x - sin * direction.y, sin * direction.x + cos * direction.y};
}

}  // namespace

BeamModel::BeamModel(std::shared_ptr<const DistanceField> field, const world::Fan& fan, double range_min_m)
    : field_(std::move(field)), fan_(fan), range_min_m_(range_min_m) {
  if (field_ == nullptr) throw std::invalid_argument("a beam model needs a distance field");
  if (fan.beams < 1 || fan.beams > kMostBeams) throw std::invalid_argument("a laser has from one to a million beams");
  base::Check({fan.angle_min_rad, fan.angle_max_rad, 0.0}, "the angles of a laser");
  base::Check(base::Point{fan.forward_m, fan.left_m}, "the place of a laser");
  base::CheckPositive(fan.range_max_m, "range_max_m");
  base::CheckNotNegative(range_min_m, "range_min_m");
  if (range_min_m >= fan.range_max_m) throw std::invalid_argument("range_min_m must be below range_max_m");
  directions_.reserve(static_cast<std::size_t>(fan.beams));
  for (int i = 0; i < fan.beams; ++i) {
    const double angle = fan.angle_min_rad + (fan.angle_max_rad - fan.angle_min_rad) * i / std::max(fan.beams - 1, 1);
    directions_.push_back({std::cos(angle), std::sin(angle)});
  }
}

double BeamModel::Limited(double range_m) const { return std::clamp(range_m, range_min_m_, fan_.range_max_m); }

std::vector<Beam> BeamModel::BeamsOf(const float* ranges_m, std::size_t size, const std::vector<int>& indices) const {
  if (size != directions_.size()) throw std::invalid_argument("expected one range for each beam of the laser");
  std::vector<Beam> beams;
  beams.reserve(indices.size());
  for (const int index : indices) {
    if (index < 0 || index >= fan_.beams) throw std::invalid_argument("no such beam");
    if (!std::isnan(ranges_m[index])) beams.push_back({index, Limited(ranges_m[index])});
  }
  return beams;
}

double BeamModel::LogLikelihood(const base::Pose& robot, const std::vector<Beam>& beams, double sigma_m,
                                double outliers) const {
  base::Check(robot, "the pose");
  base::CheckPositive(sigma_m, "sigma_m");
  if (!(outliers > 0.0 && outliers < 1.0)) throw std::invalid_argument("outliers must be between 0 and 1");
  const double cos = std::cos(robot.yaw), sin = std::sin(robot.yaw);
  const base::Point origin = fan_.Origin(robot);
  double log_likelihood = 0.0, product = 1.0;
  for (const Beam& beam : beams) {
    const base::Point direction = Rotated(directions_[beam.index], cos, sin);
    // No farther than where the Gaussian part ends: beyond, the likelihood is the same.
    const double reach = std::min(fan_.range_max_m, beam.range_m + kGaussianReach * sigma_m);
    const double expected = std::max(range_min_m_, std::min(reach, field_->Trace(origin, direction, reach)));
    const double deviation = (beam.range_m - expected) / sigma_m;
    const double gaussian = std::abs(deviation) < kGaussianReach ? std::exp(-0.5 * deviation * deviation) : 0.0;
    product *= (1.0 - outliers) * gaussian + outliers;
    if (product < 1e-200) {
      log_likelihood += std::log(product);
      product = 1.0;
    }
  }
  return log_likelihood + std::log(product);
}

BeamModel::Agreement BeamModel::AgreementOf(const base::Pose& robot, const std::vector<Beam>& beams,
                                            const Tolerance& tolerance) const {
  base::Check(robot, "the pose");
  base::CheckNotNegative(tolerance.range_m, "a tolerance");
  base::CheckNotNegative(tolerance.angle_rad, "a tolerance");
  const base::Point origin = fan_.Origin(robot);
  Agreement agreement;
  for (const Beam& beam : beams) {
    double least = fan_.range_max_m, most = 0.0;
    for (const double turn : {-tolerance.angle_rad, 0.0, tolerance.angle_rad}) {
      const double yaw = robot.yaw + turn;
      const base::Point direction = Rotated(directions_[beam.index], std::cos(yaw), std::sin(yaw));
      const double expected = Limited(field_->Trace(origin, direction, fan_.range_max_m));
      least = std::min(least, expected);
      most = std::max(most, expected);
    }
    if (std::min(least, beam.range_m) >= fan_.range_max_m) continue;
    ++agreement.informative;
    const bool fits = beam.range_m >= least - tolerance.range_m && beam.range_m <= most + tolerance.range_m;
    if (!fits) ++agreement.contradicting;
  }
  return agreement;
}

}  // namespace robotteamsim::maps

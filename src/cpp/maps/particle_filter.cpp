#include "robotteamsim/maps/particle_filter.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::maps {
namespace {

void CheckNoise(const base::Table<const double>& noise, std::size_t particles) {
  if (!noise.HasShape(particles, 3) || particles == 0) {
    throw std::invalid_argument("expected three random numbers for each particle");
  }
  for (std::size_t i = 0; i < particles; ++i)
    base::Check({noise.Row(i)[0], noise.Row(i)[1], noise.Row(i)[2]}, "a random number");
}

void CheckDraw(double draw) {
  if (!(draw >= 0.0 && draw < 1.0)) throw std::invalid_argument("the draw must be from 0 to below 1");
}

}  // namespace

ParticleFilter::ParticleFilter(std::shared_ptr<const BeamModel> beams, const ScanWeighing& weighing,
                               const base::Pose& mean, const base::Pose& spread, const base::Table<const double>& noise)
    : beams_(std::move(beams)), weighing_(weighing) {
  if (beams_ == nullptr) throw std::invalid_argument("particles need a beam model");
  if (noise.rows == 0) throw std::invalid_argument("there must be a particle");
  base::CheckPositive(weighing.sigma_m, "sigma_m");
  base::CheckPositive(weighing.power, "power");
  if (!(weighing.outliers > 0.0 && weighing.outliers < 1.0)) {
    throw std::invalid_argument("outliers must be between 0 and 1");
  }
  base::Check(mean, "the mean");
  base::CheckNotNegative(spread.x, "a standard deviation");
  base::CheckNotNegative(spread.y, "a standard deviation");
  base::CheckNotNegative(spread.yaw, "a standard deviation");
  CheckNoise(noise, noise.rows);
  for (std::size_t i = 0; i < noise.rows; ++i) {
    particles_.push_back({mean.x + spread.x * noise.Row(i)[0], mean.y + spread.y * noise.Row(i)[1],
                          base::NormaliseAngle(mean.yaw + spread.yaw * noise.Row(i)[2])});
  }
  weights_.assign(particles_.size(), 1.0 / static_cast<double>(particles_.size()));
}

void ParticleFilter::Move(const sensing::ModelledMotion& motion, const base::Table<const double>& noise) {
  CheckNoise(noise, particles_.size());
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const sensing::OdometryNoise errors = motion.ErrorsOf({noise.Row(i)[0], noise.Row(i)[1], noise.Row(i)[2]});
    particles_[i] = motion.From(particles_[i], errors).pose;
  }
}

void ParticleFilter::Shift(const base::Point& by) {
  base::Check(by, "the shift");
  for (base::Pose& particle : particles_) particle = {particle.x + by.x, particle.y + by.y, particle.yaw};
}

void ParticleFilter::Weigh(const std::vector<Beam>& scan) {
  std::vector<double> logs(particles_.size());
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    // Weights are above 0, or at least 1e-300 after rounding: the logarithm is finite.
    logs[i] = std::log(std::max(weights_[i], 1e-300)) +
              weighing_.power * beams_->LogLikelihood(particles_[i], scan, weighing_.sigma_m, weighing_.outliers);
  }
  // Relative to the best one, whose weight is 1: the sum cannot be 0.
  const double best = *std::max_element(logs.begin(), logs.end());
  double sum = 0.0;
  for (std::size_t i = 0; i < logs.size(); ++i) sum += weights_[i] = std::exp(logs[i] - best);
  for (double& weight : weights_) weight /= sum;
}

void ParticleFilter::Resample(double draw) {
  CheckDraw(draw);
  double squares = 0.0;
  for (const double weight : weights_) squares += weight * weight;
  const auto count = static_cast<double>(particles_.size());
  if (1.0 / squares >= 0.5 * count) return;
  particles_ = Drawn(particles_.size(), draw);
  weights_.assign(particles_.size(), 1.0 / count);
}

std::vector<base::Pose> ParticleFilter::Drawn(std::size_t count, double draw) const {
  CheckDraw(draw);
  if (count > particles_.size()) throw std::invalid_argument("there are fewer particles than are to be drawn");
  std::vector<base::Pose> drawn;
  drawn.reserve(count);
  double reached = weights_[0];
  std::size_t from = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double at = (static_cast<double>(i) + draw) / static_cast<double>(count);
    // The sum of all weights may be rounded to below 1.
    while (reached <= at && from + 1 < particles_.size()) reached += weights_[++from];
    drawn.push_back(particles_[from]);
  }
  return drawn;
}

ParticleFilter::Estimate ParticleFilter::Mean() const {
  base::Pose mean;
  double cos = 0.0, sin = 0.0;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    mean.x += weights_[i] * particles_[i].x;
    mean.y += weights_[i] * particles_[i].y;
    cos += weights_[i] * std::cos(particles_[i].yaw);
    sin += weights_[i] * std::sin(particles_[i].yaw);
  }
  mean.yaw = std::atan2(sin, cos);
  state::PoseCovariance covariance;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const double weight = weights_[i], x = particles_[i].x - mean.x, y = particles_[i].y - mean.y;
    const double yaw = base::NormaliseAngle(particles_[i].yaw - mean.yaw);
    covariance.xx += weight * x * x;
    covariance.xy += weight * x * y;
    covariance.x_yaw += weight * x * yaw;
    covariance.yy += weight * y * y;
    covariance.y_yaw += weight * y * yaw;
    covariance.yaw_yaw += weight * yaw * yaw;
  }
  return {mean, covariance};
}

}  // namespace robotteamsim::maps

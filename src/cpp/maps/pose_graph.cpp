#include "robotteamsim/maps/pose_graph.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::maps {
namespace {

constexpr int kMostSteps = 20;
constexpr double kSmallGain = 1e-6;  // of the error, relative: no further step is made
// Holds poses that no measurement holds [1/m^2, 1/rad^2]: without effect on others.
constexpr double kHold = 1e-6;

/// How far the poses are from a measurement: x and y in the frame of `from`, and yaw.
Eigen::Vector3d ErrorOf(const PoseGraph::Edge& edge, const base::Pose& from, const base::Pose& to) {
  const base::Pose motion = base::RelativePose(from, to);
  return {motion.x - edge.motion.x, motion.y - edge.motion.y, base::NormaliseAngle(motion.yaw - edge.motion.yaw)};
}

double Sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

}  // namespace

std::size_t PoseGraph::Add(const base::Pose& pose) {
  base::Check(pose, "pose");
  poses_.push_back(pose);
  return poses_.size() - 1;
}

void PoseGraph::Connect(const Edge& edge) {
  base::Check(edge.motion, "motion");
  if (edge.from >= poses_.size() || edge.to >= poses_.size() || edge.from == edge.to) {
    throw std::invalid_argument("a measurement must be between two poses of the graph");
  }
  if (!edge.information.allFinite()) throw std::invalid_argument("the information of a measurement must be finite");
  edges_.push_back(edge);
}

std::vector<double> PoseGraph::ErrorsAt(const std::vector<base::Pose>& poses) const {
  std::vector<double> errors;
  for (const Edge& edge : edges_) {
    const Eigen::Vector3d error = ErrorOf(edge, poses[edge.from], poses[edge.to]);
    errors.push_back(error.dot(edge.information * error));
  }
  return errors;
}

/// The poses after a step of Gauss and Newton.
std::vector<base::Pose> PoseGraph::Improved() const {
  const auto size = static_cast<Eigen::Index>(3 * poses_.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
  const auto add = [&](std::size_t row, std::size_t col, const Eigen::Matrix3d& block) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        entries.emplace_back(static_cast<int>(3 * row) + i, static_cast<int>(3 * col) + j, block(i, j));
      }
    }
  };
  for (const Edge& edge : edges_) {
    const base::Pose &from = poses_[edge.from], &to = poses_[edge.to];
    const double cos = std::cos(from.yaw), sin = std::sin(from.yaw), dx = to.x - from.x, dy = to.y - from.y;
    Eigen::Matrix3d by_from, by_to;
    by_from << -cos, -sin, cos * dy - sin * dx, sin, -cos, -cos * dx - sin * dy, 0.0, 0.0, -1.0;
    by_to << cos, sin, 0.0, -sin, cos, 0.0, 0.0, 0.0, 1.0;
    const Eigen::Vector3d pull = edge.information * ErrorOf(edge, from, to);
    gradient.segment<3>(static_cast<Eigen::Index>(3 * edge.from)) += by_from.transpose() * pull;
    gradient.segment<3>(static_cast<Eigen::Index>(3 * edge.to)) += by_to.transpose() * pull;
    add(edge.from, edge.from, by_from.transpose() * edge.information * by_from);
    add(edge.from, edge.to, by_from.transpose() * edge.information * by_to);
    add(edge.to, edge.from, by_to.transpose() * edge.information * by_from);
    add(edge.to, edge.to, by_to.transpose() * edge.information * by_to);
  }
  // The first pose stays: what it would change is no equation, and the others know where it is.
  for (Eigen::Triplet<double>& entry : entries) {
    if (entry.row() < 3 || entry.col() < 3) entry = {entry.row(), entry.col(), 0.0};
  }
  for (Eigen::Index i = 0; i < size; ++i) {
    entries.emplace_back(static_cast<int>(i), static_cast<int>(i), i < 3 ? 1.0 : kHold);
  }
  gradient.head<3>().setZero();
  Eigen::SparseMatrix<double> hessian(size, size);
  hessian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd change = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(hessian).solve(-gradient);
  std::vector<base::Pose> improved = poses_;
  for (std::size_t i = 0; i < improved.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    base::Pose& pose = improved[i];
    pose = {pose.x + change[at], pose.y + change[at + 1], base::NormaliseAngle(pose.yaw + change[at + 2])};
  }
  return improved;
}

void PoseGraph::Optimise() {
  double error = Sum(Errors());
  for (int step = 0; step < kMostSteps && !poses_.empty(); ++step) {
    std::vector<base::Pose> improved = Improved();
    const double new_error = Sum(ErrorsAt(improved));
    if (!(new_error < error)) return;  // also if it is not a number
    const bool is_last = error - new_error <= kSmallGain * error;
    poses_ = std::move(improved);
    error = new_error;
    if (is_last) return;
  }
}

}  // namespace robotteamsim::maps

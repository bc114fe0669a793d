#include "robotteamsim/state/state.hpp"

#include <limits>
#include <stdexcept>

#include "robotteamsim/base/large_pages.hpp"

namespace robotteamsim::state {
namespace {

constexpr double kMostNumbers = 1e8;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

template <typename Value>
void Allocate(std::size_t size, std::vector<Value>* numbers) {
  numbers->reserve(size);
  base::AskForLargePages(numbers->data(), size * sizeof(Value));  // before the first write
  numbers->resize(size);
}

}  // namespace

State::State(std::size_t of_missions, std::size_t of_robots, std::size_t of_beams)
    : missions(of_missions), robots(of_robots), beams(of_beams) {
  if (missions < 1) throw std::invalid_argument("there must be a mission");
  const double widest = static_cast<double>(robots) + static_cast<double>(beams) + 30.0;
  if (static_cast<double>(missions) * (static_cast<double>(robots) + 1.0) * widest > kMostNumbers) {
    throw std::invalid_argument("a state must not have more than 1e8 numbers");
  }
  const std::size_t rows = missions * robots;
  true_pose.assign(rows, {kNaN, kNaN, kNaN, kNaN});
  positions.assign(rows, {kNaN, kNaN});
  true_twist.resize(rows);
  contact.resize(rows);
  contact_angles.resize(rows);
  odometry_pose.resize(rows);
  odometry_twist.resize(rows);
  odometry_pose_covariance.resize(rows);
  odometry_twist_variances.resize(rows);
  ranges_m.assign(rows * beams, std::numeric_limits<float>::infinity());
  beams_of.assign(rows, beams);
  voice_level_db.resize(rows);
  voice_heard.resize(rows);
  local_best.resize(rows);
  local_best_level_db.resize(rows);
  fiedler_value.resize(missions);
  links_version.assign(missions, -1);
  links_source.resize(missions);
  happened.resize(missions);
}

void State::NeedLinks(bool with_link) {
  const std::size_t cells = Matrix(missions);
  if (with_link) Allocate(cells, &link);
  if (rssi_dbm.size() == cells) return;
  Allocate(cells, &rssi_dbm);
  Allocate(cells, &adjacency);
  Allocate(cells, &endangered);
  Allocate(cells, &hop_count);
}

void State::Place(std::size_t row, const base::Pose& pose) {
  true_pose[row] = ReadingOf(pose);
  positions[row] = {true_pose[row].x, true_pose[row].y};
}

}  // namespace robotteamsim::state

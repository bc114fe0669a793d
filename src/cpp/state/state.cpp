#include "robotteamsim/state/state.hpp"

#include <cstddef>
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

State State::Of(std::size_t mission) const {
  if (mission >= missions) throw std::out_of_range("no such mission");
  State one(1, robots, beams);
  const auto take = [mission](const auto& from, std::size_t each, auto* to) {
    if (from.empty()) return;  // matrices that nobody asked for
    const auto begin = from.begin() + static_cast<std::ptrdiff_t>(mission * each);
    to->assign(begin, begin + static_cast<std::ptrdiff_t>(each));
  };
  take(true_pose, robots, &one.true_pose);
  take(true_twist, robots, &one.true_twist);
  take(contact, robots, &one.contact);
  take(contact_angles, robots, &one.contact_angles);
  take(odometry_pose, robots, &one.odometry_pose);
  take(odometry_twist, robots, &one.odometry_twist);
  take(odometry_pose_covariance, robots, &one.odometry_pose_covariance);
  take(odometry_twist_variances, robots, &one.odometry_twist_variances);
  take(ranges_m, robots * beams, &one.ranges_m);
  take(beams_of, robots, &one.beams_of);
  take(voice_level_db, robots, &one.voice_level_db);
  take(voice_heard, robots, &one.voice_heard);
  take(local_best, robots, &one.local_best);
  take(local_best_level_db, robots, &one.local_best_level_db);
  take(rssi_dbm, robots * robots, &one.rssi_dbm);
  take(link, robots * robots, &one.link);
  take(adjacency, robots * robots, &one.adjacency);
  take(endangered, robots * robots, &one.endangered);
  take(hop_count, robots * robots, &one.hop_count);
  take(fiedler_value, 1, &one.fiedler_value);
  take(links_version, 1, &one.links_version);
  take(links_source, 1, &one.links_source);
  take(happened, 1, &one.happened);
  return one;
}

std::vector<base::Point> State::Positions(std::size_t mission) const {
  std::vector<base::Point> positions(robots);
  for (std::size_t i = 0; i < robots; ++i) {
    const PoseReading& pose = true_pose[First(mission) + i];
    positions[i] = {pose.x, pose.y};
  }
  return positions;
}

}  // namespace robotteamsim::state

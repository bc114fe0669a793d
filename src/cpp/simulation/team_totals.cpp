#include "robotteamsim/simulation/team_totals.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/base/hypot.hpp"

namespace robotteamsim::simulation {
namespace {

constexpr double kStayRadius = 0.5;  // [m]; part of the definition of `longest_stay`

constexpr int kMostRobots = 1'000'000;

std::size_t Checked(int num_robots) {
  if (num_robots < 0 || num_robots > kMostRobots) {
    throw std::invalid_argument("num_robots must be from 0 to " + std::to_string(kMostRobots));
  }
  return static_cast<std::size_t>(num_robots);
}

}  // namespace

TeamTotals::TeamTotals(int num_robots) : logs_(Checked(num_robots)) {}

void TeamTotals::Add(int robot, const base::Point& at, bool in_contact, bool is_excluded, bool is_running) {
  Log& log = logs_[robot];
  if (!std::isnan(at.x)) base::Check(at, "a position");
  const base::Point before = log.last;
  log.last = at;
  if (std::isnan(at.x)) return;
  const bool has_come = std::isnan(before.x);
  if (!has_come) log.sums.distance += Distance(at, before);
  if (has_come || Distance(at, log.anchor) > kStayRadius) {
    log.anchor = at;
    log.stay = 0;
  }
  if (is_running) log.sums.longest_stay = std::max(log.sums.longest_stay, ++log.stay);
  log.sums.contact_steps += in_contact;
  log.sums.excluded_steps += is_excluded;
}

}  // namespace robotteamsim::simulation

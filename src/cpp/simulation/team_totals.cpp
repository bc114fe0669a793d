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

TeamTotals::TeamTotals(int num_robots, double longest_step_m)
    : logs_(Checked(num_robots)), longest_step_m_(longest_step_m) {}

void TeamTotals::AddStep(const std::vector<base::Point>& positions, const std::vector<bool>& in_contact,
                         const std::vector<bool>& excluded, bool running) {
  const std::size_t robots = logs_.size();
  if (positions.size() != robots || in_contact.size() != robots || excluded.size() != robots) {
    throw std::invalid_argument("positions and flags must have one row per robot");
  }
  for (std::size_t i = 0; i < robots; ++i) Add(positions[i], in_contact[i], excluded[i], running, &logs_[i]);
}

void TeamTotals::Add(const base::Point& at, bool in_contact, bool is_excluded, bool is_running, Log* log) {
  if (!std::isnan(at.x)) base::Check(at, "a position");
  const base::Point before = log->last;
  log->last = at;
  if (std::isnan(at.x)) return;
  const bool has_come = std::isnan(before.x);
  const double step_m = has_come ? 0.0 : Distance(at, before);
  if (step_m <= longest_step_m_) log->sums.distance_m += step_m;
  if (has_come || Distance(at, log->anchor) > kStayRadius) {
    log->anchor = at;
    log->stay = 0;
  }
  if (is_running) log->sums.longest_stay = std::max(log->sums.longest_stay, ++log->stay);
  log->sums.contact_steps += in_contact;
  log->sums.excluded_steps += is_excluded;
}

std::vector<RobotTotals> TeamTotals::Totals() const {
  std::vector<RobotTotals> totals;
  totals.reserve(logs_.size());
  for (const Log& log : logs_) totals.push_back(log.sums);
  return totals;
}

}  // namespace robotteamsim::simulation

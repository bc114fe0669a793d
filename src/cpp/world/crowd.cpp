#include "robotteamsim/world/crowd.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/base/hypot.hpp"

namespace robotteamsim::world {
namespace {

// Walls beyond this distance from the body have no effect, for any range in the scenario's limits [m].
constexpr double kWallReach = 2.0;

// Nearer than this to the target, a walker has arrived; two bodies this close have no direction between them [m].
constexpr double kSamePosition = 1e-9;

// In a corner two walls limit a step; each pass corrects for one.
constexpr int kWallPasses = 3;

constexpr double kMostCrowdSubsteps = 1e5;

// Bodies that overlap far more than their range push with this power of e, so that sums stay finite.
constexpr double kStrongest = 50.0;

base::Point Minus(const base::Point& a, const base::Point& b) { return {a.x - b.x, a.y - b.y}; }
double Dot(const base::Point& a, const base::Point& b) { return a.x * b.x + a.y * b.y; }

// Returns how strongly something at a distance pushes; `contact` is the distance at which bodies touch [m].
double Push(double strength, double contact, double distance, double range) {
  return strength * std::exp(std::min((contact - distance) / range, kStrongest));
}

base::Point NearestOn(const base::Segment& segment, const base::Point& point) {
  const base::Point along = Minus(segment.b, segment.a);
  const double length2 = Dot(along, along);
  const double share = length2 > 0.0 ? std::clamp(Dot(Minus(point, segment.a), along) / length2, 0.0, 1.0) : 0.0;
  return {segment.a.x + share * along.x, segment.a.y + share * along.y};
}

// Edges have the solid to their left: whoever is to the left of the nearest one is inside, by rounding or by a door.
bool IsInside(const base::Segment& wall, const base::Point& point) {
  const base::Point along = Minus(wall.b, wall.a), to = Minus(point, wall.a);
  return along.x * to.y - along.y * to.x > 0.0;
}

void CheckWalkers(const std::vector<Walker>& walkers, const std::vector<Bystander>& others) {
  for (const Walker& walker : walkers) {
    base::Check(walker.position, "the position of a walker");
    base::Check(walker.target, "the target of a walker");
    base::CheckNotNegative(walker.speed_mps, "the speed of a walker");
    base::CheckPositive(walker.radius_m, "the radius of a walker");
    if (walker.radius_m > kWallReach) throw std::invalid_argument("the radius of a walker must be at most 2 m");
  }
  for (const Bystander& other : others) {
    base::Check(other.position, "the position of a bystander");
    base::CheckPositive(other.radius_m, "the radius of a bystander");
  }
}

CrowdParameters CheckedParameters(const CrowdParameters& parameters) {
  base::CheckPositive(parameters.time_gap_s, "time_gap_s");
  base::CheckNotNegative(parameters.neighbour_strength, "neighbour_strength");
  base::CheckPositive(parameters.neighbour_range_m, "neighbour_range_m");
  base::CheckNotNegative(parameters.wall_strength, "wall_strength");
  base::CheckPositive(parameters.wall_range_m, "wall_range_m");
  base::CheckPositive(parameters.longest_substep_s, "longest_substep_s");
  return parameters;
}

std::vector<Door> AsInstant(std::vector<Door> doors) {
  for (Door& door : doors) door.motion = {};
  return doors;
}

// The repulsion of neighbours and walls, and the gap to the nearest one ahead.
class Surroundings {
 public:
  Surroundings(const Walker& walker, const CrowdParameters& parameters) : walker_(walker), parameters_(parameters) {}

  void Add(const base::Point& other, double radius_m) {
    const base::Point away = Minus(walker_.position, other);
    const double distance = base::Hypot(away.x, away.y);
    if (distance < kSamePosition) return;
    const double contact = walker_.radius_m + radius_m;
    const double weight =
        Push(parameters_.neighbour_strength, contact, distance, parameters_.neighbour_range_m) / distance;
    push_.x += weight * away.x;
    push_.y += weight * away.y;
    neighbours_.push_back({{-away.x, -away.y}, contact});
  }

  void AddWall(const base::Segment& wall) {
    const base::Point away = Minus(walker_.position, NearestOn(wall, walker_.position));
    const double distance = base::Hypot(away.x, away.y);
    if (distance < kSamePosition || IsInside(wall, walker_.position)) return;
    const double weight =
        Push(parameters_.wall_strength, walker_.radius_m, distance, parameters_.wall_range_m) / distance;
    push_.x += weight * away.x;
    push_.y += weight * away.y;
  }

  // Returns the direction of motion, of length 1.
  base::Point Direction(const base::Point& to_target) const {
    const base::Point sum{to_target.x + push_.x, to_target.y + push_.y};
    const double length = base::Hypot(sum.x, sum.y);
    return length < kSamePosition ? to_target : base::Point{sum.x / length, sum.y / length};
  }

  // Returns the gap between the bodies to the nearest one in the way, within the width of both bodies [m].
  double GapAhead(const base::Point& direction) const {
    double gap = std::numeric_limits<double>::infinity();
    for (const auto& [to, contact] : neighbours_) {
      const double aside = std::abs(direction.x * to.y - direction.y * to.x);
      if (Dot(direction, to) < 0.0 || aside > contact) continue;
      gap = std::min(gap, base::Hypot(to.x, to.y) - contact);
    }
    return gap;
  }

 private:
  struct Neighbour {
    base::Point to;
    double contact;
  };

  const Walker& walker_;
  const CrowdParameters& parameters_;
  base::Point push_;
  std::vector<Neighbour> neighbours_;
};

// Returns a move without the part that would bring the body nearer to a wall than its radius.
base::Point WithoutWalls(const Walker& walker, base::Point move, const std::vector<base::Segment>& walls) {
  for (int pass = 0; pass < kWallPasses; ++pass) {
    for (const base::Segment& wall : walls) {
      const base::Point to = Minus(NearestOn(wall, walker.position), walker.position);
      const double distance = base::Hypot(to.x, to.y);
      if (distance < kSamePosition || IsInside(wall, walker.position)) continue;
      const double approach = Dot(move, to) / distance, room = std::max(0.0, distance - walker.radius_m);
      if (approach <= room) continue;
      move.x -= (approach - room) * to.x / distance;
      move.y -= (approach - room) * to.y / distance;
    }
  }
  return move;
}

}  // namespace

Crowd::Crowd(const std::vector<Solid>& solids, std::vector<Door> doors, const CrowdParameters& parameters)
    : parameters_(CheckedParameters(parameters)),
      num_doors_(doors.size()),
      edges_(EdgesOf(solids, AsInstant(std::move(doors))), 2.0 * kWallReach) {}

std::vector<base::Point> Crowd::Step(std::vector<Walker> walkers, const std::vector<Bystander>& others,
                                     const std::vector<bool>& closed, double time_s) const {
  CheckWalkers(walkers, others);
  base::CheckPositive(time_s, "time_s");
  if (closed.size() != num_doors_) throw std::invalid_argument("closed must have one value per door");
  const double wanted = std::ceil(time_s / parameters_.longest_substep_s);
  if (wanted > kMostCrowdSubsteps) throw std::invalid_argument("a step of a crowd needs too many substeps");
  const int substeps = std::max(1, static_cast<int>(wanted));
  std::vector<base::Point> next(walkers.size());
  for (int substep = 0; substep < substeps; ++substep) {
    for (std::size_t i = 0; i < walkers.size(); ++i) {
      next[i] = NextPosition(walkers, i, others, WallsNear(walkers[i], closed), time_s / substeps);
    }
    for (std::size_t i = 0; i < walkers.size(); ++i) walkers[i].position = next[i];
  }
  return next;
}

base::Point Crowd::NextPosition(const std::vector<Walker>& walkers, std::size_t index,
                                const std::vector<Bystander>& others, const std::vector<base::Segment>& walls,
                                double time_s) const {
  const Walker& walker = walkers[index];
  base::Point to_target = Minus(walker.target, walker.position);
  const double left = base::Hypot(to_target.x, to_target.y);
  if (left < kSamePosition) return walker.position;
  to_target = {to_target.x / left, to_target.y / left};
  Surroundings around(walker, parameters_);
  for (std::size_t i = 0; i < walkers.size(); ++i) {
    if (i != index) around.Add(walkers[i].position, walkers[i].radius_m);
  }
  for (const Bystander& other : others) around.Add(other.position, other.radius_m);
  for (const base::Segment& wall : walls) around.AddWall(wall);
  const base::Point direction = around.Direction(to_target);
  const double by_gap = std::max(0.0, around.GapAhead(direction) / parameters_.time_gap_s);
  const double length = std::min(std::min(walker.speed_mps, by_gap) * time_s, left);
  const base::Point move = WithoutWalls(walker, {length * direction.x, length * direction.y}, walls);
  return {walker.position.x + move.x, walker.position.y + move.y};
}

std::vector<base::Segment> Crowd::WallsNear(const Walker& walker, const std::vector<bool>& closed) const {
  std::vector<base::Segment> walls;
  for (const Edge& edge : edges_.Near(walker.position)) {
    if (edge.door != Edge::kNoDoor && !closed[edge.door]) continue;
    if (DistanceToSegment(walker.position, edge.segment) <= walker.radius_m + kWallReach) walls.push_back(edge.segment);
  }
  return walls;
}

}  // namespace robotteamsim::world

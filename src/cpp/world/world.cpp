#include "robotteamsim/world/world.hpp"

#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/world/box_bodies.hpp"

namespace robotteamsim::world {
namespace {

constexpr int kVelocityIterations = 8;
constexpr int kPositionIterations = 3;

// Added to the distance that a robot travels: more than a slop (5 mm), from which contacts count, and any rounding
// error.
constexpr double kMargin = 0.02;

// Contacts nearer to each other than this are one [rad]: neighbouring pieces of a solid each make a contact.
constexpr double kSamePlace = 0.05;
constexpr double kFullTurn = 6.28318530717958648;

// A leaf keeps at least this distance from anything [m]; contacts count below it.
constexpr double kClearOfLeaves = 0.005;

// A drive that reaches less than this fraction of its speed is stalled.
constexpr double kStalled = 0.05;

bool IsTouching(const b2Body* body) {
  for (const b2ContactEdge* edge = body->GetContactList(); edge != nullptr; edge = edge->next) {
    if (edge->contact->IsTouching()) return true;
  }
  return false;
}

void CheckRobot(const Robot& robot) {
  for (const double value : {robot.radius_m, robot.mass_kg}) {
    if (!base::IsPositive(value)) throw std::invalid_argument("sizes and limits of a robot must be > 0");
  }
  base::Check(robot.start, "the start of a robot");
  if (!robot.footprint.empty()) CheckFootprint(robot.footprint, "a footprint");
  CheckDrive(robot.drive);
}

// More substeps than these in a step are a mistake in a speed or a size, and would take minutes.
constexpr double kMostSubsteps = 1e5;

// Box2D moves no body by more than 2 m at once and prevents robots from jumping over each other only if they move by
// less than their width. So no robot moves by more than half its radius, or a quarter of its width, at once.
int CheckedSubsteps(const std::vector<Robot>& robots, double step_s, int substeps) {
  if (!base::IsPositive(step_s) || substeps < 1) throw std::invalid_argument("step and substeps must be > 0");
  double parts = 1.0;
  for (const Robot& robot : robots) {
    CheckRobot(robot);
    const double radius_m = robot.footprint.empty() ? robot.radius_m : HalfWidth(robot.footprint);
    parts = std::max(parts, std::ceil(robot.drive.max_speed_mps * step_s / substeps / (0.5 * radius_m)));
  }
  if (substeps * parts > kMostSubsteps) {
    throw std::invalid_argument("a robot must not move by so many times its radius in a step; substeps needed: " +
                                std::to_string(substeps * parts));
  }
  return substeps * static_cast<int>(parts);
}

std::vector<Robot> WithReach(std::vector<Robot> robots) {
  for (Robot& robot : robots) {
    if (!robot.footprint.empty()) robot.radius_m = ReachOf(robot.footprint);
  }
  return robots;
}

// Returns the greatest speed of a robot's corners due to its rotation [m/s].
double MaxCornerSpeed(const Robot& robot) {
  if (robot.footprint.empty()) return 0.0;
  const DriveLimits& drive = robot.drive;
  const bool is_car = drive.kind == DriveKind::kCar;
  return robot.radius_m * (is_car ? CarTurn(drive.max_speed_mps, drive.max_steering_rad, drive) : drive.max_turn_radps);
}

std::vector<Solid> Checked(std::vector<Solid> solids) {
  for (const Solid& solid : solids) CheckSolid(solid);
  return solids;
}

double MaxRadius(const std::vector<Robot>& robots) {
  double radius_m = 0.0;
  for (const Robot& robot : robots) radius_m = std::max(radius_m, robot.radius_m);
  return radius_m;
}

// Returns the greatest distance that anything travels in a step [m]. No robot pushes anything to more than its own
// speed, but the far end of a turning object may be twice as fast.
double MaxTravelOf(const std::vector<Robot>& robots, bool are_there_things, double step_s) {
  double speed = 0.0;
  for (const Robot& robot : robots) speed = std::max(speed, robot.drive.max_speed_mps + MaxCornerSpeed(robot));
  return (are_there_things ? 2.0 : 1.0) * speed * step_s;
}

}  // namespace

World::World(std::vector<Solid> solids, std::vector<Door> doors, std::vector<Robot> robots, double step_s, int substeps,
             std::vector<MovableObject> objects)
    : solids_(Checked(std::move(solids))),
      robots_(WithReach(std::move(robots))),
      step_s_(step_s),
      substeps_(CheckedSubsteps(robots_, step_s, substeps)),
      dt_s_(step_s_ / substeps_),
      origin_(robots_.empty() ? base::Point{} : base::Point{robots_[0].start.x, robots_[0].start.y}),
      max_radius_m_(MaxRadius(robots_)),
      max_travel_m_(MaxTravelOf(robots_, !objects.empty(), step_s_)),
      edges_(EdgesOf(solids_, doors), max_radius_m_ + (max_travel_m_ + kMargin)),
      doors_(std::move(doors)),
      objects_(std::move(objects)) {
  Reset();
}

World::~World() = default;

void World::Reset() {
  // A new Box2D world: the order of bodies and contacts in the old one depends on its history and affects the results.
  box_ = std::make_unique<b2World>(b2Vec2(0.0F, 0.0F));
  b2BodyDef still;
  b2Body* building = box_->CreateBody(&still);
  for (const Solid& solid : solids_) AddPieces(building, solid, origin_);
  doors_.Place(*box_, origin_);
  robot_bodies_.clear();
  poses_.clear();
  for (const Robot& robot : robots_) AddRobot(robot);
  objects_.Place(box_.get(), origin_);
  drives_.assign(robots_.size(), {});
  twists_.assign(robots_.size(), {});
  motions_.assign(robots_.size(), {});
  in_contact_.assign(robots_.size(), false);
  contact_angles_.assign(robots_.size(), {});
  present_.assign(robots_.size(), true);
  arrivals_.assign(robots_.size(), 1);
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (robots_[i].is_present) continue;
    RemoveRobot(static_cast<int>(i));
    arrivals_[i] = 0;
  }
  grid_.Rebuild(poses_);
}

void World::AddRobot(const Robot& robot) {
  b2BodyDef def;
  def.type = b2_dynamicBody;
  def.position = ToBox(robot.start.x - origin_.x, robot.start.y - origin_.y);
  const bool is_round = robot.footprint.empty();
  def.fixedRotation = is_round;  // without friction only its drive turns a round body
  def.angle = is_round ? 0.0F : static_cast<float>(base::NormaliseAngle(robot.start.yaw));
  def.allowSleep = false;
  def.bullet = true;  // robots stop at each other as precisely as at walls
  b2Body* body = box_->CreateBody(&def);
  if (is_round) {
    AddDisc(body, robot.radius_m, robot.mass_kg);
  } else {
    AddPolygon(body, robot.footprint, robot.mass_kg);
    b2MassData mass_data;
    body->GetMassData(&mass_data);  // inertia about the origin
    mass_data.center.SetZero();     // the wheels hold base_link: the robot turns about it
    body->SetMassData(&mass_data);
  }
  robot_bodies_.push_back(body);
  poses_.push_back({robot.start.x, robot.start.y, base::NormaliseAngle(robot.start.yaw)});
}

void World::Step(const std::vector<base::Twist>& commands) {
  CheckCommands(commands, robots_.size());
  const int num_robots = static_cast<int>(robots_.size());
  const std::vector<base::Pose> before = poses_;
  twists_.assign(robots_.size(), {});
  in_contact_.assign(robots_.size(), false);
  for (std::vector<double>& angles : contact_angles_) angles.clear();
  const double travel_m = std::min(std::max(MaxTravel(commands), objects_.Travel(step_s_)), max_travel_m_);
  bool any_busy = objects_.AnyMoves();
  for (int i = 0; i < num_robots; ++i) {
    SetBusy(i, present_[i] && CouldTouch(i, travel_m));
    any_busy = any_busy || drives_[i].is_busy;
  }
  for (int substep = 0; substep < substeps_; ++substep) {
    doors_.Advance(dt_s_, [this](const Polygon& now, const Polygon& next) { return HoldsLeaf(now, next); });
    for (int i = 0; i < num_robots; ++i) {
      if (present_[i]) StartDrive(i, commands[i]);
    }
    if (any_busy) box_->Step(static_cast<float>(dt_s_), kVelocityIterations, kPositionIterations);
    for (int i = 0; i < num_robots; ++i) {
      if (present_[i]) FinishDrive(i);
    }
  }
  if (any_busy) objects_.FinishStep();
  for (int i = 0; i < num_robots; ++i) {
    if (present_[i]) motions_[i] = base::RelativePose(before[i], poses_[i]);
  }
  if (!doors_.leaves().empty()) doors_.UpdateStates();
  grid_.Rebuild(poses_);
}

// Returns the greatest distance that any robot drives, or is pushed, in a step.
double World::MaxTravel(const std::vector<base::Twist>& commands) const {
  double speed = 0.0;
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (!present_[i]) continue;
    speed = std::max(speed, SpeedBound(drives_[i].speed, commands[i], robots_[i].drive) + MaxCornerSpeed(robots_[i]));
  }
  return speed * step_s_;
}

bool World::CouldTouch(int robot, double travel_m) const {
  const base::Point at{poses_[robot].x, poses_[robot].y};
  const double reach_m = robots_[robot].radius_m + travel_m + kMargin;
  for (const Edge& edge : edges_.Near(at)) {
    const bool is_there = edge.door == Edge::kNoDoor || doors_.all()[edge.door].closed;
    if (is_there && DistanceToSegment(at, edge.segment) <= reach_m) return true;
  }
  bool found = doors_.IsLeafNear(at, reach_m + doors_.Travel(step_s_));
  grid_.ForEachNear(at, reach_m + travel_m + max_radius_m_, [&](int other, const base::Pose& pose) {
    const double dx = pose.x - at.x, dy = pose.y - at.y, apart = reach_m + travel_m + robots_[other].radius_m;
    found = found || (other != robot && dx * dx + dy * dy <= apart * apart);
  });
  if (objects().empty()) return found;
  object_grid().ForEachNear(at, reach_m + travel_m + max_object_radius(), [&](int object, const base::Pose& pose) {
    found = found || std::hypot(pose.x - at.x, pose.y - at.y) <= reach_m + travel_m + objects()[object].radius_m;
  });
  return found;
}

void World::SetBusy(int robot, bool is_busy) {
  Drive& drive = drives_[robot];
  if (drive.is_busy == is_busy) return;
  drive.is_busy = is_busy;
  b2Body* body = robot_bodies_[robot];
  if (is_busy) SetBodyPose(robot);
  body->SetEnabled(is_busy);
}

void World::SetBodyPose(int robot) {
  const base::Pose& pose = poses_[robot];
  const float angle = robots_[robot].footprint.empty() ? 0.0F : static_cast<float>(pose.yaw);
  robot_bodies_[robot]->SetTransform(ToBox(pose.x - origin_.x, pose.y - origin_.y), angle);
}

base::Point World::BodyPosition(int robot) const {
  const b2Vec2& at = robot_bodies_[robot]->GetPosition();
  return {origin_.x + at.x, origin_.y + at.y};
}

void World::StartDrive(int robot, const base::Twist& command) {
  Drive& drive = drives_[robot];
  drive.speed = ReachedSpeed(drive.speed, command, robots_[robot].drive, dt_s_);
  drive.target = AdvancedPose(poses_[robot], drive.speed, dt_s_);
  if (!drive.is_busy) return;
  b2Body* body = robot_bodies_[robot];
  const base::Point at = BodyPosition(robot);
  body->SetLinearVelocity(ToBox((drive.target.x - at.x) / dt_s_, (drive.target.y - at.y) / dt_s_));
  if (robots_[robot].footprint.empty()) return;
  const double turn = base::NormaliseAngle(drive.target.yaw - static_cast<double>(body->GetAngle()));
  body->SetAngularVelocity(static_cast<float>(turn / dt_s_));
}

void World::FinishDrive(int robot) {
  Drive& drive = drives_[robot];
  base::Pose& pose = poses_[robot];
  DriveSpeed reached = drive.speed;
  if (drive.is_busy && IsTouching(robot_bodies_[robot])) {
    reached = BodySpeed(robot);
    // A robot that is stopped completely stops its wheels; while it slides along something or pushes, they slip.
    const double wanted2 =
        drive.speed.forward_mps * drive.speed.forward_mps + drive.speed.left_mps * drive.speed.left_mps;
    if ((reached.forward_mps * drive.speed.forward_mps + reached.left_mps * drive.speed.left_mps) / wanted2 <
        kStalled) {
      drive.speed.forward_mps = 0.0;
      drive.speed.left_mps = 0.0;
    }
    const base::Point at = BodyPosition(robot);
    if (reached.turn_radps != drive.speed.turn_radps)
      drive.target.yaw = base::NormaliseAngle(pose.yaw + reached.turn_radps * dt_s_);
    if (reached.turn_radps / drive.speed.turn_radps < kStalled) drive.speed.turn_radps = 0.0;
    drive.target.x = at.x;
    drive.target.y = at.y;
    in_contact_[robot] = true;
    NoteContacts(robot, drive.target.yaw);
  }
  pose = drive.target;
  twists_[robot].linear_x += reached.forward_mps / substeps_;
  twists_[robot].linear_y += reached.left_mps / substeps_;
  twists_[robot].angular_z += reached.turn_radps / substeps_;
}

// Returns the motion of a body with contacts in a substep as a speed of its drive.
DriveSpeed World::BodySpeed(int robot) const {
  const base::Pose& pose = poses_[robot];
  const Robot& body = robots_[robot];
  DriveSpeed speed = drives_[robot].speed;
  if (!body.footprint.empty()) {
    speed.turn_radps = base::NormaliseAngle(static_cast<double>(robot_bodies_[robot]->GetAngle()) - pose.yaw) / dt_s_;
  }
  const base::Point at = BodyPosition(robot);
  const double heading = pose.yaw + 0.5 * speed.turn_radps * dt_s_;
  const double cos = std::cos(heading), sin = std::sin(heading);
  const double dx = at.x - pose.x, dy = at.y - pose.y;
  speed.forward_mps = (cos * dx + sin * dy) / dt_s_;
  speed.left_mps = (cos * dy - sin * dx) / dt_s_;
  if (body.drive.kind == DriveKind::kCar) {  // it turns only as far as its wheels roll
    const double rolled = CarTurn(speed.forward_mps, speed.steering_rad, body.drive);
    const double wanted = drives_[robot].speed.turn_radps;
    const bool turns_too_far = speed.turn_radps * wanted > 0.0 && std::abs(speed.turn_radps) > std::abs(rolled);
    if (body.footprint.empty() || turns_too_far) speed.turn_radps = rolled;
  }
  return speed;
}

void World::NoteContacts(int robot, double yaw) {
  const b2Body* body = robot_bodies_[robot];
  std::vector<double>& angles = contact_angles_[robot];
  angles.clear();
  for (const b2ContactEdge* edge = body->GetContactList(); edge != nullptr; edge = edge->next) {
    if (!edge->contact->IsTouching()) continue;
    b2WorldManifold manifold;
    edge->contact->GetWorldManifold(&manifold);
    const bool is_flat = edge->contact->GetManifold()->pointCount == 2;
    const b2Vec2 place = is_flat ? 0.5F * (manifold.points[0] + manifold.points[1]) : manifold.points[0];
    const b2Vec2 away = place - body->GetPosition();
    angles.push_back(base::NormaliseAngle(std::atan2(static_cast<double>(away.y), static_cast<double>(away.x)) - yaw));
  }
  std::sort(angles.begin(), angles.end());
  const auto is_same = [](double first, double next) { return next - first < kSamePlace; };
  angles.erase(std::unique(angles.begin(), angles.end(), is_same), angles.end());
  if (angles.size() > 1 && angles.front() + kFullTurn - angles.back() < kSamePlace) angles.pop_back();
}

void World::SetPose(int robot, const base::Pose& pose) {
  base::Check(pose, "the pose of a robot");
  Place(robot, pose);
}

void World::Place(int robot, const base::Pose& pose) {
  base::Pose& stored = poses_.at(robot);
  stored = {pose.x, pose.y, base::NormaliseAngle(pose.yaw)};
  if (pose.x == pose.x) SetBodyPose(robot);  // a removed robot's disabled body keeps its last transform
  drives_[robot].speed = {};
  twists_[robot] = {};
  motions_[robot] = {};
  in_contact_[robot] = false;
  contact_angles_[robot].clear();
  grid_.Rebuild(poses_);
}

void World::RemoveRobot(int robot) {
  Place(robot, kNowhere);
  present_[robot] = false;
  SetBusy(robot, false);
}

void World::SpawnRobot(int robot, const base::Pose& pose) {
  SetPose(robot, pose);
  if (present_[robot]) return;
  present_[robot] = true;
  ++arrivals_[robot];
}

bool World::HoldsLeaf(const Polygon& now, const Polygon& next) const {
  const auto holds = [&](const base::Pose& pose, double radius_m, const Polygon& corners) {
    const base::Point at{pose.x, pose.y};
    const double apart = GapBetween(next, at) - radius_m;
    if (apart >= kClearOfLeaves) return false;
    // Contact with a leaf that moves away does not hold it.
    if (corners.empty()) return apart < GapBetween(now, at) - radius_m;
    const Polygon body = Placed(corners, pose);
    const double gap = GapBetween(next, body);
    return gap < kClearOfLeaves && gap < GapBetween(now, body);
  };
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    if (present_[i] && holds(poses_[i], robots_[i].radius_m, robots_[i].footprint)) return true;
  }
  for (std::size_t i = 0; i < objects().size(); ++i) {
    if (holds(objects_.PoseNow(static_cast<int>(i)), objects()[i].radius_m, objects()[i].corners)) return true;
  }
  return false;
}

void World::SetDoorClosed(int door, bool closed) { doors_.SetClosed(door, closed); }

void World::AddObject(MovableObject object) {
  objects_.Add(std::move(object));
  const double travel_m = MaxTravelOf(robots_, true, step_s_);
  if (travel_m == max_travel_m_) return;
  max_travel_m_ = travel_m;
  edges_ = NearbyEdges(EdgesOf(solids_, doors_.all()), max_radius_m_ + (max_travel_m_ + kMargin));
}

void World::RemoveObject(int object) { objects_.Remove(object); }

void World::SetObjectPose(int object, const base::Pose& pose) { objects_.SetPose(object, pose); }

}  // namespace robotteamsim::world

#include "robotteamsim/world/world.hpp"

#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace robotteamsim {
namespace {

constexpr int kVelocityIterations = 8;
constexpr int kPositionIterations = 3;

// Box2D lets shapes at rest overlap by one slop. Half a slop around each keeps the bodies themselves from it: they rest
// at most a slop (5 mm) apart.
constexpr float kSkin = 0.5F * b2_linearSlop;

// How much farther than it drives a robot is looked at: contacts count from a slop (5 mm) on, and rounding is no
// matter.
constexpr double kMargin = 0.02;

// Contacts nearer to each other than this are one [rad]: solids are made of pieces that meet within them.
constexpr double kSamePlace = 0.05;
constexpr double kFullTurn = 6.28318530717958648;

// A thing that has gone less than this [m or rad] has not moved: that much may be rounding.
constexpr double kUnmoved = 1e-6;

constexpr double kGravity = 9.81;  // [m/s^2]

// A drive that reaches less than this part of its speed is stalled.
constexpr double kStalled = 0.05;

b2Vec2 ToBox(double x, double y) { return {static_cast<float>(x), static_cast<float>(y)}; }

// Fills the shape by hand: b2PolygonShape::Set welds corners nearer than 2.5 mm and turns what then is no polygon into
// a box of two metres, so thin solids would not be what the plan says.
b2PolygonShape ConvexShape(const Polygon& piece, const Point& origin) {
  const int count = static_cast<int>(piece.size());
  if (count < 3 || count > b2_maxPolygonVertices) {
    throw std::invalid_argument("a convex piece needs 3 to 8 corners, got " + std::to_string(count));
  }
  b2PolygonShape shape;
  shape.m_radius = kSkin;
  shape.m_count = count;
  for (int i = 0; i < count; ++i) {
    const Point& corner = piece[i];
    const Point& next = piece[(i + 1) % count];
    const double dx = next.x - corner.x, dy = next.y - corner.y, length = std::hypot(dx, dy);
    if (!(length > 0.0) || !(Cross(corner, next, piece[(i + 2) % count]) >= 0.0)) {
      throw std::invalid_argument("a piece must be convex and counter-clockwise, without equal corners");
    }
    shape.m_vertices[i] = ToBox(corner.x - origin.x, corner.y - origin.y);
    shape.m_normals[i] = ToBox(dy / length, -dx / length);
    shape.m_centroid += 1.0F / static_cast<float>(count) * shape.m_vertices[i];
  }
  return shape;
}

void AddFixture(b2Body* body, const b2Shape& shape, double density) {
  b2FixtureDef fixture;
  fixture.shape = &shape;
  fixture.friction = 0.0F;
  fixture.density = static_cast<float>(density);
  body->CreateFixture(&fixture);
}

void AddPieces(b2Body* body, const Solid& solid, const Point& origin) {
  for (const Polygon& piece : solid.pieces) {
    AddFixture(body, ConvexShape(piece, origin), 0.0);
  }
}

void AddDisc(b2Body* body, double radius, double mass) {
  b2CircleShape shape;
  shape.m_radius = static_cast<float>(radius) + kSkin;
  AddFixture(body, shape, mass / (static_cast<double>(b2_pi) * shape.m_radius * shape.m_radius));
}

void AddPolygon(b2Body* body, const Polygon& corners, double mass) {
  double twice_area = 0.0;
  for (std::size_t i = 2; i < corners.size(); ++i) twice_area += Cross(corners[0], corners[i - 1], corners[i]);
  AddFixture(body, ConvexShape(corners, {}), 2.0 * mass / twice_area);
}

bool IsTouching(const b2Body* body) {
  for (const b2ContactEdge* edge = body->GetContactList(); edge != nullptr; edge = edge->next) {
    if (edge->contact->IsTouching()) return true;
  }
  return false;
}

bool IsPositive(double value) { return value > 0.0 && std::isfinite(value); }

void CheckRobot(const Robot& robot) {
  for (const double value : {robot.radius, robot.mass}) {
    if (!IsPositive(value)) throw std::invalid_argument("sizes and limits of a robot must be > 0");
  }
  if (!robot.footprint.empty()) CheckFootprint(robot.footprint, "a footprint");
  CheckDrive(robot.drive);
}

// Box2D moves no body by more than 2 m at once, and keeps robots from jumping over each other only while they move by
// less than they are wide. So no robot moves by more than half its radius at once, or a quarter of its width.
int CheckedSubsteps(const std::vector<Robot>& robots, double step, int substeps) {
  if (!IsPositive(step) || substeps < 1) throw std::invalid_argument("step and substeps must be > 0");
  double parts = 1.0;
  for (const Robot& robot : robots) {
    CheckRobot(robot);
    const double radius = robot.footprint.empty() ? robot.radius : HalfWidth(robot.footprint);
    parts = std::max(parts, std::ceil(robot.drive.max_speed * step / substeps / (0.5 * radius)));
  }
  return substeps * static_cast<int>(parts);
}

std::vector<Robot> WithReach(std::vector<Robot> robots) {
  for (Robot& robot : robots) {
    if (!robot.footprint.empty()) robot.radius = ReachOf(robot.footprint);
  }
  return robots;
}

// How fast a robot's corners go at most by its turning [m/s].
double MaxCornerSpeed(const Robot& robot) {
  if (robot.footprint.empty()) return 0.0;
  const DriveLimits& drive = robot.drive;
  const bool is_car = drive.kind == DriveKind::kCar;
  return robot.radius * (is_car ? CarTurn(drive.max_speed, drive.max_steering, drive) : drive.max_turn);
}

double MaxRadius(const std::vector<Robot>& robots) {
  double radius = 0.0;
  for (const Robot& robot : robots) radius = std::max(radius, robot.radius);
  return radius;
}

// The longest way of anything in a step [m]. Nothing pushes anything to more than its own speed, but a thing's far end
// may turn as fast again.
double MaxTravelOf(const std::vector<Robot>& robots, bool are_there_things, double step) {
  double speed = 0.0;
  for (const Robot& robot : robots) speed = std::max(speed, robot.drive.max_speed + MaxCornerSpeed(robot));
  return (are_there_things ? 2.0 : 1.0) * speed * step;
}

std::vector<Thing> Checked(std::vector<Thing> things) {
  for (Thing& thing : things) {
    if (!thing.corners.empty()) {
      CheckFootprint(thing.corners, "a thing");
      thing.radius = ReachOf(thing.corners);
    }
    const bool is_fine = IsPositive(thing.radius) && IsPositive(thing.mass) && IsPositive(thing.friction);
    if (!is_fine) throw std::invalid_argument("size, mass and friction of a thing must be > 0");
  }
  return things;
}

double MaxRadius(const std::vector<Thing>& things) {
  double radius = 0.0;
  for (const Thing& thing : things) radius = std::max(radius, thing.radius);
  return radius;
}

}  // namespace

World::World(std::vector<Solid> solids, std::vector<Door> doors, std::vector<Robot> robots, double step, int substeps,
             std::vector<Thing> things)
    : solids_(std::move(solids)),
      initial_doors_(std::move(doors)),
      robots_(WithReach(std::move(robots))),
      things_(Checked(std::move(things))),
      step_(step),
      substeps_(CheckedSubsteps(robots_, step, substeps)),
      dt_(step_ / substeps_),
      origin_(robots_.empty() ? Point{} : Point{robots_[0].start.x, robots_[0].start.y}),
      max_radius_(MaxRadius(robots_)),
      max_thing_radius_(MaxRadius(things_)),
      max_travel_(MaxTravelOf(robots_, !things_.empty(), step_)),
      edges_(EdgesOf(solids_, initial_doors_), max_radius_ + (max_travel_ + kMargin)) {
  Reset();
}

World::~World() = default;

void World::Reset() {
  // A new Box2D world: the order of bodies and contacts in the old one depends on its past and reaches the results.
  box_ = std::make_unique<b2World>(b2Vec2(0.0F, 0.0F));
  b2BodyDef still;
  b2Body* building = box_->CreateBody(&still);
  for (const Solid& solid : solids_) AddPieces(building, solid, origin_);
  doors_ = initial_doors_;
  door_bodies_.clear();
  for (const Door& door : doors_) {
    still.enabled = door.closed;
    door_bodies_.push_back(box_->CreateBody(&still));
    AddPieces(door_bodies_.back(), door.leaf, origin_);
  }
  robot_bodies_.clear();
  poses_.clear();
  for (const Robot& robot : robots_) AddRobot(robot);
  AddThings();
  drives_.assign(robots_.size(), {});
  twists_.assign(robots_.size(), {});
  motions_.assign(robots_.size(), {});
  in_contact_.assign(robots_.size(), false);
  contact_angles_.assign(robots_.size(), {});
  grid_.Rebuild(poses_);
}

void World::AddRobot(const Robot& robot) {
  b2BodyDef def;
  def.type = b2_dynamicBody;
  def.position = ToBox(robot.start.x - origin_.x, robot.start.y - origin_.y);
  const bool is_round = robot.footprint.empty();
  def.fixedRotation = is_round;  // nothing turns a round body without friction: its drive alone does
  def.angle = is_round ? 0.0F : static_cast<float>(NormaliseAngle(robot.start.yaw));
  def.allowSleep = false;
  def.bullet = true;  // robots stop at each other as exactly as at walls
  b2Body* body = box_->CreateBody(&def);
  if (is_round) {
    AddDisc(body, robot.radius, robot.mass);
  } else {
    AddPolygon(body, robot.footprint, robot.mass);
    b2MassData mass;
    body->GetMassData(&mass);  // its inertia is about the origin
    mass.center.SetZero();     // the wheels hold base_link where it is: it turns about that
    body->SetMassData(&mass);
  }
  robot_bodies_.push_back(body);
  poses_.push_back({robot.start.x, robot.start.y, NormaliseAngle(robot.start.yaw)});
}

void World::AddThings() {
  thing_bodies_.clear();
  thing_poses_.clear();
  b2BodyDef still;
  b2Body* const ground = things_.empty() ? nullptr : box_->CreateBody(&still);
  for (const Thing& thing : things_) {
    b2BodyDef def;
    def.type = b2_dynamicBody;
    def.position = ToBox(thing.start.x - origin_.x, thing.start.y - origin_.y);
    def.angle = static_cast<float>(NormaliseAngle(thing.start.yaw));
    def.bullet = true;
    b2Body* body = box_->CreateBody(&def);
    if (thing.corners.empty()) {
      AddDisc(body, thing.radius, thing.mass);
    } else {
      AddPolygon(body, thing.corners, thing.mass);
    }
    const double weight = kGravity * thing.mass;
    b2FrictionJointDef rub;
    rub.Initialize(ground, body, body->GetWorldCenter());
    rub.maxForce = static_cast<float>(thing.friction * weight);
    // The mean distance of a disc's points from its middle is two thirds of its radius.
    rub.maxTorque = static_cast<float>(thing.friction * weight * 2.0 / 3.0 * thing.radius);
    box_->CreateJoint(&rub);
    thing_bodies_.push_back(body);
    thing_poses_.push_back({thing.start.x, thing.start.y, NormaliseAngle(thing.start.yaw)});
  }
  thing_grid_.Rebuild(thing_poses_);
}

// A thing that has rested for half a second sleeps until something touches it.
bool World::AnyThingMoves() const {
  return std::any_of(thing_bodies_.begin(), thing_bodies_.end(), [](const b2Body* body) { return body->IsAwake(); });
}

// The longest way that any thing goes in a step at its speed.
double World::ThingTravel() const {
  double speed = 0.0;
  for (std::size_t i = 0; i < things_.size(); ++i) {
    const b2Body* const body = thing_bodies_[i];
    const double turning = things_[i].radius * std::abs(static_cast<double>(body->GetAngularVelocity()));
    speed = std::max(speed, static_cast<double>(body->GetLinearVelocity().Length()) + turning);
  }
  return speed * step_;
}

void World::FinishThings() {
  bool any = false;
  for (std::size_t i = 0; i < things_.size(); ++i) {
    const b2Body* const body = thing_bodies_[i];
    if (!body->IsAwake()) continue;
    const b2Vec2& at = body->GetPosition();
    const Pose pose{origin_.x + at.x, origin_.y + at.y, NormaliseAngle(static_cast<double>(body->GetAngle()))};
    // A thing that nobody has pushed yet stays where it was placed, in double precision.
    const Pose way = RelativePose(thing_poses_[i], pose);
    if (std::hypot(way.x, way.y) < kUnmoved && std::abs(way.yaw) < kUnmoved) continue;
    thing_poses_[i] = pose;
    any = true;
  }
  if (any) thing_grid_.Rebuild(thing_poses_);
}

void World::CheckCommands(const std::vector<Twist>& commands) const {
  if (commands.size() != robots_.size()) {
    throw std::invalid_argument("expected " + std::to_string(robots_.size()) + " twists, got " +
                                std::to_string(commands.size()));
  }
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const Twist& twist = commands[i];
    if (!std::isfinite(twist.linear_x) || !std::isfinite(twist.linear_y) || !std::isfinite(twist.angular_z)) {
      throw std::invalid_argument("robot_" + std::to_string(i) + ": twist must be finite, got (" +
                                  std::to_string(twist.linear_x) + ", " + std::to_string(twist.linear_y) + ", " +
                                  std::to_string(twist.angular_z) + ")");
    }
  }
}

void World::Step(const std::vector<Twist>& commands) {
  CheckCommands(commands);
  const int num_robots = static_cast<int>(robots_.size());
  const std::vector<Pose> before = poses_;
  twists_.assign(robots_.size(), {});
  in_contact_.assign(robots_.size(), false);
  for (std::vector<double>& angles : contact_angles_) angles.clear();
  const double travel = std::min(std::max(MaxTravel(commands), ThingTravel()), max_travel_);
  bool any_busy = AnyThingMoves();
  for (int i = 0; i < num_robots; ++i) {
    SetBusy(i, CouldTouch(i, travel));
    any_busy = any_busy || drives_[i].is_busy;
  }
  for (int substep = 0; substep < substeps_; ++substep) {
    for (int i = 0; i < num_robots; ++i) StartDrive(i, commands[i]);
    if (any_busy) box_->Step(static_cast<float>(dt_), kVelocityIterations, kPositionIterations);
    for (int i = 0; i < num_robots; ++i) FinishDrive(i);
  }
  if (any_busy) FinishThings();
  for (int i = 0; i < num_robots; ++i) motions_[i] = RelativePose(before[i], poses_[i]);
  grid_.Rebuild(poses_);
}

// The longest way that any robot drives in a step, and so the longest that any is pushed.
double World::MaxTravel(const std::vector<Twist>& commands) const {
  double speed = 0.0;
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    speed = std::max(speed, SpeedBound(drives_[i].speed, commands[i], robots_[i].drive) + MaxCornerSpeed(robots_[i]));
  }
  return speed * step_;
}

bool World::CouldTouch(int robot, double travel) const {
  const Point at{poses_[robot].x, poses_[robot].y};
  const double reach = robots_[robot].radius + travel + kMargin;
  for (const Edge& edge : edges_.Near(at)) {
    const bool is_there = edge.door == Edge::kNoDoor || doors_[edge.door].closed;
    if (is_there && DistanceToSegment(at, edge.segment) <= reach) return true;
  }
  bool found = false;
  grid_.ForEachNear(at, reach + travel + max_radius_, [&](int other, const Pose& pose) {
    const double dx = pose.x - at.x, dy = pose.y - at.y, apart = reach + travel + robots_[other].radius;
    found = found || (other != robot && dx * dx + dy * dy <= apart * apart);
  });
  if (things_.empty()) return found;
  thing_grid_.ForEachNear(at, reach + travel + max_thing_radius_, [&](int thing, const Pose& pose) {
    found = found || std::hypot(pose.x - at.x, pose.y - at.y) <= reach + travel + things_[thing].radius;
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
  const Pose& pose = poses_[robot];
  const float angle = robots_[robot].footprint.empty() ? 0.0F : static_cast<float>(pose.yaw);
  robot_bodies_[robot]->SetTransform(ToBox(pose.x - origin_.x, pose.y - origin_.y), angle);
}

Point World::BodyPosition(int robot) const {
  const b2Vec2& at = robot_bodies_[robot]->GetPosition();
  return {origin_.x + at.x, origin_.y + at.y};
}

void World::StartDrive(int robot, const Twist& command) {
  Drive& drive = drives_[robot];
  drive.speed = ReachedSpeed(drive.speed, command, robots_[robot].drive, dt_);
  drive.target = AdvancedPose(poses_[robot], drive.speed, dt_);
  if (!drive.is_busy) return;
  b2Body* body = robot_bodies_[robot];
  const Point at = BodyPosition(robot);
  body->SetLinearVelocity(ToBox((drive.target.x - at.x) / dt_, (drive.target.y - at.y) / dt_));
  if (robots_[robot].footprint.empty()) return;
  const double turn = NormaliseAngle(drive.target.yaw - static_cast<double>(body->GetAngle()));
  body->SetAngularVelocity(static_cast<float>(turn / dt_));
}

void World::FinishDrive(int robot) {
  Drive& drive = drives_[robot];
  Pose& pose = poses_[robot];
  DriveSpeed reached = drive.speed;
  if (drive.is_busy && IsTouching(robot_bodies_[robot])) {
    reached = BodySpeed(robot);
    // What stops a robot dead stops its wheels; along what it slides along, and behind what it pushes, they slip.
    const double wanted2 = drive.speed.forward * drive.speed.forward + drive.speed.left * drive.speed.left;
    if ((reached.forward * drive.speed.forward + reached.left * drive.speed.left) / wanted2 < kStalled) {
      drive.speed.forward = 0.0;
      drive.speed.left = 0.0;
    }
    const Point at = BodyPosition(robot);
    if (reached.turn != drive.speed.turn) drive.target.yaw = NormaliseAngle(pose.yaw + reached.turn * dt_);
    if (reached.turn / drive.speed.turn < kStalled) drive.speed.turn = 0.0;
    drive.target.x = at.x;
    drive.target.y = at.y;
    in_contact_[robot] = true;
    NoteContacts(robot, drive.target.yaw);
  }
  pose = drive.target;
  twists_[robot].linear_x += reached.forward / substeps_;
  twists_[robot].linear_y += reached.left / substeps_;
  twists_[robot].angular_z += reached.turn / substeps_;
}

// How a body that touches something moved in a substep, as a speed of its drive.
DriveSpeed World::BodySpeed(int robot) const {
  const Pose& pose = poses_[robot];
  const Robot& body = robots_[robot];
  DriveSpeed speed = drives_[robot].speed;
  if (!body.footprint.empty()) {
    speed.turn = NormaliseAngle(static_cast<double>(robot_bodies_[robot]->GetAngle()) - pose.yaw) / dt_;
  }
  const Point at = BodyPosition(robot);
  const double heading = pose.yaw + 0.5 * speed.turn * dt_;
  const double cos = std::cos(heading), sin = std::sin(heading);
  const double dx = at.x - pose.x, dy = at.y - pose.y;
  speed.forward = (cos * dx + sin * dy) / dt_;
  speed.left = (cos * dy - sin * dx) / dt_;
  if (body.drive.kind == DriveKind::kCar) {  // its wheels turn it as far as they roll
    const double rolled = CarTurn(speed.forward, speed.steering, body.drive);
    const double wanted = drives_[robot].speed.turn;
    const bool turns_too_far = speed.turn * wanted > 0.0 && std::abs(speed.turn) > std::abs(rolled);
    if (body.footprint.empty() || turns_too_far) speed.turn = rolled;
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
    angles.push_back(NormaliseAngle(std::atan2(static_cast<double>(away.y), static_cast<double>(away.x)) - yaw));
  }
  std::sort(angles.begin(), angles.end());
  const auto is_same = [](double first, double next) { return next - first < kSamePlace; };
  angles.erase(std::unique(angles.begin(), angles.end(), is_same), angles.end());
  if (angles.size() > 1 && angles.front() + kFullTurn - angles.back() < kSamePlace) angles.pop_back();
}

void World::SetPose(int robot, const Pose& pose) {
  Pose& stored = poses_.at(robot);
  stored = {pose.x, pose.y, NormaliseAngle(pose.yaw)};
  SetBodyPose(robot);
  drives_[robot].speed = {};
  twists_[robot] = {};
  motions_[robot] = {};
  in_contact_[robot] = false;
  contact_angles_[robot].clear();
  grid_.Rebuild(poses_);
}

void World::SetDoorClosed(int door, bool closed) {
  doors_.at(door).closed = closed;
  door_bodies_[door]->SetEnabled(closed);
}

}  // namespace robotteamsim

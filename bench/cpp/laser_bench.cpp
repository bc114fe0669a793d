// Scans of all robots of a team, 181 beams over half a turn, 5 m, on a floor of 60 x 40 m with 80 rectangles; beside
// Box2D's own ray cast, one per beam, among the same walls and robots.
#include <benchmark/benchmark.h>
#include <box2d/box2d.h>

#include <cmath>
#include <cstddef>
#include <numeric>
#include <random>
#include <vector>

#include "robotteamsim/sensing/range_report.hpp"
#include "robotteamsim/world/fan_caster.hpp"

namespace robotteamsim {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kBeams = 181;
constexpr double kRange = 5.0;
constexpr double kRadius = 0.2;

world::Solid Rectangle(double x, double y, double width, double height) {
  const world::Polygon corners{{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
  return {corners, {corners}};
}

std::vector<world::Solid> Floor(std::mt19937* random) {
  std::uniform_real_distribution<double> x(1.0, 56.0), y(1.0, 36.0), size(0.2, 3.0);
  std::vector<world::Solid> solids{Rectangle(0.0, 0.0, 60.0, 0.2), Rectangle(0.0, 39.8, 60.0, 0.2),
                                   Rectangle(0.0, 0.2, 0.2, 39.6), Rectangle(59.8, 0.2, 0.2, 39.6)};
  while (solids.size() < 80) solids.push_back(Rectangle(x(*random), y(*random), size(*random), size(*random)));
  return solids;
}

bool IsFree(const std::vector<world::Solid>& solids, const std::vector<world::Robot>& robots, const base::Pose& pose) {
  for (const world::Solid& solid : solids) {
    const base::Point &low = solid.outline[0], &high = solid.outline[2];
    if (pose.x > low.x - 0.3 && pose.x < high.x + 0.3 && pose.y > low.y - 0.3 && pose.y < high.y + 0.3) return false;
  }
  for (const world::Robot& other : robots) {
    if (std::hypot(pose.x - other.start.x, pose.y - other.start.y) < 0.5) return false;
  }
  return true;
}

world::World MakeWorld(int num_robots) {
  std::mt19937 random(7);
  const std::vector<world::Solid> solids = Floor(&random);
  std::uniform_real_distribution<double> x(0.5, 59.5), y(0.5, 39.5), yaw(-kPi, kPi);
  std::vector<world::Robot> robots;
  while (static_cast<int>(robots.size()) < num_robots) {
    world::Robot robot;
    robot.radius_m = kRadius;
    robot.start = {x(random), y(random), yaw(random)};
    if (IsFree(solids, robots, robot.start)) robots.push_back(robot);
  }
  return world::World(solids, {}, robots, 0.1, 5);
}

void LaserScans(benchmark::State& state) {
  const world::World world = MakeWorld(static_cast<int>(state.range(0)));
  const world::FanCaster caster({kBeams, -0.5 * kPi, 0.5 * kPi, 0.1, 0.0, kRange}, world);
  const std::size_t num_robots = world.robots().size();
  std::vector<int> robots(num_robots);
  std::iota(robots.begin(), robots.end(), 0);
  std::vector<double> ranges_m(num_robots * kBeams);
  std::vector<float> reported_m(ranges_m.size());
  for (auto _ : state) {
    caster.Cast(world, robots, {ranges_m.data(), num_robots, kBeams});
    sensing::Report({0.05, kRange, 0.05, kRange}, {ranges_m.data(), num_robots, kBeams}, {},
                    {reported_m.data(), num_robots, kBeams});
    benchmark::DoNotOptimize(reported_m.data());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0) * kBeams);
}

/// The nearest that a ray meets, but for one body.
class Nearest : public b2RayCastCallback {
 public:
  explicit Nearest(const b2Body* own) : own_(own) {}
  float ReportFixture(b2Fixture* fixture, const b2Vec2&, const b2Vec2&, float fraction) override {
    if (fixture->GetBody() == own_) return -1.0F;
    return fraction_ = fraction;
  }
  float fraction() const { return fraction_; }

 private:
  const b2Body* own_;
  float fraction_ = 1.0F;
};

b2Vec2 ToBox(double x, double y) { return {static_cast<float>(x), static_cast<float>(y)}; }

std::vector<b2Body*> Fill(const world::World& world, b2World* box) {
  b2BodyDef still;
  for (const world::Solid& solid : world.solids()) {
    b2PolygonShape shape;
    std::vector<b2Vec2> corners;
    for (const base::Point& corner : solid.outline) corners.push_back(ToBox(corner.x, corner.y));
    shape.Set(corners.data(), static_cast<int>(corners.size()));
    box->CreateBody(&still)->CreateFixture(&shape, 0.0F);
  }
  std::vector<b2Body*> robots;
  b2CircleShape disc;
  disc.m_radius = kRadius;
  for (const base::Pose& pose : world.poses()) {
    b2BodyDef def;
    def.type = b2_dynamicBody;
    def.position = ToBox(pose.x, pose.y);
    robots.push_back(box->CreateBody(&def));
    robots.back()->CreateFixture(&disc, 1.0F);
  }
  return robots;
}

void LaserScansPlain(benchmark::State& state) {
  const world::World world = MakeWorld(static_cast<int>(state.range(0)));
  b2World box(b2Vec2(0.0F, 0.0F));
  const std::vector<b2Body*> bodies = Fill(world, &box);
  for (auto _ : state) {
    for (std::size_t robot = 0; robot < bodies.size(); ++robot) {
      const base::Pose& pose = world.poses()[robot];
      const b2Vec2 from = ToBox(pose.x + 0.1 * std::cos(pose.yaw), pose.y + 0.1 * std::sin(pose.yaw));
      for (int beam = 0; beam < kBeams; ++beam) {
        const double angle = pose.yaw - 0.5 * kPi + beam * kPi / (kBeams - 1);
        Nearest nearest(bodies[robot]);
        box.RayCast(&nearest, from, from + ToBox(kRange * std::cos(angle), kRange * std::sin(angle)));
        benchmark::DoNotOptimize(nearest.fraction());
      }
    }
  }
  state.SetItemsProcessed(state.iterations() * state.range(0) * kBeams);
}

BENCHMARK(LaserScans)->Arg(3)->Arg(100)->Arg(1000);
BENCHMARK(LaserScansPlain)->Arg(3)->Arg(100)->Arg(1000);

}  // namespace
}  // namespace robotteamsim

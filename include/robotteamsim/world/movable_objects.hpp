#pragma once

#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/world/disc_grid.hpp"
#include "robotteamsim/world/drive.hpp"
#include "robotteamsim/world/solid.hpp"

class b2Body;
class b2World;

namespace robotteamsim::world {

/// Something that robots push: it slides and turns until the friction of the ground has stopped it.
struct MovableObject {
  double radius = 0.2;    ///< [m]; a world makes it that of the disc around its middle that holds the corners
  double mass = 1.0;      ///< [kg]
  double friction = 0.5;  ///< of the ground, per weight
  base::Pose start;       ///< of its middle
  Polygon corners = {};   ///< around its middle, 3 to 8 counter-clockwise [m]; none: it is round
};

/// The objects of a world: those that it began with, in their order, then those that came later.
class MovableObjects {
 public:
  /// Throws std::invalid_argument on an object that cannot be.
  explicit MovableObjects(std::vector<MovableObject> objects);

  /// Begins again with the first objects, in a new Box2D world that counts from origin. The world has to outlive this.
  void Place(b2World* box, const base::Point& origin);

  /// Adds an object where it starts. Throws std::invalid_argument on one that cannot be.
  void Add(MovableObject object);
  /// Takes an object away; the indices of those behind it move up by one.
  void Remove(int object);
  /// Puts an object somewhere, at rest.
  void SetPose(int object, const base::Pose& pose);
  /// Takes over where Box2D has moved the objects in a step.
  void FinishStep();

  const std::vector<MovableObject>& all() const { return objects_; }
  const std::vector<base::Pose>& poses() const { return poses_; }
  const DiscGrid& grid() const { return grid_; }
  double max_radius() const { return max_radius_; }

  /// Where an object is now, within a step, too.
  base::Pose PoseNow(int object) const;
  /// Whether anything moves: what has rested for half a second sleeps until something touches it.
  bool AnyMoves() const;
  /// The longest way that any object goes at its speed in a time [s].
  double Travel(double time) const;

 private:
  void Build(const MovableObject& object);
  void Changed();

  const std::vector<MovableObject> first_;
  b2World* box_ = nullptr;
  base::Point origin_;
  b2Body* ground_ = nullptr;
  std::vector<MovableObject> objects_;
  std::vector<b2Body*> bodies_;
  std::vector<base::Pose> poses_;
  DiscGrid grid_;
  double max_radius_ = 0.0;
};

}  // namespace robotteamsim::world

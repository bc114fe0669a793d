#pragma once

#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/world/disc_grid.hpp"
#include "robotteamsim/world/drive.hpp"
#include "robotteamsim/world/solid.hpp"

class b2Body;
class b2World;

namespace robotteamsim::world {

/// An object that robots can push: it slides and turns until the friction of the ground has stopped it.
struct MovableObject {
  double radius_m = 0.2;  ///< a world sets it to that of the disc around its middle that contains the corners
  double mass_kg = 1.0;
  double friction = 0.5;  ///< of the ground, per weight
  base::Pose start;       ///< of its middle
  Polygon corners = {};   ///< around its middle, 3 to 8 counter-clockwise [m]; none: it is round
};

/// The objects of a world: those of the start, in their order, then those added later.
class MovableObjects {
 public:
  /// Throws std::invalid_argument if an object is invalid.
  explicit MovableObjects(std::vector<MovableObject> objects);

  /// Restarts with the first objects, in a new Box2D world with this origin. The world must outlive this.
  void Place(b2World* box, const base::Point& origin);

  /// Adds an object at its start pose. Throws std::invalid_argument if it is invalid.
  void Add(MovableObject object);
  /// Removes an object; the indices of those behind it decrease by one. Throws std::out_of_range without such an
  /// object.
  void Remove(int object);
  /// Moves an object to a pose, at rest. Throws std::out_of_range without such an object.
  void SetPose(int object, const base::Pose& pose);
  /// Takes over the poses that Box2D computed in a step.
  void FinishStep();

  const std::vector<MovableObject>& all() const { return objects_; }
  const std::vector<base::Pose>& poses() const { return poses_; }
  const DiscGrid& grid() const { return grid_; }
  double max_radius() const { return max_radius_m_; }

  /// Returns the current pose of an object, also within a step.
  base::Pose PoseNow(int object) const;
  /// Returns whether any object moves: one at rest for half a second sleeps until something touches it.
  bool AnyMoves() const;
  /// Returns the longest distance that any object travels at its speed in a time [s].
  double Travel(double time_s) const;

 private:
  void Build(const MovableObject& object);
  void CheckIndex(int object) const;
  void Changed();

  const std::vector<MovableObject> first_;
  b2World* box_ = nullptr;
  base::Point origin_;
  b2Body* ground_ = nullptr;
  std::vector<MovableObject> objects_;
  std::vector<b2Body*> bodies_;
  std::vector<base::Pose> poses_;
  DiscGrid grid_;
  double max_radius_m_ = 0.0;
};

}  // namespace robotteamsim::world

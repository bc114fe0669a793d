#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/world/disc_grid.hpp"
#include "robotteamsim/world/doors.hpp"
#include "robotteamsim/world/drive.hpp"
#include "robotteamsim/world/movable_objects.hpp"
#include "robotteamsim/world/nearby_edges.hpp"
#include "robotteamsim/world/outline.hpp"
#include "robotteamsim/world/solid.hpp"

class b2Body;
class b2World;

namespace robotteamsim::world {

/// A robot: round, or a convex polygon that turns about base_link.
struct Robot {
  double radius = 0.2;  ///< [m]; a world makes it that of the disc around base_link that holds the footprint
  double mass = 5.0;    ///< [kg]
  DriveLimits drive;
  base::Pose start;
  Polygon footprint = {};  ///< in base_link, 3 to 8 corners counter-clockwise around it [m]; none: it is round
  bool is_present = true;  ///< whether it is there at the start
};

/// What is true: walls, doors, robots, and what they do to each other.
///
/// Box2D solves the contacts. They are without friction and take from a robot only the velocity that would press it
/// into something, so a robot that drives at a wall at an angle slides along it. Robots that touch nothing move in
/// double precision, exactly as their drives say; Box2D is asked only about those that could reach something within a
/// step. Equal worlds with equal calls are equal to the bit.
class World {
 public:
  /// Args: step: length of a step [s]; substeps: the parts of a step in which drives change speed; more are taken where
  /// a robot could move by more than half its radius in one.
  /// Throws std::invalid_argument on a piece that is not convex, counter-clockwise and of 3 to 8 corners, and on sizes
  /// that are not above 0.
  World(std::vector<Solid> solids, std::vector<Door> doors, std::vector<Robot> robots, double step, int substeps,
        std::vector<MovableObject> objects = {});
  ~World();

  /// Advances by one step; commands are one per robot, in base_link.
  /// Throws std::invalid_argument on the wrong number of commands and on one that is not finite; nothing moves then.
  void Step(const std::vector<base::Twist>& commands);

  const std::vector<Solid>& solids() const { return solids_; }
  const std::vector<Door>& doors() const { return doors_.all(); }
  /// The leaves that swing or slide, in the order of their doors.
  const std::vector<MovingLeaf>& leaves() const { return doors_.leaves(); }
  /// All doors as they are, in their order; equal versions mean equal states.
  const std::vector<DoorState>& door_states() const { return doors_.states(); }
  std::int64_t doors_version() const { return doors_.version(); }
  const std::vector<Robot>& robots() const { return robots_; }
  const std::vector<MovableObject>& objects() const { return objects_.all(); }

  /// Which robots are near a point.
  const DiscGrid& grid() const { return grid_; }
  /// How far the largest robot reaches from its base_link [m].
  double max_radius() const { return max_radius_; }

  /// Which objects are near a point.
  const DiscGrid& object_grid() const { return objects_.grid(); }
  /// How far the largest object reaches from its middle [m].
  double max_object_radius() const { return objects_.max_radius(); }
  /// Where the objects are.
  const std::vector<base::Pose>& object_poses() const { return objects_.poses(); }

  /// Which robots are there. One that is not has no body, is met by no beam, and obeys no command.
  const std::vector<bool>& present() const { return present_; }
  /// How often each robot has come, its start included.
  const std::vector<int>& arrivals() const { return arrivals_; }
  /// Where the robots are; NaN of one that is not there.
  const std::vector<base::Pose>& poses() const { return poses_; }
  /// The mean velocity of the last step as each body really moved, in the base_link of every moment: a robot that is
  /// blocked has none.
  const std::vector<base::Twist>& twists() const { return twists_; }
  /// The way of the last step, seen from where it began; being set elsewhere between steps is no way.
  const std::vector<base::Pose>& motions() const { return motions_; }
  /// Whether a robot touched something (within 5 mm) in the last step.
  const std::vector<bool>& in_contact() const { return in_contact_; }
  /// In which directions from its middle a robot touched something when it last did so in the last step: angles in
  /// base_link, ascending in (-pi, pi], those of one place as one; none where it touched nothing.
  const std::vector<double>& contact_angles(int robot) const { return contact_angles_.at(robot); }

  /// Puts a robot somewhere, standing still.
  void SetPose(int robot, const base::Pose& pose);
  /// Takes a robot off the floor, with all that is told of it. One that is not there stays so.
  void RemoveRobot(int robot);
  /// Puts a robot that is not there somewhere, standing still; one that is there is set there.
  void SpawnRobot(int robot, const base::Pose& pose);
  /// A robot in the way of a door that closes at once is pushed aside. A leaf that swings or slides goes there in the
  /// steps to come, and waits for what is in its way.
  void SetDoorClosed(int door, bool closed);
  /// Adds an object behind the others. Throws std::invalid_argument on one that cannot be.
  void AddObject(MovableObject object);
  /// Takes an object away; the indices of those behind it move up by one.
  void RemoveObject(int object);
  /// Puts an object somewhere, at rest.
  void SetObjectPose(int object, const base::Pose& pose);
  /// Begins again as new, doors and objects included.
  void Reset();

 private:
  struct Drive {
    DriveSpeed speed;
    base::Pose target;    // where the substep ends if nothing is in the way
    bool is_busy = true;  // whether the robot could touch something in this step, so that Box2D has its body
  };

  void CheckCommands(const std::vector<base::Twist>& commands) const;
  void AddRobot(const Robot& robot);
  bool HoldsLeaf(const Polygon& now, const Polygon& next) const;
  base::Point BodyPosition(int robot) const;
  void SetBodyPose(int robot);
  DriveSpeed BodySpeed(int robot) const;
  double MaxTravel(const std::vector<base::Twist>& commands) const;
  bool CouldTouch(int robot, double travel) const;
  void SetBusy(int robot, bool is_busy);
  void StartDrive(int robot, const base::Twist& command);
  void FinishDrive(int robot);
  void NoteContacts(int robot, double yaw);

  const std::vector<Solid> solids_;
  const std::vector<Robot> robots_;
  const double step_;
  const int substeps_;
  const double dt_;
  // Where Box2D counts from, in the map frame: its floats keep half a millimetre for 4 km only.
  const base::Point origin_;
  const double max_radius_;
  double max_travel_;  // of anything in a step [m]
  NearbyEdges edges_;

  std::unique_ptr<b2World> box_;
  std::vector<b2Body*> robot_bodies_;
  Doors doors_;
  MovableObjects objects_;
  DiscGrid grid_;
  std::vector<Drive> drives_;
  std::vector<bool> present_;
  std::vector<int> arrivals_;
  std::vector<base::Pose> poses_;
  std::vector<base::Twist> twists_;
  std::vector<base::Pose> motions_;
  std::vector<bool> in_contact_;
  std::vector<std::vector<double>> contact_angles_;
};

}  // namespace robotteamsim::world

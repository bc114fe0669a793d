#pragma once

#include <cstdint>
#include <limits>
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

/// The pose of an absent robot.
constexpr base::Pose kNowhere{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(),
                              std::numeric_limits<double>::quiet_NaN()};

/// A robot: round, or a convex polygon that turns about base_link.
struct Robot {
  double radius_m = 0.2;  ///< a world sets it to that of the disc around base_link that contains the footprint
  double mass_kg = 5.0;
  DriveLimits drive;
  base::Pose start;
  Polygon footprint = {};  ///< in base_link, 3 to 8 corners counter-clockwise around it [m]; none: it is round
  bool is_present = true;  ///< whether it is there at the start
};

/// The physical world: walls, doors, robots and objects, and their contacts.
///
/// Box2D solves the contacts. They have no friction and remove only the velocity that would press a robot into
/// something, so a robot that meets a wall at an angle slides along it. Robots that touch nothing move in double
/// precision, exactly as their drives do; Box2D handles only those that could reach something within a step. Equal
/// worlds with equal calls are equal to the bit.
class World {
 public:
  /// Args: step_s: length of a step [s]; substeps: parts of a step, each with constant speed; there are more if a robot
  /// could move by more than half its radius in one.
  /// Throws std::invalid_argument if a piece is not convex and counter-clockwise with 3 to 8 corners, or a size is not
  /// above 0.
  World(std::vector<Solid> solids, std::vector<Door> doors, std::vector<Robot> robots, double step_s, int substeps,
        std::vector<MovableObject> objects = {});
  ~World();

  /// Advances by one step; commands are one per robot, in base_link.
  /// Throws std::invalid_argument if the number of commands is wrong or a command is not finite; nothing has moved
  /// then.
  void Step(const std::vector<base::Twist>& commands);

  const std::vector<Solid>& solids() const { return solids_; }
  const std::vector<Door>& doors() const { return doors_.all(); }
  /// The leaves that swing or slide, in the order of their doors.
  const std::vector<MovingLeaf>& leaves() const { return doors_.leaves(); }
  /// The states of all doors in their order; equal versions mean equal states.
  const std::vector<DoorState>& door_states() const { return doors_.states(); }
  std::int64_t doors_version() const { return doors_.version(); }
  const std::vector<Robot>& robots() const { return robots_; }
  const std::vector<MovableObject>& objects() const { return objects_.all(); }

  /// The grid to find robots near a point.
  const DiscGrid& grid() const { return grid_; }
  /// The greatest radius of any robot [m].
  double max_radius() const { return max_radius_m_; }

  /// The grid to find objects near a point.
  const DiscGrid& object_grid() const { return objects_.grid(); }
  /// The greatest radius of any object [m].
  double max_object_radius() const { return objects_.max_radius(); }
  /// The poses of the objects.
  const std::vector<base::Pose>& object_poses() const { return objects_.poses(); }

  /// Whether each robot is there. A robot that is not there has no body, returns no beam and ignores commands.
  const std::vector<bool>& present() const { return present_; }
  /// How often each robot has arrived, the start included.
  const std::vector<int>& arrivals() const { return arrivals_; }
  /// The poses of the robots; NaN for one that is not there.
  const std::vector<base::Pose>& poses() const { return poses_; }
  /// The mean velocity of each body in the last step, in base_link: 0 for a blocked robot.
  const std::vector<base::Twist>& twists() const { return twists_; }
  /// The motion of the last step, in the frame of its beginning; teleporting between steps does not count.
  const std::vector<base::Pose>& motions() const { return motions_; }
  /// Whether each robot touched something (within 5 mm) in the last step.
  const std::vector<bool>& in_contact() const { return in_contact_; }
  /// The directions of a robot's last contacts in the last step: angles in base_link, ascending in (-pi, pi], one per
  /// place; empty without contact.
  const std::vector<double>& contact_angles(int robot) const { return contact_angles_.at(robot); }

  /// Moves a robot to a pose, at rest.
  /// Throws std::invalid_argument if the pose is not finite; nothing has moved then.
  void SetPose(int robot, const base::Pose& pose);
  /// Removes a robot from the floor; no effect if it is not there.
  void RemoveRobot(int robot);
  /// Places a robot that is not there at a pose, at rest; a robot that is there is moved.
  void SpawnRobot(int robot, const base::Pose& pose);
  /// A robot in an instant door is pushed aside. A leaf that swings or slides moves in the next steps and waits while
  /// something blocks it.
  void SetDoorClosed(int door, bool closed);
  /// Adds an object after the others. Throws std::invalid_argument if it is invalid.
  void AddObject(MovableObject object);
  /// Removes an object; the indices of those behind it decrease by one. Throws std::out_of_range without such an
  /// object.
  void RemoveObject(int object);
  /// Moves an object to a pose, at rest. Throws std::out_of_range without such an object.
  void SetObjectPose(int object, const base::Pose& pose);
  /// Restarts the world, doors and objects included.
  void Reset();

 private:
  struct Drive {
    DriveSpeed speed;
    base::Pose target;    // the end of the substep if nothing blocks the robot
    bool is_busy = true;  // whether the robot could touch something in this step: then Box2D moves its body
  };

  void AddRobot(const Robot& robot);
  bool HoldsLeaf(const Polygon& now, const Polygon& next) const;
  base::Point BodyPosition(int robot) const;
  void SetBodyPose(int robot);
  void Place(int robot, const base::Pose& pose);
  DriveSpeed BodySpeed(int robot) const;
  double MaxTravel(const std::vector<base::Twist>& commands) const;
  bool CouldTouch(int robot, double travel_m) const;
  void SetBusy(int robot, bool is_busy);
  void StartDrive(int robot, const base::Twist& command);
  void FinishDrive(int robot);
  void NoteContacts(int robot, double yaw);

  const std::vector<Solid> solids_;
  const std::vector<Robot> robots_;
  const double step_s_;
  const int substeps_;
  const double dt_s_;
  // The origin of Box2D in the map frame: its floats resolve half a millimetre only within 4 km.
  const base::Point origin_;
  const double max_radius_m_;
  double max_travel_m_;  // of anything in a step
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

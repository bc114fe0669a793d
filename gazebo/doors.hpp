// The doors of a world, each a model door_<name> whose leaf a joint holds.
//
//   <door>
//     <model>door_entrance</model>
//     <joint>leaf_joint</joint>      at 0 at the start, at its other limit in the other state
//     <closed>true</closed>          at the start
//     <time_s>2</time_s>             from one state to the other [s]; 0: at once
//   </door>
//
// A leaf never pushes anything: it waits while it would come within 5 mm of a robot or object. Nothing pushes it
// either.
#pragma once

#include <robotteamsim/Doors.h>

#include <gazebo/physics/PhysicsTypes.hh>
#include <mutex>
#include <sdf/sdf.hh>
#include <string>
#include <vector>

namespace robotteamsim::gazebo_plugins {

class Door {
 public:
  // Throws std::invalid_argument: the world has no such model or joint.
  Door(const gazebo::physics::WorldPtr& world, const sdf::ElementPtr& settings);

  const std::string& name() const { return name_; }
  void SetWanted(bool closed) { wants_other_ = closed != closed_at_start_; }
  // Before each physics step: moves the leaf, or keeps it where it is.
  void Move(double duration_s);
  robotteamsim::Door State() const;

 private:
  double Next(double duration_s) const;
  // Returns the distance to the nearest robot or object [m].
  double Clearance() const;
  double Distance(const gazebo::physics::ModelPtr& model) const;

  gazebo::physics::WorldPtr world_;
  gazebo::physics::ModelPtr model_;
  gazebo::physics::JointPtr joint_;
  std::string name_;
  bool closed_at_start_;
  double time_s_;
  double other_;           // position of the joint in the other state
  double position_ = 0.0;  // of the joint
  bool wants_other_ = false;
  std::string motion_ = "still";
};

class Doors {
 public:
  // Throws std::invalid_argument.
  Doors(const gazebo::physics::WorldPtr& world, const sdf::ElementPtr& settings);

  bool empty() const { return doors_.empty(); }

  // Opens or closes a door from the next physics step on; from any thread. Throws std::invalid_argument: no such door.
  void Request(const std::string& name, bool closed);
  void Move(double duration_s);
  // Returns the state of all doors; stamp and frame are empty.
  robotteamsim::Doors States() const;

 private:
  mutable std::mutex mutex_;
  std::vector<Door> doors_;
};

}  // namespace robotteamsim::gazebo_plugins

// The plugin of a robot: commands in, readings out. The topics are in the namespace of the model's name.
//
//   <plugin name="robotteamsim" filename="librobotteamsim_gazebo.so">
//     <drive>velocity</drive>                     velocity or wheels, see drives.hpp
//     <step_s>0.1</step_s>                        interval of the readings [s]
//     <cmd_vel_hold_s>0.8</cmd_vel_hold_s>        time for which the last command holds [s]
//     <no_return>range_max</no_return>            range of a beam without a return: range_max or inf
//   </plugin>
//
// All elements are optional; these are their defaults. With the parameter ~localization of the node /gazebo, none
// (default) or ground_truth, tf contains map -> odom, as of our own world. The parameter ~robots lists the models that
// this world moves, such as "robot_2", separated by blanks; others follow their base_pose_ground_truth. By default it
// moves all.
#include <ros/param.h>

#include <exception>
#include <gazebo/common/Events.hh>
#include <gazebo/common/Plugin.hh>
#include <gazebo/physics/physics.hh>
#include <memory>
#include <sstream>
#include <string>

#include "follower.hpp"
#include "robot_bridge.hpp"
#include "ros_connection.hpp"

namespace robotteamsim::gazebo_plugins {
namespace {

namespace physics = gazebo::physics;

bool IsMovedHere(const std::string& robot) {
  StartedNode();
  std::istringstream names(ros::param::param<std::string>("~robots", ""));
  std::string name;
  if (!(names >> name)) return true;
  do {
    if (name == robot) return true;
  } while (names >> name);
  return false;
}

}  // namespace

class RobotPlugin : public gazebo::ModelPlugin {
 public:
  void Load(physics::ModelPtr model, sdf::ElementPtr settings) override {
    using gazebo::event::Events;
    try {
      if (!IsMovedHere(model->GetName())) {
        follower_ = std::make_unique<Follower>(model);
        before_ = Events::ConnectWorldUpdateBegin(
            [this](const gazebo::common::UpdateInfo&) { follower_->BeforePhysicsStep(); });
        return;
      }
      robot_ = std::make_unique<RobotBridge>(model, settings);
    } catch (const std::exception& error) {
      gzerr << "model '" << model->GetName() << "', plugin robotteamsim: " << error.what() << std::endl;
      return;
    }
    before_ =
        Events::ConnectWorldUpdateBegin([this](const gazebo::common::UpdateInfo&) { robot_->BeforePhysicsStep(); });
    after_ = Events::ConnectWorldUpdateEnd([this] { robot_->AfterPhysicsStep(); });
  }

  void Reset() override {
    if (robot_) robot_->Restart();
  }

 private:
  std::unique_ptr<RobotBridge> robot_;
  std::unique_ptr<Follower> follower_;
  gazebo::event::ConnectionPtr before_;
  gazebo::event::ConnectionPtr after_;
};

GZ_REGISTER_MODEL_PLUGIN(RobotPlugin)

}  // namespace robotteamsim::gazebo_plugins

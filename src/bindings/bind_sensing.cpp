// Floor 3: what robots perceive.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "fast_calls.hpp"
#include "robotteamsim/sensing/laser.hpp"
#include "robotteamsim/sensing/odometry.hpp"
#include "tuples.hpp"
#include "world_arrays.hpp"

namespace py = pybind11;

namespace robotteamsim::bindings {
namespace {

// One scan per robot: float32 of shape (robots, beams); noise has the same shape, or no element at all.
py::array_t<float> Scan(const Laser& laser, const World& world, const std::vector<int>& robot_ids,
                        const Doubles& noise_m) {
  const auto count = static_cast<py::ssize_t>(robot_ids.size()), beams = static_cast<py::ssize_t>(laser.NumBeams());
  if (noise_m.size() != 0 && noise_m.size() != count * beams) {
    throw std::invalid_argument("noise must have one value per beam");
  }
  py::array_t<float> scans = NewArray<float>({count, beams});
  for (py::ssize_t i = 0; i < count; ++i) {
    const double* const noise = noise_m.size() == 0 ? nullptr : noise_m.data() + i * beams;
    laser.Report(laser.Scan(world, robot_ids[i]), noise, scans.mutable_data(i, 0));
  }
  return scans;
}

// The nearest return of each robot, as a sonar reports it: float32 of shape (robots,); noise likewise, or empty.
py::array_t<float> Nearest(const Laser& laser, const World& world, const std::vector<int>& robot_ids,
                           const Doubles& noise_m) {
  const auto count = static_cast<py::ssize_t>(robot_ids.size());
  if (noise_m.size() != 0 && noise_m.size() != count)
    throw std::invalid_argument("noise must have one value per robot");
  py::array_t<float> nearest(count);
  for (py::ssize_t i = 0; i < count; ++i) {
    const double* const noise = noise_m.size() == 0 ? nullptr : noise_m.data() + i;
    const std::vector<double> ranges = laser.Scan(world, robot_ids[i]);
    laser.Report({*std::min_element(ranges.begin(), ranges.end())}, noise, nearest.mutable_data(i));
  }
  return nearest;
}

/// Makes `RobotReading`s of the arrays of a team: of a few robots that is most of what sensing takes in Python.
class ReadingMaker {
 public:
  ReadingMaker(py::type pose, py::type twist, py::type odometry, py::type reading)
      : pose_(std::move(pose)),
        twist_(std::move(twist)),
        odometry_(std::move(odometry)),
        reading_(std::move(reading)),
        tuple_(py::type::of(py::tuple())) {}

  // Arguments as the fields of `TeamReadings`; `further` of all robots, or empty, and then `nothing` is that of each.
  py::tuple Make(const Doubles& ground_truth, const Doubles& twists, const Doubles& odometry,
                 const py::sequence& ranges, const Flags& in_contact, const py::dict& contact_angles,
                 const py::sequence& further, const py::object& nothing) const {
    const auto n = static_cast<py::ssize_t>(ranges.size());
    if (ground_truth.size() != 4 * n || twists.size() != 3 * n || odometry.size() != 16 * n || in_contact.size() != n) {
      throw std::invalid_argument("arrays of readings must have a row per robot");
    }
    const bool has_further = further.size() > 0;
    const py::object no_angles = py::tuple();
    py::tuple readings(n);
    for (py::ssize_t i = 0; i < n; ++i) {
      const double* const odom = odometry.data() + 16 * i;
      py::object believed =
          odometry_.Of({pose_.OfNumbers(odom, 4).release().ptr(), twist_.OfNumbers(odom + 4, 3).release().ptr(),
                        tuple_.OfNumbers(odom + 7, 6).release().ptr(), tuple_.OfNumbers(odom + 13, 3).release().ptr()});
      py::object angles = in_contact.data()[i] ? AnglesOf(contact_angles, i, no_angles) : no_angles;
      py::object rest = has_further ? py::object(further[i]) : nothing;
      PyTuple_SET_ITEM(readings.ptr(), i,
                       reading_
                           .Of({pose_.OfNumbers(ground_truth.data() + 4 * i, 4).release().ptr(),
                                twist_.OfNumbers(twists.data() + 3 * i, 3).release().ptr(), believed.release().ptr(),
                                py::object(ranges[i]).release().ptr(), py::bool_(in_contact.data()[i]).release().ptr(),
                                angles.release().ptr(), rest.release().ptr()})
                           .release()
                           .ptr());
    }
    return readings;
  }

 private:
  static py::object AnglesOf(const py::dict& contact_angles, py::ssize_t robot, const py::object& none) {
    const py::int_ id(robot);
    return contact_angles.contains(id) ? py::object(contact_angles[id]) : none;
  }

  TupleClass pose_, twist_, odometry_, reading_, tuple_;
};

std::vector<Odometry> ToTeam(const std::vector<std::array<double, 4>>& alphas, double step_s,
                             const std::vector<bool>& omni) {
  if (omni.size() != alphas.size()) throw std::invalid_argument("omni must have one value per robot");
  std::vector<Odometry> team;
  for (std::size_t i = 0; i < alphas.size(); ++i) {
    const auto& [alpha1, alpha2, alpha3, alpha4] = alphas[i];
    team.emplace_back(OdometryModel{alpha1, alpha2, alpha3, alpha4}, step_s, omni[i]);
  }
  return team;
}

/// The odometry of all robots of a team.
class TeamOdometry {
 public:
  TeamOdometry(const std::vector<std::array<double, 4>>& alphas, double step_s, const std::vector<bool>& omni)
      : first_(ToTeam(alphas, step_s, omni)), team_(first_) {}

  // Begins a robot's anew, at its origin.
  void Restart(int robot_id) { team_.at(robot_id) = first_.at(robot_id); }

  // Rows of motions, twists and noise are those of the robots; returns x, y, qz, qw, vx, vy, turn of each, then the
  // covariance of x, y, yaw (upper triangle), then the variances of vx, vy and turn.
  py::array_t<double> Step(const Doubles& motions, const Doubles& twists, const Doubles& noise) {
    for (const Doubles* rows : {&motions, &twists, &noise}) CheckCount(static_cast<std::size_t>(rows->size()), 3);
    const double *const motion = motions.data(), *const twist = twists.data(), *const normal = noise.data();
    for (std::size_t i = 0, at = 0; i < team_.size(); ++i, at += 3) {
      team_[i].Step({motion[at], motion[at + 1], motion[at + 2]}, {twist[at], twist[at + 1], twist[at + 2]},
                    {normal[at], normal[at + 1], normal[at + 2]});
    }
    return Readings();
  }

  // The same for the step that a world made last.
  py::array_t<double> Follow(const World& world, const Doubles& noise) {
    CheckCount(static_cast<std::size_t>(noise.size()), 3);
    CheckCount(world.motions().size(), 1);
    const double* const normal = noise.data();
    for (std::size_t i = 0, at = 0; i < team_.size(); ++i, at += 3) {
      team_[i].Step(world.motions()[i], world.twists()[i], {normal[at], normal[at + 1], normal[at + 2]});
    }
    return Readings();
  }

 private:
  void CheckCount(std::size_t count, std::size_t per_robot) const {
    if (count != per_robot * team_.size()) {
      throw std::invalid_argument("motions, twists and noise must be three per robot");
    }
  }

  py::array_t<double> Readings() const {
    py::array_t<double> readings = NewArray<double>({static_cast<py::ssize_t>(team_.size()), py::ssize_t{16}});
    double* row = readings.mutable_data();
    for (const Odometry& odometry : team_) {
      WritePoseReading(odometry.pose(), row);
      row[4] = odometry.twist().linear_x;
      row[5] = odometry.twist().linear_y;
      row[6] = odometry.twist().angular_z;
      const PoseCovariance& p = odometry.covariance();
      const double rest[] = {p.xx,
                             p.xy,
                             p.x_yaw,
                             p.yy,
                             p.y_yaw,
                             p.yaw_yaw,
                             odometry.speed_variance(),
                             odometry.sideways_variance(),
                             odometry.turn_variance()};
      row = std::copy(std::begin(rest), std::end(rest), row + 7);
    }
    return readings;
  }

  std::vector<Odometry> first_;
  std::vector<Odometry> team_;
};

/// All that sensors of a team tell, in one call: of a few robots the calls are most of what sensing takes.
class TeamSensors {
 public:
  // Args: lasers: of each kind the laser and the robots that have it; every robot has one.
  //       readings, fields: the class `TeamReadings` and the names of its fields.
  TeamSensors(py::object odometry, const std::vector<std::pair<py::object, std::vector<int>>>& lasers,
              py::type readings, const std::vector<std::string>& fields)
      : odometry_(std::move(odometry)), team_(odometry_.cast<TeamOdometry*>()), readings_(std::move(readings), fields) {
    for (const auto& [laser, robots] : lasers) {
      kinds_.push_back({laser, laser.cast<const Laser*>(), robots});
      num_robots_ += robots.size();
    }
  }

  // `TeamReadings` of the step that the world made last. Args: odometry_noise: a row per robot; laser_noise: of each
  // kind, as Scan has it; none where none has any; further: as the field is.
  py::object Read(const World& world, const Doubles& odometry_noise, const std::vector<Doubles>& laser_noise,
                  const py::object& further) {
    if (!laser_noise.empty() && laser_noise.size() != kinds_.size()) {
      throw std::invalid_argument("lasers of each kind must have their noise");
    }
    py::object believed = team_->Follow(world, odometry_noise), ranges = Ranges(world, laser_noise);
    return readings_.Of({PoseReadings(world), Positions(world), ToArray(world.twists()), std::move(believed),
                         std::move(ranges), ToFlags(world.in_contact()), ContactAngles(world), further, py::tuple()});
  }

 private:
  // The scans in the order of robots, of one kind as one array.
  py::object Ranges(const World& world, const std::vector<Doubles>& laser_noise) const {
    const auto scans_of = [&](std::size_t kind) {
      return Scan(*kinds_[kind].core, world, kinds_[kind].robots, laser_noise.empty() ? Doubles() : laser_noise[kind]);
    };
    if (kinds_.size() == 1) return scans_of(0);
    py::list ranges(num_robots_);
    for (std::size_t kind = 0; kind < kinds_.size(); ++kind) {
      const std::vector<int>& robots = kinds_[kind].robots;
      const py::array_t<float> scans = scans_of(kind);
      for (std::size_t i = 0; i < robots.size(); ++i) ranges[robots[i]] = scans[py::int_(i)];
    }
    return ranges;
  }

  struct Kind {
    py::object laser;  // keeps it
    const Laser* core;
    std::vector<int> robots;
  };

  py::object odometry_;  // keeps the team's
  TeamOdometry* team_;
  SlotsClass readings_;
  std::vector<Kind> kinds_;
  std::size_t num_robots_ = 0;
};

}  // namespace

void BindSensing(py::module_& m) {
  py::class_<ReadingMaker> maker(m, "ReadingMaker");
  maker.def(py::init<py::type, py::type, py::type, py::type>(), py::arg("pose"), py::arg("twist"), py::arg("odometry"),
            py::arg("reading"));
  DefFast<&ReadingMaker::Make>(maker, "make");
  py::class_<Laser>(m, "Laser")
      .def(py::init([](const std::vector<Solid>& solids, const std::vector<Door>& doors, int beams,
                       double angle_min_rad, double angle_max_rad, double forward_m, double range_min_m,
                       double range_max_m, double too_near_m, double no_return_m, double left_m) {
             return Laser({beams, angle_min_rad, angle_max_rad, forward_m, range_min_m, range_max_m, too_near_m,
                           no_return_m, left_m},
                          solids, doors);
           }),
           py::arg("solids"), py::arg("doors"), py::kw_only(), py::arg("beams"), py::arg("angle_min_rad"),
           py::arg("angle_max_rad"), py::arg("forward_m"), py::arg("range_min_m"), py::arg("range_max_m"),
           py::arg("too_near_m"), py::arg("no_return_m"), py::arg("left_m"))
      .def("scan", &Scan, py::arg("world"), py::arg("robot_ids"), py::arg("noise_m"))
      .def("nearest", &Nearest, py::arg("world"), py::arg("robot_ids"), py::arg("noise_m"));
  py::class_<TeamOdometry>(m, "TeamOdometry")
      .def(py::init<const std::vector<std::array<double, 4>>&, double, const std::vector<bool>&>(), py::arg("alphas"),
           py::arg("step_s"), py::arg("omni"))
      .def("restart", &TeamOdometry::Restart, py::arg("robot_id"))
      .def("step", &TeamOdometry::Step, py::arg("motions"), py::arg("twists"), py::arg("noise"))
      .def("follow", &TeamOdometry::Follow, py::arg("world"), py::arg("noise"));
  py::class_<TeamSensors> sensors(m, "TeamSensors");
  sensors.def(py::init<py::object, const std::vector<std::pair<py::object, std::vector<int>>>&, py::type,
                       const std::vector<std::string>&>(),
              py::arg("odometry"), py::arg("lasers"), py::arg("readings"), py::arg("fields"));
  DefFast<&TeamSensors::Read>(sensors, "read");
}

}  // namespace robotteamsim::bindings

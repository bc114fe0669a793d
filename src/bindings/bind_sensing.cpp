// Floor 3: what robots perceive.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "robotteamsim/sensing/laser.hpp"
#include "robotteamsim/sensing/odometry.hpp"

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
  py::array_t<float> scans({count, beams});
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

// The rows of an array, cut into tuples of given types and lengths, side by side: for each part a list of one tuple per
// row. A type is `tuple` or a class of it that adds nothing, as a NamedTuple does.
std::vector<py::list> Tuples(const Doubles& rows, const std::vector<std::pair<py::type, int>>& parts) {
  if (rows.ndim() != 2) throw std::invalid_argument("rows must have shape (n, columns)");
  int columns = 0;
  for (const auto& [type, length] : parts) {
    if (!PyType_IsSubtype(reinterpret_cast<PyTypeObject*>(type.ptr()), &PyTuple_Type) || length < 1) {
      throw std::invalid_argument("parts must be tuples with at least one element");
    }
    columns += length;
  }
  if (columns != rows.shape(1)) throw std::invalid_argument("parts must have as many elements as a row");
  std::vector<py::list> lists;
  const double* part = rows.data();
  for (const auto& [type, length] : parts) {
    auto* const cls = reinterpret_cast<PyTypeObject*>(type.ptr());
    py::list list(rows.shape(0));
    for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
      auto tuple = py::reinterpret_steal<py::object>(cls->tp_alloc(cls, length));
      if (!tuple) throw py::error_already_set();
      for (int k = 0; k < length; ++k) {
        PyTuple_SET_ITEM(tuple.ptr(), k, PyFloat_FromDouble(part[i * columns + k]));
      }
      PyList_SET_ITEM(list.ptr(), i, tuple.release().ptr());
    }
    lists.push_back(std::move(list));
    part += length;
  }
  return lists;
}

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
      : team_(ToTeam(alphas, step_s, omni)) {}

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
    py::array_t<double> readings({static_cast<py::ssize_t>(team_.size()), py::ssize_t{16}});
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

  std::vector<Odometry> team_;
};

}  // namespace

void BindSensing(py::module_& m) {
  m.def("tuples", &Tuples, py::arg("rows"), py::arg("parts"));
  py::class_<Laser>(m, "Laser")
      .def(py::init([](const World& world, int beams, double angle_min_rad, double angle_max_rad, double forward_m,
                       double range_min_m, double range_max_m, double too_near_m, double no_return_m, double left_m) {
             return Laser({beams, angle_min_rad, angle_max_rad, forward_m, range_min_m, range_max_m, too_near_m,
                           no_return_m, left_m},
                          world);
           }),
           py::arg("world"), py::kw_only(), py::arg("beams"), py::arg("angle_min_rad"), py::arg("angle_max_rad"),
           py::arg("forward_m"), py::arg("range_min_m"), py::arg("range_max_m"), py::arg("too_near_m"),
           py::arg("no_return_m"), py::arg("left_m"))
      .def("scan", &Scan, py::arg("world"), py::arg("robot_ids"), py::arg("noise_m"))
      .def("nearest", &Nearest, py::arg("world"), py::arg("robot_ids"), py::arg("noise_m"));
  py::class_<TeamOdometry>(m, "TeamOdometry")
      .def(py::init<const std::vector<std::array<double, 4>>&, double, const std::vector<bool>&>(), py::arg("alphas"),
           py::arg("step_s"), py::arg("omni"))
      .def("step", &TeamOdometry::Step, py::arg("motions"), py::arg("twists"), py::arg("noise"))
      .def("follow", &TeamOdometry::Follow, py::arg("world"), py::arg("noise"));
}

}  // namespace robotteamsim::bindings

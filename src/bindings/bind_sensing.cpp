// _core.sensing: ranges as they are reported, odometry and hearing.
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "casters.hpp"
#include "robotteamsim/sensing/range_report.hpp"
#include "robotteamsim/sensing/team_odometry.hpp"
#include "robotteamsim/sensing/team_state.hpp"
#include "robotteamsim/sensing/voice_sensor.hpp"

namespace nanobind::detail {

namespace sensing = robotteamsim::sensing;

template <>
struct type_caster<sensing::VoiceReading> {
  NB_TYPE_CASTER(sensing::VoiceReading, const_name("robotteamsim.sensing.readings.VoiceReading"))

  static handle from_cpp(const sensing::VoiceReading& heard, rv_policy /*policy*/, cleanup_list* /*cleanup*/) {
    // Kept for as long as the interpreter runs.
    static const handle record =
        object(module_::import_("robotteamsim.sensing.readings").attr("VoiceReading")).release();
    return record(heard.level_db, heard.heard, heard.local_best, heard.local_best_level_db).release();
  }
};

}  // namespace nanobind::detail

namespace robotteamsim::bindings {
namespace {

using sensing::OdometryState, sensing::RangeLimits, sensing::TeamOdometry, sensing::TeamState, sensing::VoiceSensor;
using Rows = Array<const double, -1, -1>;
using Ranges = Array<float, -1, -1>;

Ranges Reported(const RangeLimits& limits, const Rows& ranges_m, const Rows& noise_m) {
  auto reported_m = NewTable<float>(ranges_m.shape(0), ranges_m.shape(1));
  sensing::Report(limits, TableOf(ranges_m), TableOf(noise_m), TableOf(reported_m));
  return reported_m;
}

// An object of a module, such as a class, kept for as long as the interpreter runs.
nb::handle PythonObject(const char* module, const char* name) {
  return nb::object(nb::module_::import_(module).attr(name)).release();
}

nb::object RecordOf(const sensing::PoseReading& pose) {
  static const nb::handle record = PythonObject("robotteamsim.geometry", "PoseReading");
  return record(pose.x, pose.y, pose.qz, pose.qw);
}

// Row i of the odometry as an `OdometryReading`.
nb::object RecordOf(const OdometryState& odometry, std::size_t i) {
  static const nb::handle record = PythonObject("robotteamsim.sensing.readings", "OdometryReading");
  const auto& [xx, xy, x_yaw, yy, y_yaw, yaw_yaw] = odometry.pose_covariance[i];
  const auto& [forward, left, turn] = odometry.twist_variances[i];
  return record(RecordOf(odometry.pose[i]), odometry.twist[i], nb::make_tuple(xx, xy, x_yaw, yy, y_yaw, yaw_yaw),
                nb::make_tuple(forward, left, turn));
}

nb::list OdometryReadings(const OdometryState& odometry) {
  nb::list readings;
  for (std::size_t i = 0; i < odometry.pose.size(); ++i) readings.append(RecordOf(odometry, i));
  return readings;
}

// The robots as `RobotReading`s. Args: ranges_m: of each robot; contact_angles_rad, sensors: of those that have any, by
// id.
nb::list RobotReadings(const TeamState& state, const nb::sequence& ranges_m, const nb::dict& contact_angles_rad,
                       const nb::dict& sensors) {
  static const nb::handle record = PythonObject("robotteamsim.sensing.readings", "RobotReading");
  static const nb::handle nothing_sensed = PythonObject("robotteamsim.sensing.readings", "NOTHING_SENSED");
  if (nb::len(ranges_m) != state.size()) throw std::invalid_argument("ranges_m must have one item per robot");
  const nb::tuple no_angles;
  nb::list robots;
  for (std::size_t i = 0; i < state.size(); ++i) {
    const nb::int_ id(i);
    robots.append(record(RecordOf(state.true_pose[i]), state.true_twist[i], RecordOf(state.odometry, i), ranges_m[i],
                         state.contact[i] != 0, contact_angles_rad.get(id, no_angles),
                         sensors.get(id, nothing_sensed)));
  }
  return robots;
}

OdometryState OdometryOf(const Array<const double, -1, 4>& pose, const Triples& twist,
                         const Array<const double, -1, 6>& pose_covariance, const Triples& twist_variances) {
  OdometryState odometry{RecordsOf<sensing::PoseReading>(pose), RecordsOf<base::Twist>(twist),
                         RecordsOf<sensing::PoseCovariance>(pose_covariance),
                         RecordsOf<sensing::TwistVariances>(twist_variances)};
  sensing::Check(odometry);
  return odometry;
}

TeamState StateOf(const Array<const double, -1, 4>& true_pose, const Triples& true_twist, const OdometryState& odometry,
                  const Array<const bool, -1>& contact) {
  TeamState state{RecordsOf<sensing::PoseReading>(true_pose), RecordsOf<base::Twist>(true_twist), odometry,
                  ValuesOf<std::uint8_t>(contact)};
  sensing::Check(state);
  return state;
}

void BindState(nb::module_& m) {
  nb::class_<OdometryState>(m, "OdometryState")
      .def(
          "__init__",
          [](OdometryState* self, const Array<const double, -1, 4>& pose, const Triples& twist,
             const Array<const double, -1, 6>& pose_covariance, const Triples& twist_variances) {
            new (self) OdometryState(OdometryOf(pose, twist, pose_covariance, twist_variances));
          },
          nb::kw_only(), "pose"_a, "twist"_a, "pose_covariance"_a, "twist_variances"_a)
      .def_prop_ro("pose", [](const OdometryState& state) { return ViewOf<4>(state.pose); })
      .def_prop_ro("twist", [](const OdometryState& state) { return ViewOf<3>(state.twist); })
      .def_prop_ro("pose_covariance", [](const OdometryState& state) { return ViewOf<6>(state.pose_covariance); })
      .def_prop_ro("twist_variances", [](const OdometryState& state) { return ViewOf<3>(state.twist_variances); })
      .def("readings", &OdometryReadings,
           nb::sig("def readings(self) -> list[robotteamsim.sensing.readings.OdometryReading]"));
  nb::class_<TeamState>(m, "TeamState")
      .def(
          "__init__",
          [](TeamState* self, const Array<const double, -1, 4>& true_pose, const Triples& true_twist,
             const OdometryState& odometry, const Array<const bool, -1>& contact) {
            new (self) TeamState(StateOf(true_pose, true_twist, odometry, contact));
          },
          nb::kw_only(), "true_pose"_a, "true_twist"_a, "odometry"_a, "contact"_a)
      .def("__len__", &TeamState::size)
      .def_prop_ro(
          "positions_m", [](const TeamState& state) { return RowsOf<2>(state.positions()); }, nb::rv_policy::reference)
      .def_prop_ro("true_pose", [](const TeamState& state) { return ViewOf<4>(state.true_pose); })
      .def_prop_ro("true_twist", [](const TeamState& state) { return ViewOf<3>(state.true_twist); })
      .def_ro("odometry", &TeamState::odometry)
      .def_prop_ro("contact", [](const TeamState& state) { return FlagsIn(state.contact); })
      .def("readings", &RobotReadings,
           nb::sig("def readings(self, ranges_m: collections.abc.Sequence[numpy.ndarray] | numpy.ndarray, "
                   "contact_angles_rad: dict[int, tuple[float, ...]], "
                   "sensors: dict[int, collections.abc.Mapping[str, typing.Any]]) -> "
                   "list[robotteamsim.sensing.readings.RobotReading]"),
           "ranges_m"_a, "contact_angles_rad"_a, "sensors"_a);
}

void BindOdometry(nb::module_& m) {
  nb::class_<TeamOdometry>(m, "TeamOdometry")
      .def(
          "__init__",
          [](TeamOdometry* self, const std::vector<std::array<double, 4>>& alphas, double step_s,
             const std::vector<bool>& omni) {
            std::vector<sensing::OdometryModel> models;
            models.reserve(alphas.size());
            for (const auto& [alpha1, alpha2, alpha3, alpha4] : alphas)
              models.push_back({alpha1, alpha2, alpha3, alpha4});
            new (self) TeamOdometry(models, step_s, omni);
          },
          "alphas"_a, "step_s"_a, "omni"_a)
      .def("restart", &TeamOdometry::Restart, "robot_id"_a)
      .def(
          "step",
          [](TeamOdometry& odometry, const Triples& motions, const Triples& twists, const Triples& noise) {
            return odometry.Step(RecordsOf<base::Pose>(motions), RecordsOf<base::Twist>(twists),
                                 RecordsOf<sensing::Odometry::Noise>(noise));
          },
          "motions"_a, "twists"_a, "noise"_a)
      .def(
          "read_team",
          [](TeamOdometry& odometry, const world::TeamMotion& team, const Triples& noise) {
            return odometry.Read(team, RecordsOf<sensing::Odometry::Noise>(noise));
          },
          "team"_a, "noise"_a);
}

void BindVoiceSensor(nb::module_& m) {
  nb::class_<VoiceSensor>(m, "VoiceSensor")
      .def(
          "__init__",
          [](VoiceSensor* self, const base::Point& origin_m, double resolution_m,
             const propagation::MapValues& levels_db, double radius_m) {
            const plan::GridShape grid{origin_m, resolution_m, static_cast<int>(levels_db.rows()),
                                       static_cast<int>(levels_db.cols())};
            new (self) VoiceSensor(grid, levels_db, radius_m);
          },
          "origin_m"_a, "resolution_m"_a, "levels_db"_a, "radius_m"_a)
      .def(
          "hear",
          [](VoiceSensor& sensor, const Points& positions_m) {
            return sensor.Hear(RecordsOf<base::Point>(positions_m));
          },
          "positions_m"_a);
}

}  // namespace

void BindSensing(nb::module_&& m) {
  nb::class_<RangeLimits>(m, "RangeLimits")
      .def(nb::init<double, double, double, double>(), nb::kw_only(), "range_min_m"_a, "range_max_m"_a, "too_near_m"_a,
           "no_return_m"_a);
  m.def("report", &Reported, "limits"_a, "ranges_m"_a, "noise_m"_a);
  m.def(
      "dim",
      [](const world::Fan& fan, const Triples& robots, const hazards::Haze& haze, double no_return_m,
         const Ranges& reported_m) {
        sensing::Dim(fan, RecordsOf<base::Pose>(robots), haze, no_return_m, TableOf(reported_m));
      },
      "fan"_a, "robots"_a, "haze"_a, "no_return_m"_a, "reported_m"_a);
  BindState(m);
  BindOdometry(m);
  BindVoiceSensor(m);
}

}  // namespace robotteamsim::bindings

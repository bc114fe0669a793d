// _core.state: the numbers of missions after a step, as arrays and as records of each robot.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "casters.hpp"
#include "mission_state.hpp"
#include "robotteamsim/state/state.hpp"

namespace robotteamsim::bindings {
namespace {

using state::State;

template <typename Value>
using View = nb::ndarray<const Value, nb::numpy, nb::c_contig, nb::device::cpu>;

/// A view of numbers that have this shape in each mission; with a leading axis unless the state is of one mission.
template <typename Value>
View<Value> ViewOf(const MissionState& of, const void* numbers, std::initializer_list<std::size_t> shape) {
  std::vector<std::size_t> extents(shape);
  if (!of.is_of_one()) extents.insert(extents.begin(), of.state().missions);
  return View<Value>(static_cast<const Value*>(numbers), extents.size(), extents.data());
}

/// Binds an array of records of `count` numbers per robot.
template <std::size_t count, typename Record>
void BindRows(nb::class_<MissionState>* bound, const char* name, std::vector<Record> State::*rows) {
  static_assert(sizeof(Record) == count * sizeof(double));
  bound->def_prop_ro(name, [rows](const MissionState& of) {
    return ViewOf<double>(of, (of.state().*rows).data(), {of.state().robots, count});
  });
}

/// Binds an array of a number per robot. Args: Value: in Python.
template <typename Value, typename Stored>
void BindNumbers(nb::class_<MissionState>* bound, const char* name, std::vector<Stored> State::*numbers) {
  static_assert(sizeof(Value) == sizeof(Stored));
  bound->def_prop_ro(name, [numbers](const MissionState& of) {
    return ViewOf<Value>(of, (of.state().*numbers).data(), {of.state().robots});
  });
}

/// Returns matrices. Throws std::invalid_argument if no links were written.
template <typename Stored>
const std::vector<Stored>& Written(const State& state, const std::vector<Stored>& cells) {
  if (cells.size() != state.Matrix(state.missions)) throw std::invalid_argument("this state has no links");
  return cells;
}

/// Binds a matrix of each mission.
template <typename Value, typename Stored>
void BindMatrix(nb::class_<MissionState>* bound, const char* name, std::vector<Stored> State::*cells) {
  static_assert(sizeof(Value) == sizeof(Stored));
  bound->def_prop_ro(name, [cells](const MissionState& of) {
    const State& state = of.state();
    return ViewOf<Value>(of, Written(state, state.*cells).data(), {state.robots, state.robots});
  });
}

// An object of a module, such as a class, kept for as long as the interpreter runs.
nb::handle PythonObject(const char* module, const char* name) {
  return nb::object(nb::module_::import_(module).attr(name)).release();
}

nb::object RecordOf(const state::PoseReading& pose) {
  static const nb::handle record = PythonObject("robotteamsim.geometry", "PoseReading");
  return record(pose.x, pose.y, pose.qz, pose.qw);
}

nb::object OdometryReading(const State& state, std::size_t robot) {
  static const nb::handle record = PythonObject("robotteamsim.sensing.readings", "OdometryReading");
  const auto& [xx, xy, x_yaw, yy, y_yaw, yaw_yaw] = state.odometry_pose_covariance[robot];
  const auto& [forward, left, turn] = state.odometry_twist_variances[robot];
  return record(RecordOf(state.odometry_pose[robot]), state.odometry_twist[robot],
                nb::make_tuple(xx, xy, x_yaw, yy, y_yaw, yaw_yaw), nb::make_tuple(forward, left, turn));
}

// The scan of a robot, of which the state keeps the memory.
nb::object RangesOf(nb::handle self, std::size_t robot) {
  const State& state = nb::cast<const MissionState&>(self).WithRobot(robot);
  return nb::cast(View<float>(&state.ranges_m[robot * state.beams], 1, &state.beams_of[robot], self));
}

// A robot's part of the state as a `RobotReading`. Args: ranges_m: its scan.
nb::object ReadingWith(const MissionState& of, std::size_t robot, const nb::object& ranges_m) {
  static const nb::handle record = PythonObject("robotteamsim.sensing.readings", "RobotReading");
  static const nb::handle nothing_sensed = PythonObject("robotteamsim.sensing.readings", "NOTHING_SENSED");
  static const nb::handle no_angles = nb::tuple().release();
  const State& state = of.WithRobot(robot);
  const auto& angles = state.contact_angles[robot];
  return record(RecordOf(state.true_pose[robot]), state.true_twist[robot], OdometryReading(state, robot), ranges_m,
                state.contact[robot] != 0, angles.empty() ? nb::borrow(no_angles) : nb::tuple(nb::cast(angles)),
                of.sensors.get(nb::int_(robot), nothing_sensed));
}

nb::object ReadingOf(nb::handle self, std::size_t robot) {
  return ReadingWith(nb::cast<const MissionState&>(self), robot, RangesOf(self, robot));
}

nb::list Readings(nb::handle self) {
  const auto& of = nb::cast<const MissionState&>(self);
  const State& state = of.one();
  const std::size_t shape[2] = {state.robots, state.beams};
  // Rows of one array are several times as fast as an array for each robot.
  const nb::object rows = nb::cast(View<float>(state.ranges_m.data(), 2, shape, self));
  nb::list readings;
  for (std::size_t i = 0; i < state.robots; ++i) {
    const bool has_all_beams = state.beams_of[i] == state.beams;
    readings.append(ReadingWith(of, i, has_all_beams ? nb::object(rows[i]) : RangesOf(self, i)));
  }
  return readings;
}

nb::object VoiceOf(const MissionState& of, std::size_t robot) {
  static const nb::handle record = PythonObject("robotteamsim.sensing.readings", "VoiceReading");
  const State& state = of.WithRobot(robot);
  return record(state.voice_level_db[robot], state.voice_heard[robot] != 0, state.local_best[robot],
                state.local_best_level_db[robot]);
}

nb::list Voices(const MissionState& of) {
  nb::list voices;
  for (std::size_t i = 0; i < of.state().robots; ++i) voices.append(VoiceOf(of, i));
  return voices;
}

// Reads an attribute of a record. Throws TypeError, naming it, if it is something else.
template <typename Value>
Value AttributeOf(nb::handle record, const char* name) {
  Value value;
  if (!nb::try_cast<Value>(record.attr(name), value))
    throw nb::type_error((std::string(name) + ": another type").c_str());
  return value;
}

template <typename Record, std::size_t count>
Record NumbersOf(nb::handle record, const std::array<const char*, count>& names) {
  static_assert(sizeof(Record) == count * sizeof(double));
  std::array<double, count> numbers;
  for (std::size_t i = 0; i < count; ++i) numbers[i] = AttributeOf<double>(record, names[i]);
  Record made;
  std::memcpy(&made, numbers.data(), sizeof made);
  return made;
}

template <typename Record>
Record TupleOf(nb::handle record, const char* name) {
  const auto numbers = AttributeOf<std::array<double, sizeof(Record) / sizeof(double)>>(record, name);
  Record made;
  std::memcpy(&made, numbers.data(), sizeof made);
  return made;
}

bool TruthOf(nb::handle record, const char* name) {
  const int truth = PyObject_IsTrue(nb::object(record.attr(name)).ptr());
  if (truth < 0) throw nb::python_error();
  return truth == 1;
}

constexpr std::array<const char*, 4> kPose{"x_m", "y_m", "qz", "qw"};

// Writes what a robot measures, wherever it does; nothing if something is wrong with it.
void PutReading(MissionState& of, std::size_t robot, nb::handle reading) {
  State& state = of.WithRobot(robot);
  const nb::object odometry = reading.attr("odometry"), sensors = reading.attr("sensors");
  const auto ranges_m = AttributeOf<Array<const float, -1>>(reading, "ranges_m");
  if (ranges_m.size() > state.beams) throw std::invalid_argument("ranges_m: more beams than the state has room for");
  const auto pose = NumbersOf<state::PoseReading>(reading.attr("ground_truth"), kPose);
  const auto twist = AttributeOf<base::Twist>(reading, "twist");
  const auto in_odom = NumbersOf<state::PoseReading>(odometry.attr("pose"), kPose);
  const auto measured_twist = AttributeOf<base::Twist>(odometry, "twist");
  const auto pose_covariance = TupleOf<state::PoseCovariance>(odometry, "pose_covariance");
  const auto twist_variances = TupleOf<state::TwistVariances>(odometry, "twist_variances");
  const auto angles = AttributeOf<std::vector<double>>(reading, "contact_angles_rad");
  const bool touches = TruthOf(reading, "in_contact");
  state.true_pose[robot] = pose;
  state.true_twist[robot] = twist;
  state.odometry_pose[robot] = in_odom;
  state.odometry_twist[robot] = measured_twist;
  state.odometry_pose_covariance[robot] = pose_covariance;
  state.odometry_twist_variances[robot] = twist_variances;
  float* const ranges = &state.ranges_m[robot * state.beams];
  std::fill(std::copy_n(ranges_m.data(), ranges_m.size(), ranges), ranges + state.beams,
            std::numeric_limits<float>::infinity());
  state.beams_of[robot] = ranges_m.size();
  state.contact[robot] = touches ? 1 : 0;
  state.contact_angles[robot] = angles;
  const nb::int_ id(robot);
  if (nb::len(sensors) > 0) {
    of.sensors[id] = sensors;
  } else if (of.sensors.contains(id)) {
    nb::del(of.sensors[id]);
  }
}

using Cells = Array<const double, -1, -1>;
using Flags = Array<const bool, -1, -1>;

// Writes the links of a mission, wherever they come from.
void PutLinks(MissionState& of, const Cells& rssi_dbm, const Flags& adjacency, const Flags& endangered,
              const Array<const std::int32_t, -1, -1>& hop_count, double fiedler_value, std::int64_t version) {
  State& state = of.one();
  const std::size_t robots = state.robots;
  const auto fits = [robots](const auto& matrix) { return matrix.shape(0) == robots && matrix.shape(1) == robots; };
  if (!fits(rssi_dbm) || !fits(adjacency) || !fits(endangered) || !fits(hop_count)) {
    throw std::invalid_argument("links must have one row and one column per robot");
  }
  state.NeedLinks(false);
  std::copy_n(rssi_dbm.data(), robots * robots, state.rssi_dbm.data());
  std::copy_n(adjacency.data(), robots * robots, state.adjacency.data());
  std::copy_n(endangered.data(), robots * robots, state.endangered.data());
  std::copy_n(hop_count.data(), robots * robots, state.hop_count.data());
  state.fiedler_value[0] = fiedler_value;
  state.links_version[0] = version;
  state.links_source[0] = 0;
}

// Writes what a robot hears.
void PutVoice(MissionState& of, std::size_t robot, nb::handle voice) {
  State& state = of.WithRobot(robot);
  const auto level_db = AttributeOf<double>(voice, "level_db"),
             best_db = AttributeOf<double>(voice, "local_best_level_db");
  const auto place = AttributeOf<base::Point>(voice, "local_best_m");
  state.voice_heard[robot] = TruthOf(voice, "heard") ? 1 : 0;
  state.voice_level_db[robot] = level_db;
  state.local_best[robot] = place;
  state.local_best_level_db[robot] = best_db;
}

}  // namespace

void BindState(nb::module_&& m) {
  nb::class_<MissionState> bound(m, "State");
  bound
      .def(
          "__init__",
          [](MissionState* self, std::size_t robots, std::size_t beams) {
            new (self) MissionState(std::make_shared<State>(1, robots, beams), true);
          },
          "robots"_a, "beams"_a = 0)
      .def(
          "of",
          [](const MissionState& all, std::size_t mission) {
            return MissionState(std::make_shared<State>(all.state().Of(mission)), true);
          },
          "mission"_a)
      .def("__len__", [](const MissionState& of) { return of.state().robots; })
      .def("__getitem__", &ReadingOf, "robot_id"_a,
           nb::sig("def __getitem__(self, robot_id: int) -> robotteamsim.sensing.readings.RobotReading"))
      .def("readings", &Readings, nb::sig("def readings(self) -> list[robotteamsim.sensing.readings.RobotReading]"))
      .def("voices", &Voices, nb::sig("def voices(self) -> list[robotteamsim.sensing.readings.VoiceReading]"))
      .def("voice_of", &VoiceOf, "robot_id"_a,
           nb::sig("def voice_of(self, robot_id: int) -> robotteamsim.sensing.readings.VoiceReading"))
      .def("ranges_of", &RangesOf, "robot_id"_a, nb::sig("def ranges_of(self, robot_id: int) -> numpy.ndarray"))
      .def(
          "place",
          [](MissionState& of, std::size_t robot, const base::Pose& pose) {
            of.WithRobot(robot).true_pose[robot] = state::ReadingOf(pose);
          },
          "robot_id"_a, "pose"_a)
      .def("put_reading", &PutReading, "robot_id"_a, "reading"_a)
      .def("put_links", &PutLinks, "rssi_dbm"_a, "adjacency"_a, "endangered"_a, "hop_count"_a, "fiedler_value"_a,
           "version"_a)
      .def("put_voice", &PutVoice, "robot_id"_a, "voice"_a)
      .def_rw("sensors", &MissionState::sensors)
      .def_prop_ro("fiedler_value", [](const MissionState& of) { return of.one().fiedler_value[0]; })
      .def_prop_ro("links_version", [](const MissionState& of) { return of.one().links_version[0]; })
      .def_prop_ro(
          "positions_m",
          [](nb::handle self) -> nb::object {
            return self.attr("true_pose")[nb::make_tuple(nb::ellipsis(), nb::slice(2))];
          },
          nb::sig("def positions_m(self, /) -> numpy.ndarray"))
      .def_prop_ro("ranges_m",
                   [](const MissionState& of) {
                     return ViewOf<float>(of, of.state().ranges_m.data(), {of.state().robots, of.state().beams});
                   })
      .def_prop_ro("link", [](const MissionState& of) {
        const State& state = of.state();
        const std::vector<double>& link = state.link.empty() ? state.rssi_dbm : state.link;
        return ViewOf<double>(of, Written(state, link).data(), {state.robots, state.robots});
      });
  bound.def_prop_ro("happened",
                    [](const MissionState& of) { return ViewOf<std::uint8_t>(of, of.state().happened.data(), {}); });
  BindRows<4>(&bound, "true_pose", &State::true_pose);
  BindRows<3>(&bound, "true_twist", &State::true_twist);
  BindRows<4>(&bound, "odometry_pose", &State::odometry_pose);
  BindRows<3>(&bound, "odometry_twist", &State::odometry_twist);
  BindRows<6>(&bound, "odometry_pose_covariance", &State::odometry_pose_covariance);
  BindRows<3>(&bound, "odometry_twist_variances", &State::odometry_twist_variances);
  BindRows<2>(&bound, "local_best_m", &State::local_best);
  BindNumbers<bool>(&bound, "contact", &State::contact);
  BindNumbers<double>(&bound, "voice_level_db", &State::voice_level_db);
  BindNumbers<bool>(&bound, "voice_heard", &State::voice_heard);
  BindNumbers<double>(&bound, "local_best_level_db", &State::local_best_level_db);
  BindMatrix<double>(&bound, "rssi_dbm", &State::rssi_dbm);
  BindMatrix<bool>(&bound, "adjacency", &State::adjacency);
  BindMatrix<bool>(&bound, "endangered", &State::endangered);
  BindMatrix<std::int32_t>(&bound, "hop_count", &State::hop_count);
  m.attr("PLACE_REACHED") = nb::int_(static_cast<int>(state::kPlaceReached));
  m.attr("LINKS_CHANGED") = nb::int_(static_cast<int>(state::kLinksChanged));
  m.attr("VOICE_CHANGED") = nb::int_(static_cast<int>(state::kVoiceChanged));
  m.attr("CONTACT") = nb::int_(static_cast<int>(state::kContact));
  m.attr("DOOR_MOVED") = nb::int_(static_cast<int>(state::kDoorMoved));
}

}  // namespace robotteamsim::bindings

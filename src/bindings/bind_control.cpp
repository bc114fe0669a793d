// _core.control: driving, the memory of a robot, and the belief over places of victims.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "casters.hpp"
#include "fields.hpp"
#include "mission_state.hpp"
#include "robotteamsim/control/cell_paths.hpp"
#include "robotteamsim/control/clearance.hpp"
#include "robotteamsim/control/navigator.hpp"
#include "robotteamsim/control/ruled_out.hpp"
#include "robotteamsim/control/surroundings.hpp"
#include "robotteamsim/control/unknown_in_view.hpp"
#include "robotteamsim/control/victim_belief.hpp"
#include "robotteamsim/control/voice_fix.hpp"
#include "robotteamsim/control/voice_losses.hpp"
#include "robotteamsim/state/pose_reading.hpp"

namespace nanobind::detail {

namespace control = robotteamsim::control;

template <>
struct type_caster<control::HeardNote>
    : TupleCaster<control::HeardNote, &control::HeardNote::position, &control::HeardNote::loudest> {};

template <>
struct type_caster<control::KeptOut>
    : TupleCaster<control::KeptOut, &control::KeptOut::center, &control::KeptOut::radius_m> {};

template <>
struct type_caster<control::ListeningPlace>
    : TupleCaster<control::ListeningPlace, &control::ListeningPlace::cell, &control::ListeningPlace::gain,
                  &control::ListeningPlace::rate_per_s> {};

template <>
struct type_caster<control::Spread>
    : TupleCaster<control::Spread, &control::Spread::mean, &control::Spread::deviation> {};

template <>
struct type_caster<control::VoiceFix::Source>
    : TupleCaster<control::VoiceFix::Source, &control::VoiceFix::Source::cell, &control::VoiceFix::Source::misfit> {};

}  // namespace nanobind::detail

namespace robotteamsim::bindings {
namespace {

using control::CellPaths, control::Navigator, control::RuledOut, control::Surroundings, control::VictimBelief,
    control::VoiceFix, control::VoiceLosses;
using Flags = Array<const bool, -1>;
using Floats = Array<const float, -1>;
using Ids = Array<const std::int32_t, -1>;

/// The last known places of robots [m, map], by ascending id; those who share them may be among them.
struct Places {
  Navigator::Teammates by_id;
};

using SharedGrid = std::shared_ptr<const plan::PlanningGrid>;
using SharedLosses = std::shared_ptr<const VoiceLosses>;

base::Twist Drive(Navigator& navigator, const SharedGrid& grid, const base::Pose& pose, const control::Ranges& ranges,
                  const base::Point& goal_m, double speed_mps, std::int64_t sim_time_ns, nb::handle teammates) {
  const auto ask = [&teammates, &navigator] {
    Navigator::Teammates others = nb::cast<const Places&>(teammates()).by_id;
    others.erase(std::remove_if(others.begin(), others.end(),
                                [&](const auto& one) { return one.first == navigator.robot_id(); }),
                 others.end());
    return others;
  };
  const double time_s = static_cast<double>(sim_time_ns) * 1e-9;
  return navigator.Drive(grid, pose, ranges, goal_m, speed_mps, time_s, ask);
}

/// A `Course` of Python: robot, navigator, grid, goal [m], speed limit [m/s], teammates, and until when.
using Course = std::tuple<int, Navigator*, SharedGrid, base::Point, double, nb::callable, std::int64_t>;

std::vector<base::Twist> DriveTeam(const MissionState& of, const std::vector<Course>& courses,
                                   std::int64_t sim_time_ns) {
  std::vector<base::Twist> commands;
  for (const auto& [robot, navigator, grid, goal_m, speed_mps, teammates, until_ns] : courses) {
    if (robot < 0) throw std::out_of_range("no such robot");
    const state::State& state = of.WithRobot(static_cast<std::size_t>(robot));
    const control::Ranges ranges{state.ranges_m.data() + robot * state.beams, state.beams_of[robot]};
    const base::Pose pose = state::PoseOf(state.true_pose[robot]);
    commands.push_back(Drive(*navigator, grid, pose, ranges, goal_m, speed_mps, sim_time_ns, teammates));
  }
  return commands;
}

void BindNavigator(nb::module_& m) {
  nb::class_<Places>(m, "Places")
      .def(
          "__init__",
          [](Places* self, const Ids& ids, const Points& places_m) {
            if (ids.size() != places_m.shape(0)) throw std::invalid_argument("expected as many ids as places");
            new (self) Places;
            for (std::size_t i = 0; i < ids.size(); ++i) {
              self->by_id.emplace_back(ids.data()[i], base::Point{places_m(i, 0), places_m(i, 1)});
            }
          },
          "ids"_a, "places_m"_a);
  nb::class_<control::NavigatorParameters> parameters(m, "NavigatorParameters");
  std::apply([&](const auto&... fields) { DefineFields(parameters, fields...); }, control::kNavigatorFields);
  nb::class_<control::LaserLayout>(m, "LaserLayout")
      .def(nb::init<int, double, double, double, double, double>(), nb::kw_only(), "beams"_a, "angle_min_rad"_a,
           "angle_max_rad"_a, "forward_m"_a, "range_max_m"_a, "left_m"_a);
  nb::class_<Navigator>(m, "Navigator")
      .def(
          "__init__",
          [](Navigator* self, int robot_id, double radius_m, const control::LaserLayout& laser, double max_speed_mps,
             double max_turn_radps, bool is_car, bool by_path, const control::NavigatorParameters& parameters) {
            new (self)
                Navigator({robot_id, radius_m, laser, max_speed_mps, max_turn_radps, is_car}, by_path, parameters);
          },
          nb::kw_only(), "robot_id"_a, "radius_m"_a, "laser"_a, "max_speed_mps"_a, "max_turn_radps"_a, "is_car"_a,
          "by_path"_a, "parameters"_a)
      .def(
          "drive",
          [](Navigator& navigator, const SharedGrid& grid, const base::Pose& pose, const Floats& ranges_m,
             const base::Point& goal_m, double speed_mps, std::int64_t sim_time_ns,
             const nb::typed<nb::callable, Places()>& teammates) {
            const control::Ranges ranges{ranges_m.data(), ranges_m.size()};
            return Drive(navigator, grid, pose, ranges, goal_m, speed_mps, sim_time_ns, teammates);
          },
          "grid"_a, "pose"_a, "ranges_m"_a, "goal_m"_a, "speed_mps"_a, "sim_time_ns"_a, "teammates"_a);
  m.def("drive_team", &DriveTeam, "state"_a, "courses"_a, "sim_time_ns"_a,
        "Return the commands of robots that only drive, each by its `Course`, from their true poses.");
  nb::class_<Surroundings>(m, "Surroundings")
      .def(nb::init<const control::LaserLayout&, int, double, const std::vector<double>&>(), nb::kw_only(), "laser"_a,
           "stride"_a, "sensing_radius_m"_a, "headings_rad"_a)
      .def(
          "clearest_place",
          [](const Surroundings& surroundings, const base::Pose& pose, const Floats& ranges_m) {
            return surroundings.ClearestPlace(pose, {ranges_m.data(), ranges_m.size()});
          },
          "pose"_a, "ranges_m"_a);
}

void BindRuledOut(nb::module_& m) {
  nb::class_<control::HeardNotes>(m, "HeardNotes")
      .def(nb::init<std::vector<control::HeardNote>>(), "heard"_a)
      .def_prop_ro("notes", &control::HeardNotes::notes);
  nb::class_<RuledOut>(m, "RuledOut")
      .def(nb::init<double, double, double>(), nb::kw_only(), "radius_m"_a, "cell_m"_a, "next_to_m"_a)
      .def("clear", &RuledOut::Clear)
      .def(
          "add",
          [](RuledOut& ruled_out, const base::Point& position, const std::optional<base::Point>& loudest) {
            ruled_out.Add(control::HeardNote{position, loudest});
          },
          "position_m"_a, "loudest_m"_a.none())
      .def("add_all", nb::overload_cast<control::HeardNotes*>(&RuledOut::Add), "heard"_a)
      .def("covers", &RuledOut::Covers, "place_m"_a);
}

void BindPaths(nb::module_& m) {
  nb::class_<CellPaths>(m, "CellPaths")
      .def(
          "__init__",
          [](CellPaths* self, const SharedGrid& grid, const base::Point& origin_m, double cell_m, int rows, int columns,
             const std::optional<control::KeptOut>& kept_out) {
            new (self) CellPaths(grid, {origin_m, cell_m, rows, columns}, kept_out);
          },
          nb::kw_only(), "grid"_a, "origin_m"_a, "cell_m"_a, "rows"_a, "columns"_a, "kept_out"_a.none())
      .def("cell_of", &CellPaths::CellOf, "point_m"_a)
      .def("start_of", &CellPaths::StartOf, "point_m"_a)
      .def("place_of", &CellPaths::PlaceOf, "cell"_a)
      .def(
          "lengths_from", [](const CellPaths& paths, int cell) { return ArrayOf(paths.LengthsFrom(cell)); }, "cell"_a)
      .def("length_m", &CellPaths::LengthBetween, "from_cell"_a, "to_cell"_a)
      .def("ahead", &CellPaths::Ahead, "position_m"_a, "goal_cell"_a, "longest_m"_a)
      .def(
          "way_within",
          [](const CellPaths& paths, const base::Point& position_m, const Flags& goals, const Flags& allowed,
             double longest_m) {
            std::optional<control::CellWay> way =
                paths.WayWithin(position_m, ValuesOf<std::uint8_t>(goals), ValuesOf<std::uint8_t>(allowed), longest_m);
            return way ? std::make_optional(std::make_pair(way->cells, way->ahead)) : std::nullopt;
          },
          "position_m"_a, "goals"_a, "allowed"_a, "longest_m"_a);
}

void BindLosses(nb::module_& m) {
  nb::class_<VoiceLosses>(m, "VoiceLosses")
      .def(
          "__init__",
          [](VoiceLosses* self, const propagation::FaceSet& faces, const base::Point& origin_m, double cell_m, int rows,
             int columns, double slope_db, double wall_unit_db, double min_distance_m, double nearer_m,
             double step_db) {
            new (self) VoiceLosses(faces, {origin_m, cell_m, rows, columns},
                                   {slope_db, wall_unit_db, min_distance_m, nearer_m, step_db});
          },
          nb::kw_only(), "faces"_a, "origin_m"_a, "cell_m"_a, "rows"_a, "columns"_a, "slope_db"_a, "wall_unit_db"_a,
          "min_distance_m"_a, "nearer_m"_a, "step_db"_a)
      .def(
          "losses_from", [](const VoiceLosses& losses, int cell) { return ArrayOf(losses.From(cell)); }, "cell"_a);
}

void BindBelief(nb::module_& m) {
  nb::class_<VictimBelief>(m, "VictimBelief")
      .def(
          "__init__",
          [](VictimBelief* self, const SharedLosses& losses, const Floats& prior) {
            new (self) VictimBelief(losses, ValuesOf<float>(prior));
          },
          "losses"_a, "prior"_a)
      .def("set_losses", &VictimBelief::SetLosses, "losses"_a)
      .def(
          "set_unheard",
          [](VictimBelief& belief, const Array<const float, VictimBelief::kNumLosses>& unheard) {
            VictimBelief::Unheard values;
            std::copy(unheard.data(), unheard.data() + unheard.size(), values.begin());
            belief.SetUnheard(values);
          },
          "unheard"_a)
      .def("listen", &VictimBelief::Listen, "cell"_a, "above"_a)
      .def("remaining", &VictimBelief::Remaining)
      .def("mass", [](const VictimBelief& belief) { return ArrayOf(belief.Mass()); })
      .def(
          "best",
          [](const VictimBelief& belief, const CellPaths& paths, int start, const std::vector<int>& candidates,
             const std::vector<int>& claims, double speed_mps, double delay_s) {
            return belief.Best(paths, start, candidates, {claims, speed_mps, delay_s});
          },
          "paths"_a, "start_cell"_a, "candidates"_a, "claims"_a, "speed_mps"_a, "delay_s"_a)
      .def(
          "worth",
          [](const VictimBelief& belief, const CellPaths& paths, int start, int cell, const std::vector<int>& claims,
             double speed_mps, double delay_s) {
            return belief.Worth(paths, start, cell, {claims, speed_mps, delay_s});
          },
          "paths"_a, "start_cell"_a, "cell"_a, "claims"_a, "speed_mps"_a, "delay_s"_a);
}

void BindFix(nb::module_& m) {
  nb::class_<VoiceFix>(m, "VoiceFix")
      .def(nb::init<SharedLosses, const control::Spread&, const control::Spread&>(), "losses"_a, "loudness_db"_a,
           "exponent"_a)
      .def("add", &VoiceFix::Add, "place_m"_a, "level_db"_a)
      .def_prop_ro("count", &VoiceFix::Count)
      .def(
          "most_probable",
          [](const VoiceFix& fix, const Floats& prior) { return fix.MostProbable(ValuesOf<float>(prior)); }, "prior"_a);
}

void BindExploration(nb::module_& m) {
  using control::RowAndCol;
  m.def(
      "unknown_in_view",
      [](const Array<const std::int8_t, -1, -1>& cells, const Array<const std::int32_t, -1, 2>& from,
         const Array<const std::int32_t, -1, -1, 2>& rays, const Array<const double, -1>& areas_m2) {
        const auto* const places = reinterpret_cast<const RowAndCol*>(from.data());
        const auto* const offsets = reinterpret_cast<const RowAndCol*>(rays.data());
        return ArrayOf(control::UnknownInView({cells.data(), cells.shape(0), cells.shape(1)},
                                              {places, places + from.shape(0)}, {offsets, rays.shape(0), rays.shape(1)},
                                              ValuesOf<double>(areas_m2)));
      },
      "cells"_a, "places"_a, "rays"_a, "areas_m2"_a);
}

}  // namespace

void BindControl(nb::module_&& m) {
  BindNavigator(m);
  BindRuledOut(m);
  BindLosses(m);
  BindPaths(m);
  BindBelief(m);
  BindFix(m);
  BindExploration(m);
}

}  // namespace robotteamsim::bindings

// _core.control: driving, the memory of a robot, and the belief over places of victims.
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "geometry.hpp"
#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/control/cell_paths.hpp"
#include "robotteamsim/control/clearance.hpp"
#include "robotteamsim/control/navigator.hpp"
#include "robotteamsim/control/ruled_out.hpp"
#include "robotteamsim/control/surroundings.hpp"
#include "robotteamsim/control/victim_belief.hpp"
#include "robotteamsim/control/voice_fix.hpp"
#include "robotteamsim/control/voice_losses.hpp"

namespace robotteamsim::bindings {
namespace {

using Scan = Array<const float, -1>;
using Heard = std::vector<std::pair<base::Point, std::optional<base::Point>>>;

control::Ranges RangesOf(const Scan& scan) { return {scan.data(), scan.size()}; }

base::Twist Drive(control::Navigator& navigator, const std::shared_ptr<const plan::PlanningGrid>& grid,
                  const base::Pose& pose, const Scan& ranges_m, const base::Point& goal_m, double speed_mps,
                  std::int64_t sim_time_ns, const nb::typed<nb::callable, std::map<int, base::Point>()>& teammates) {
  const auto ask = [&teammates] {
    const auto places = nb::cast<std::map<int, base::Point>>(teammates());
    return control::Navigator::Teammates(places.begin(), places.end());
  };
  const double time_s = static_cast<double>(sim_time_ns) * 1e-9;
  return navigator.Drive(grid, pose, RangesOf(ranges_m), goal_m, speed_mps, time_s, ask);
}

void BindParameters(nb::module_& m) {
  nb::class_<control::NavigatorParameters>(m, "NavigatorParameters")
      .def(
          "__init__",
          [](control::NavigatorParameters* self, double arrived_m, double laser_margin_m, double look_ahead_m,
             double longest_path_m, double turn_in_place_rad, double turn_gain_per_s, double braking_mps2,
             double manoeuvring_mps, double room_to_turn_m, double progress_m, double stuck_timeout_s,
             double yield_timeout_s, double escape_m, double escape_time_s, int escape_headings, double near_teammate_m,
             double nearest_free_start_m, double nearest_free_goal_m, double sidestep_left_penalty,
             double sidestep_change_penalty, double sidestep_ahead_rad) {
            new (self)
                control::NavigatorParameters{arrived_m,
                                             laser_margin_m,
                                             look_ahead_m,
                                             longest_path_m,
                                             turn_in_place_rad,
                                             turn_gain_per_s,
                                             braking_mps2,
                                             manoeuvring_mps,
                                             room_to_turn_m,
                                             progress_m,
                                             stuck_timeout_s,
                                             yield_timeout_s,
                                             escape_m,
                                             escape_time_s,
                                             escape_headings,
                                             near_teammate_m,
                                             nearest_free_start_m,
                                             nearest_free_goal_m,
                                             {sidestep_left_penalty, sidestep_change_penalty, sidestep_ahead_rad}};
          },
          nb::kw_only(), "arrived_m"_a, "laser_margin_m"_a, "look_ahead_m"_a, "longest_path_m"_a, "turn_in_place_rad"_a,
          "turn_gain_per_s"_a, "braking_mps2"_a, "manoeuvring_mps"_a, "room_to_turn_m"_a, "progress_m"_a,
          "stuck_timeout_s"_a, "yield_timeout_s"_a, "escape_m"_a, "escape_time_s"_a, "escape_headings"_a,
          "near_teammate_m"_a, "nearest_free_start_m"_a, "nearest_free_goal_m"_a, "sidestep_left_penalty"_a,
          "sidestep_change_penalty"_a, "sidestep_ahead_rad"_a);
}

void BindNavigator(nb::module_& m) {
  nb::class_<control::LaserLayout>(m, "LaserLayout")
      .def(
          "__init__",
          [](control::LaserLayout* self, int beams, double angle_min_rad, double angle_max_rad, double forward_m,
             double range_max_m) {
            new (self) control::LaserLayout{beams, angle_min_rad, angle_max_rad, forward_m, range_max_m};
          },
          nb::kw_only(), "beams"_a, "angle_min_rad"_a, "angle_max_rad"_a, "forward_m"_a, "range_max_m"_a);
  nb::class_<control::Navigator>(m, "Navigator")
      .def(
          "__init__",
          [](control::Navigator* self, int robot_id, double radius_m, const control::LaserLayout& laser,
             double max_speed_mps, double max_turn_radps, bool is_car, bool by_path,
             const control::NavigatorParameters& parameters) {
            const control::NavigatorBody body{robot_id, radius_m, laser, max_speed_mps, max_turn_radps, is_car};
            new (self) control::Navigator(body, by_path, parameters);
          },
          nb::kw_only(), "robot_id"_a, "radius_m"_a, "laser"_a, "max_speed_mps"_a, "max_turn_radps"_a, "is_car"_a,
          "by_path"_a, "parameters"_a)
      .def("drive", &Drive, "grid"_a, "pose"_a, "ranges_m"_a, "goal_m"_a, "speed_mps"_a, "sim_time_ns"_a,
           "teammates"_a);
}

// In `map`, where the robot is at `pose`.
std::optional<base::Point> ClearestPlace(const control::Surroundings& surroundings, const base::Pose& pose,
                                         const Scan& ranges_m) {
  base::Check(pose, "pose");
  const std::optional<base::Point> place = surroundings.ClearestPlace(RangesOf(ranges_m));
  if (!place) return std::nullopt;
  const double cos = std::cos(pose.yaw), sin = std::sin(pose.yaw);
  return base::Point{pose.x + cos * place->x - sin * place->y, pose.y + sin * place->x + cos * place->y};
}

void InitNotes(control::HeardNotes* self, const Heard& heard) {
  std::vector<control::HeardNote> notes;
  for (const auto& [position, loudest] : heard) notes.push_back({position, loudest});
  new (self) control::HeardNotes(std::move(notes));
}

Heard PairsOf(const control::HeardNotes& heard) {
  Heard pairs;
  for (const control::HeardNote& note : heard.notes()) pairs.emplace_back(note.position, note.loudest);
  return pairs;
}

void BindRuledOut(nb::module_& m) {
  nb::class_<control::HeardNotes>(m, "HeardNotes")
      .def("__init__", &InitNotes, "heard"_a)
      .def_prop_ro("notes", &PairsOf);
  nb::class_<control::RuledOut>(m, "RuledOut")
      .def(nb::init<double, double, double>(), nb::kw_only(), "radius_m"_a, "cell_m"_a, "next_to_m"_a)
      .def("clear", &control::RuledOut::Clear)
      .def(
          "add",
          [](control::RuledOut& ruled_out, const base::Point& position, const std::optional<base::Point>& loudest) {
            ruled_out.Add(control::HeardNote{position, loudest});
          },
          "position_m"_a, "loudest_m"_a.none())
      .def("add_all", nb::overload_cast<const control::HeardNotes&>(&control::RuledOut::Add), "heard"_a)
      .def("covers", &control::RuledOut::Covers, "place_m"_a);
}

using Cells = Array<const float, -1>;
using Disc = std::pair<base::Point, double>;
using Place = std::tuple<int, double, double>;

std::vector<float> ValuesOf(const Cells& cells) { return {cells.data(), cells.data() + cells.size()}; }

template <typename Value>
Array<Value, -1> ArrayOf(const std::vector<Value>& values) {
  auto array = NewArray<Value, -1>({values.size()});
  std::copy(values.begin(), values.end(), array.data());
  return array;
}

Place TupleOf(const control::ListeningPlace& place) { return {place.cell, place.gain, place.rate_per_s}; }

void BindLosses(nb::module_& m) {
  nb::class_<control::VoiceLosses>(m, "VoiceLosses")
      .def(
          "__init__",
          [](control::VoiceLosses* self, const propagation::FaceSet& faces, const base::Point& origin_m, double cell_m,
             int rows, int columns, double slope_db, double wall_unit_db, double min_distance_m, double nearer_m,
             double step_db) {
            new (self) control::VoiceLosses(faces, {origin_m, cell_m, rows, columns},
                                            {slope_db, wall_unit_db, min_distance_m, nearer_m, step_db});
          },
          nb::kw_only(), "faces"_a, "origin_m"_a, "cell_m"_a, "rows"_a, "columns"_a, "slope_db"_a, "wall_unit_db"_a,
          "min_distance_m"_a, "nearer_m"_a, "step_db"_a)
      .def(
          "losses_from", [](const control::VoiceLosses& losses, int cell) { return ArrayOf(losses.From(cell)); },
          "cell"_a);
}

void BindPaths(nb::module_& m) {
  nb::class_<control::CellPaths>(m, "CellPaths")
      .def(
          "__init__",
          [](control::CellPaths* self, const std::shared_ptr<const plan::PlanningGrid>& grid,
             const base::Point& origin_m, double cell_m, int rows, int columns, const std::optional<Disc>& kept_out) {
            std::optional<control::KeptOut> disc;
            if (kept_out) disc = control::KeptOut{kept_out->first, kept_out->second};
            new (self) control::CellPaths(grid, {origin_m, cell_m, rows, columns}, disc);
          },
          nb::kw_only(), "grid"_a, "origin_m"_a, "cell_m"_a, "rows"_a, "columns"_a, "kept_out"_a.none())
      .def("cell_of", &control::CellPaths::CellOf, "point_m"_a)
      .def("start_of", &control::CellPaths::StartOf, "point_m"_a)
      .def("place_of", &control::CellPaths::PlaceOf, "cell"_a)
      .def(
          "lengths_from", [](const control::CellPaths& paths, int cell) { return ArrayOf(paths.LengthsFrom(cell)); },
          "cell"_a)
      .def("length_m", &control::CellPaths::LengthBetween, "from_cell"_a, "to_cell"_a)
      .def("ahead", &control::CellPaths::Ahead, "position_m"_a, "goal_cell"_a, "longest_m"_a);
}

void BindBelief(nb::module_& m) {
  nb::class_<control::VictimBelief>(m, "VictimBelief")
      .def(
          "__init__",
          [](control::VictimBelief* self, const std::shared_ptr<const control::VoiceLosses>& losses,
             const Cells& prior) { new (self) control::VictimBelief(losses, ValuesOf(prior)); },
          "losses"_a, "prior"_a)
      .def("set_losses", &control::VictimBelief::SetLosses, "losses"_a)
      .def(
          "set_unheard",
          [](control::VictimBelief& belief, const Array<const float, control::VictimBelief::kNumLosses>& unheard) {
            control::VictimBelief::Unheard values;
            std::copy(unheard.data(), unheard.data() + unheard.size(), values.begin());
            belief.SetUnheard(values);
          },
          "unheard"_a)
      .def("listen", &control::VictimBelief::Listen, "cell"_a, "above"_a)
      .def("remaining", &control::VictimBelief::Remaining)
      .def("mass", [](const control::VictimBelief& belief) { return ArrayOf(belief.Mass()); })
      .def(
          "best",
          [](const control::VictimBelief& belief, const control::CellPaths& paths, int start,
             const std::vector<int>& candidates, const std::vector<int>& claims, double speed_mps,
             double delay_s) -> std::optional<Place> {
            const auto best = belief.Best(paths, start, candidates, {claims, speed_mps, delay_s});
            return best ? std::optional<Place>(TupleOf(*best)) : std::nullopt;
          },
          "paths"_a, "start_cell"_a, "candidates"_a, "claims"_a, "speed_mps"_a, "delay_s"_a)
      .def(
          "worth",
          [](const control::VictimBelief& belief, const control::CellPaths& paths, int start, int cell,
             const std::vector<int>& claims, double speed_mps, double delay_s) {
            return TupleOf(belief.Worth(paths, start, cell, {claims, speed_mps, delay_s}));
          },
          "paths"_a, "start_cell"_a, "cell"_a, "claims"_a, "speed_mps"_a, "delay_s"_a);
}

void BindFix(nb::module_& m) {
  nb::class_<control::VoiceFix>(m, "VoiceFix")
      .def(
          "__init__",
          [](control::VoiceFix* self, const std::shared_ptr<const control::VoiceLosses>& losses,
             const std::pair<double, double>& loudness_db, const std::pair<double, double>& exponent) {
            new (self)
                control::VoiceFix(losses, {loudness_db.first, loudness_db.second}, {exponent.first, exponent.second});
          },
          "losses"_a, "loudness_db"_a, "exponent"_a)
      .def("add", &control::VoiceFix::Add, "place_m"_a, "level_db"_a)
      .def_prop_ro("count", &control::VoiceFix::Count)
      .def(
          "most_probable",
          [](const control::VoiceFix& fix, const Cells& prior) -> std::optional<std::pair<int, double>> {
            const auto source = fix.MostProbable(ValuesOf(prior));
            return source ? std::optional<std::pair<int, double>>({source->cell, source->misfit}) : std::nullopt;
          },
          "prior"_a);
}

}  // namespace

void BindControl(nb::module_&& m) {
  BindParameters(m);
  BindNavigator(m);
  nb::class_<control::Surroundings>(m, "Surroundings")
      .def(
          "__init__",
          [](control::Surroundings* self, const control::LaserLayout& laser, int stride, double sensing_radius_m,
             const std::vector<double>& headings_rad) {
            new (self) control::Surroundings(control::ScanClearance(laser), stride, sensing_radius_m, headings_rad);
          },
          nb::kw_only(), "laser"_a, "stride"_a, "sensing_radius_m"_a, "headings_rad"_a)
      .def("clearest_place", &ClearestPlace, "pose"_a, "ranges_m"_a);
  BindRuledOut(m);
  BindLosses(m);
  BindPaths(m);
  BindBelief(m);
  BindFix(m);
}

}  // namespace robotteamsim::bindings

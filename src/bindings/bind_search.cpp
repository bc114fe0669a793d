// _core.control: the belief over places of victims.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "geometry.hpp"
#include "robotteamsim/control/cell_paths.hpp"
#include "robotteamsim/control/victim_belief.hpp"
#include "robotteamsim/control/voice_fix.hpp"
#include "robotteamsim/control/voice_losses.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace robotteamsim::bindings {
namespace {

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
      .def("losses_from", [](const control::VoiceLosses& losses, int cell) { return ArrayOf(losses.From(cell)); },
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
      .def(
          "place_of",
          [](const control::CellPaths& paths, int cell) -> std::optional<base::Point> {
            if (cell < 0 || static_cast<std::size_t>(cell) >= paths.Size()) {
              throw std::invalid_argument("there is no cell " + std::to_string(cell));
            }
            return paths.PlaceOf(cell);
          },
          "cell"_a)
      .def("lengths_from",
           [](const control::CellPaths& paths, int cell) { return ArrayOf(paths.LengthsFrom(cell)); }, "cell"_a)
      .def(
          "length_m",
          [](const control::CellPaths& paths, int from, int to) {
            if (to < 0 || static_cast<std::size_t>(to) >= paths.Size()) {
              throw std::invalid_argument("there is no cell " + std::to_string(to));
            }
            return paths.LengthsFrom(from)[to];
          },
          "from_cell"_a, "to_cell"_a)
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
            new (self) control::VoiceFix(losses, {loudness_db.first, loudness_db.second},
                                         {exponent.first, exponent.second});
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

void BindSearch(nb::module_& m) {
  BindLosses(m);
  BindPaths(m);
  BindBelief(m);
  BindFix(m);
}

}  // namespace robotteamsim::bindings

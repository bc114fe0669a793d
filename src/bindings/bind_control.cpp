// Floor 5: what a controller reads from its laser, how it drives, and what it keeps in mind.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "fast_calls.hpp"
#include "json_text.hpp"
#include "points.hpp"
#include "robotteamsim/control/clearance.hpp"
#include "robotteamsim/control/navigator.hpp"
#include "robotteamsim/control/ruled_out.hpp"
#include "robotteamsim/control/surroundings.hpp"
#include "robotteamsim/geometry/hypot.hpp"
#include "tuples.hpp"

namespace py = pybind11;

namespace robotteamsim::bindings {
namespace {

using PlainRanges = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Heard = std::vector<std::pair<Point, std::optional<Point>>>;

// A scan as controllers have it, an array of float32 in one piece, is read as it is: NumPy's conversion, which leaves
// it alone as well, takes a quarter of a navigator's step.
py::array Plain(const py::array& ranges) {
  constexpr int kFloat32 = 11;  // NPY_FLOAT
  constexpr int kInOnePiece = py::array::c_style | py::detail::npy_api::NPY_ARRAY_ALIGNED_;
  const py::dtype type = ranges.dtype();
  const bool is_plain =
      type.num() == kFloat32 && type.byteorder() == '=' && (ranges.flags() & kInOnePiece) == kInOnePiece;
  py::array plain = is_plain ? ranges : PlainRanges::ensure(ranges);
  if (!plain) throw py::error_already_set();
  return plain;
}

// Of an array that is plain, which must live as long as they are read.
Ranges RangesOf(const py::array& plain) {
  return {static_cast<const float*>(plain.data()), static_cast<std::size_t>(plain.size())};
}

std::vector<Point> ToPoints(const Doubles& rows) {
  if (rows.ndim() != 2 || rows.shape(1) != 2) throw std::invalid_argument("points must have shape (n, 2)");
  std::vector<Point> points;
  for (const double* row = rows.data(); row != rows.data() + rows.size(); row += 2) points.push_back({row[0], row[1]});
  return points;
}

HeardNotes MakeNotes(const Heard& heard) {
  std::vector<HeardNote> notes;
  for (const auto& [position, loudest] : heard) notes.push_back({position, loudest});
  return HeardNotes(std::move(notes));
}

Heard PairsOf(const HeardNotes& heard) {
  Heard pairs;
  for (const HeardNote& note : heard.notes()) pairs.emplace_back(note.position, note.loudest);
  return pairs;
}

/// A navigator and the class of its commands, and the grid that it was last given, as Python and as the library have
/// it.
struct BoundNavigator {
  Navigator navigator;
  TupleClass twist;
  py::object python_grid;
  std::shared_ptr<PlanningGrid> grid;
};

// `teammates` returns a mapping from the ids of robots to their places, when it is asked.
py::object Drive(BoundNavigator& self, const py::object& grid, const Pose& pose, const py::array& ranges_m,
                 const Point& goal, double speed_mps, std::int64_t sim_time_ns, const py::function& teammates) {
  if (!grid.is(self.python_grid)) {
    self.grid = grid.cast<std::shared_ptr<PlanningGrid>>();
    self.python_grid = grid;
  }
  const double time_s = static_cast<double>(sim_time_ns) * 1e-9;
  const py::array plain = Plain(ranges_m);
  const auto ask = [&teammates] {
    const auto places = teammates().cast<std::map<int, Point>>();
    return Navigator::Teammates(places.begin(), places.end());
  };
  const Twist twist = self.navigator.Drive(self.grid, pose, RangesOf(plain), goal, speed_mps, time_s, ask);
  const std::array<double, 3> numbers{twist.linear_x, twist.linear_y, twist.angular_z};
  return self.twist.OfNumbers(numbers.data(), 3);
}

void BindNavigator(py::module_& m) {
  py::class_<LaserLayout>(m, "LaserLayout")
      .def(py::init([](int beams, double angle_min_rad, double angle_max_rad, double forward_m, double range_max_m) {
             return LaserLayout{beams, angle_min_rad, angle_max_rad, forward_m, range_max_m};
           }),
           py::kw_only(), py::arg("beams"), py::arg("angle_min_rad"), py::arg("angle_max_rad"), py::arg("forward_m"),
           py::arg("range_max_m"));
  py::class_<BoundNavigator> navigator(m, "Navigator");
  navigator.def(py::init([](int robot_id, double radius_m, const LaserLayout& laser, double max_speed_mps,
                            double max_turn_radps, bool is_car, bool by_path, py::type twist) {
                  const NavigatorBody body{robot_id, radius_m, laser, max_speed_mps, max_turn_radps, is_car};
                  return BoundNavigator{Navigator(body, by_path), TupleClass(std::move(twist))};
                }),
                py::kw_only(), py::arg("robot_id"), py::arg("radius_m"), py::arg("laser"), py::arg("max_speed_mps"),
                py::arg("max_turn_radps"), py::arg("is_car"), py::arg("by_path"), py::arg("twist"));
  DefFast<&Drive>(navigator, "drive");
}

// In `map`, where the robot stands at `pose`.
std::optional<Point> ClearestPlace(const Surroundings& surroundings, const Pose& pose, const py::array& ranges_m) {
  const std::optional<Point> place = surroundings.ClearestPlace(RangesOf(Plain(ranges_m)));
  if (!place) return std::nullopt;
  const double cos = std::cos(pose.yaw), sin = std::sin(pose.yaw);
  return Point{pose.x + cos * place->x - sin * place->y, pose.y + sin * place->x + cos * place->y};
}

void AddNote(RuledOut& ruled_out, const Point& position, const std::optional<Point>& loudest) {
  ruled_out.Add(HeardNote{position, loudest});
}

void AddNotes(RuledOut& ruled_out, const HeardNotes& heard) { ruled_out.Add(heard); }

// The place that is nearest to a position, the first of equals.
py::object NearestPlace(const Point& position, const py::list& places) {
  py::object nearest;
  double least = 0.0;
  for (const py::handle item : places) {
    const auto place = item.cast<Point>();
    const double distance = Hypot(place.x - position.x, place.y - position.y);
    if (nearest && distance >= least) continue;
    nearest = py::reinterpret_borrow<py::object>(item);
    least = distance;
  }
  if (!nearest) throw std::invalid_argument("of no places, none is nearest");
  return nearest;
}

}  // namespace

void BindControl(py::module_& m) {
  BindNavigator(m);
  DefFast<&JsonText>(m, "json_text");
  DefFast<&NearestPlace>(m, "nearest_place");
  m.def(
      "farthest_from",
      [](const Doubles& points_m, const Point& place_m, const Doubles& candidates_m) {
        return FarthestFrom(ToPoints(points_m), place_m, ToPoints(candidates_m));
      },
      py::arg("points_m"), py::arg("place_m"), py::arg("candidates_m"));
  py::class_<Surroundings> surroundings(m, "Surroundings");
  surroundings.def(py::init([](const LaserLayout& laser, int stride, double sensing_radius_m,
                               const std::vector<double>& headings_rad) {
                     return Surroundings(ScanClearance(laser), stride, sensing_radius_m, headings_rad);
                   }),
                   py::kw_only(), py::arg("laser"), py::arg("stride"), py::arg("sensing_radius_m"),
                   py::arg("headings_rad"));
  DefFast<&ClearestPlace>(surroundings, "clearest_place");
  py::class_<HeardNotes>(m, "HeardNotes")
      .def(py::init(&MakeNotes), py::arg("heard"))
      .def_property_readonly("notes", &PairsOf);
  py::class_<RuledOut> ruled_out(m, "RuledOut");
  ruled_out
      .def(py::init<double, double, double>(), py::kw_only(), py::arg("radius_m"), py::arg("cell_m"),
           py::arg("next_to_m"))
      .def("clear", &RuledOut::Clear);
  DefFast<&AddNote>(ruled_out, "add");
  DefFast<&AddNotes>(ruled_out, "add_all");
  DefFast<&RuledOut::Covers>(ruled_out, "covers");
}

}  // namespace robotteamsim::bindings

// _core.base: lengths and nearest points.
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "casters.hpp"
#include "robotteamsim/base/hypot.hpp"
#include "robotteamsim/base/nearest.hpp"

namespace robotteamsim::bindings {
namespace {

Array<double, -1> HypotOf(const Array<const double, -1>& x, const Array<const double, -1>& y) {
  if (x.size() != y.size()) throw std::invalid_argument("x and y must have the same length");
  std::vector<double> lengths(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) lengths[i] = base::Hypot(x.data()[i], y.data()[i]);
  return ArrayOf(std::move(lengths));
}

}  // namespace

void BindBase(nb::module_&& m) {
  m.def("hypot", &HypotOf, "x"_a, "y"_a);
  m.def("nearest_point", &base::NearestPoint, "position_m"_a, "points_m"_a);
  m.def(
      "nearest_other",
      [](const base::Point& position, const Points& points_m, int own) {
        const std::vector<base::Point> points = RecordsOf<base::Point>(points_m);
        return base::NearestOther(position, points.data(), points.size(), own);
      },
      "position_m"_a, "points_m"_a, "own"_a, "Return the nearest of all points but one, whose row may be -1 for none.");
  nb::class_<base::Places>(m, "Places")
      .def(nb::init<std::vector<base::Point>, std::vector<double>>(), "places_m"_a, "reaches_m"_a)
      .def(
          "reached",
          [](const base::Places& places, const nb::ndarray<const double, nb::shape<-1, 2>, nb::device::cpu>& points_m) {
            std::vector<base::Point> points;
            for (std::size_t i = 0; i < points_m.shape(0); ++i) points.push_back({points_m(i, 0), points_m(i, 1)});
            return places.Reached(points);
          },
          "points_m"_a);
}

}  // namespace robotteamsim::bindings

// _core.learning: what agents perceive, as vectors.
#include <cstddef>
#include <stdexcept>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "casters.hpp"
#include "robotteamsim/learning/observation.hpp"

namespace robotteamsim::bindings {
namespace {

template <typename Value>
using AnyShape = nb::ndarray<const Value, nb::numpy, nb::c_contig, nb::device::cpu>;

/// The numbers of an array as a table whose columns are its last axis, or its last axes.
template <typename Value>
base::Table<const Value> TableOf(const AnyShape<Value>& array, std::size_t last = 1) {
  if (array.ndim() < last) throw std::invalid_argument("the parts of percepts have too few axes");
  base::Table<const Value> table{array.data(), 1, 1};
  for (std::size_t axis = 0; axis < array.ndim(); ++axis) {
    (axis + last < array.ndim() ? table.rows : table.cols) *= array.shape(axis);
  }
  return table;
}

}  // namespace

void BindLearning(nb::module_&& m) {
  using learning::Units;
  nb::class_<Units>(m, "Units")
      .def(nb::init<std::vector<float>, std::vector<double>, std::vector<double>, base::Point, base::Point, double,
                    double>(),
           nb::kw_only(), "range_max_m"_a, "max_speed_mps"_a, "max_turn_radps"_a, "low_m"_a, "extent_m"_a,
           "diagonal_m"_a, "voice_radius_m"_a);
  m.def(
      "vectors",
      [](const Units& units, const propagation::FaceSet& faces, const propagation::RadioModel& radio, std::size_t said,
         const AnyShape<float>& ranges_m, const AnyShape<double>& poses, const AnyShape<double>& twists,
         const AnyShape<double>& voices, const AnyShape<double>& area, const AnyShape<double>& heard,
         const AnyShape<double>& remembered) {
        const learning::Percepts percepts{TableOf(ranges_m), TableOf(poses),    TableOf(twists),     TableOf(voices),
                                          TableOf(area),     TableOf(heard, 2), TableOf(remembered), said};
        auto vectors = NewTable<float>(percepts.poses.rows, percepts.VectorSize());
        learning::WriteVectors(units, faces, radio, percepts, TableOf(vectors));
        return vectors;
      },
      "units"_a, "faces"_a, "radio"_a, "said"_a, "ranges_m"_a, "poses"_a, "twists"_a, "voices"_a, "area"_a, "heard"_a,
      "remembered"_a);
}

}  // namespace robotteamsim::bindings

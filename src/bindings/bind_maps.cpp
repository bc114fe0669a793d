// _core.maps: what a robot knows of the building, and where it is in it.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "casters.hpp"
#include "fields.hpp"
#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/maps/beam_model.hpp"
#include "robotteamsim/maps/distance_field.hpp"
#include "robotteamsim/maps/mapper.hpp"
#include "robotteamsim/maps/occupancy_grid.hpp"
#include "robotteamsim/maps/particle_filter.hpp"
#include "robotteamsim/maps/submap_search.hpp"

namespace nanobind::detail {

namespace maps = robotteamsim::maps;

template <>
struct type_caster<maps::BeamModel::Agreement>
    : TupleCaster<maps::BeamModel::Agreement, &maps::BeamModel::Agreement::informative,
                  &maps::BeamModel::Agreement::contradicting> {};

template <>
struct type_caster<maps::SubmapSearch::Match>
    : TupleCaster<maps::SubmapSearch::Match, &maps::SubmapSearch::Match::pose, &maps::SubmapSearch::Match::share> {};

}  // namespace nanobind::detail

namespace robotteamsim::bindings {
namespace {

using maps::BeamModel, maps::DistanceField, maps::Mapper, maps::OccupancyGrid, maps::ParticleFilter, maps::SubmapSearch;
using Floats = Array<const float, -1>;
using Ids = Array<const std::int32_t, -1>;

plan::GridShape ShapeOf(const Array<const bool, -1, -1>& cells, const base::Point& origin_m, double resolution_m) {
  return {origin_m, resolution_m, static_cast<int>(cells.shape(0)), static_cast<int>(cells.shape(1))};
}

void BindDistanceField(nb::module_& m) {
  nb::class_<DistanceField>(m, "DistanceField")
      .def(
          "__init__",
          [](DistanceField* self, const Array<const bool, -1, -1>& occupied, const base::Point& origin_m,
             double resolution_m) {
            new (self) DistanceField(ShapeOf(occupied, origin_m, resolution_m), ValuesOf<std::uint8_t>(occupied));
          },
          "occupied"_a, "origin_m"_a, "resolution_m"_a)
      .def("distances_m",
           [](const DistanceField& field) {
             return CellsOf<float>(field.distances_m(), field.shape().rows, field.shape().cols);
           })
      .def(
          "trace",
          [](const DistanceField& field, const base::Point& origin_m, double angle_rad, double range_max_m) {
            return field.Trace(origin_m, {std::cos(angle_rad), std::sin(angle_rad)}, range_max_m);
          },
          "origin_m"_a, "angle_rad"_a, "range_max_m"_a);
}

std::vector<maps::Beam> ScanOf(const BeamModel& model, const Floats& ranges_m, const Ids& beams) {
  return model.BeamsOf(ranges_m.data(), ranges_m.size(), ValuesOf<int>(beams));
}

void BindBeamModel(nb::module_& m) {
  nb::class_<BeamModel>(m, "BeamModel")
      .def(nb::init<std::shared_ptr<const DistanceField>, const world::Fan&, double>(), "field"_a, "fan"_a,
           "range_min_m"_a)
      .def(
          "log_likelihood",
          [](const BeamModel& model, const base::Pose& pose, const Floats& ranges_m, const Ids& beams, double sigma_m,
             double outliers) { return model.LogLikelihood(pose, ScanOf(model, ranges_m, beams), sigma_m, outliers); },
          "pose"_a, "ranges_m"_a, "beams"_a, "sigma_m"_a, "outliers"_a)
      .def(
          "agreement",
          [](const BeamModel& model, const base::Pose& pose, const Floats& ranges_m, const Ids& beams,
             double tolerance_m, double tolerance_rad) {
            return model.AgreementOf(pose, ScanOf(model, ranges_m, beams), {tolerance_m, tolerance_rad});
          },
          "pose"_a, "ranges_m"_a, "beams"_a, "tolerance_m"_a, "tolerance_rad"_a);
}

void BindParticleFilter(nb::module_& m) {
  nb::class_<ParticleFilter>(m, "ParticleFilter")
      .def(
          "__init__",
          [](ParticleFilter* self, std::shared_ptr<const BeamModel> beams, double sigma_m, double outliers,
             double power, const base::Pose& mean, const std::array<double, 3>& spread, const Triples& noise) {
            new (self)
                ParticleFilter(std::move(beams), {sigma_m, outliers, power}, mean, {spread[0], spread[1], spread[2]},
                               {noise.data(), noise.shape(0), noise.shape(1)});
          },
          nb::kw_only(), "beams"_a, "sigma_m"_a, "outliers"_a, "power"_a, "mean"_a, "spread"_a, "noise"_a)
      .def(
          "move",
          [](ParticleFilter& filter, const base::Pose& motion, const std::array<double, 4>& alphas, double step_s,
             bool omni, const Triples& noise) {
            base::Check(motion, "motion");
            const sensing::OdometryModel model{alphas[0], alphas[1], alphas[2], alphas[3]};
            filter.Move({model.ForSteps(step_s), motion, motion.yaw, omni},
                        {noise.data(), noise.shape(0), noise.shape(1)});
          },
          "motion"_a, "alphas"_a, "step_s"_a, "omni"_a, "noise"_a)
      .def("shift", &ParticleFilter::Shift, "by_m"_a)
      .def(
          "weigh",
          [](ParticleFilter& filter, const Floats& ranges_m, const Ids& beams) {
            filter.Weigh(ScanOf(filter.beams(), ranges_m, beams));
          },
          "ranges_m"_a, "beams"_a)
      .def("resample", &ParticleFilter::Resample, "draw"_a)
      .def("drawn", &ParticleFilter::Drawn, "count"_a, "draw"_a)
      .def("mean", [](const ParticleFilter& filter) {
        const ParticleFilter::Estimate mean = filter.Mean();
        const state::PoseCovariance& p = mean.covariance;
        return std::make_pair(mean.pose, std::array<double, 6>{p.xx, p.xy, p.x_yaw, p.yy, p.y_yaw, p.yaw_yaw});
      });
}

void BindSubmapSearch(nb::module_& m) {
  nb::class_<SubmapSearch>(m, "SubmapSearch")
      .def(
          "__init__",
          [](SubmapSearch* self, const Array<const bool, -1, -1>& occupied, const base::Point& origin_m,
             double resolution_m, double tolerance_m) {
            new (self)
                SubmapSearch(ShapeOf(occupied, origin_m, resolution_m), ValuesOf<std::uint8_t>(occupied), tolerance_m);
          },
          "occupied"_a, "origin_m"_a, "resolution_m"_a, "tolerance_m"_a)
      .def(
          "find",
          [](const SubmapSearch& search, const Points& points_m, double least_share, double ratio, double distinct_m,
             double distinct_rad, int most) {
            return search.Find(RecordsOf<base::Point>(points_m), {least_share, ratio, distinct_m, distinct_rad, most});
          },
          "points_m"_a, "least_share"_a, "ratio"_a, "distinct_m"_a, "distinct_rad"_a, "most"_a);
}

using Covariance = std::array<double, 6>;
/// Of the lower left corner [m], and the cells.
using PlacedCells = std::pair<base::Point, Array<std::int8_t, -1, -1>>;

PlacedCells PlacedOf(OccupancyGrid grid) {
  const plan::GridShape shape = grid.shape;
  return {shape.origin, CellsOf<std::int8_t>(std::move(grid.cells), shape.rows, shape.cols)};
}

void BindMapper(nb::module_& m) {
  nb::class_<maps::MapperParameters> parameters(m, "MapperParameters");
  std::apply([&](const auto&... fields) { DefineFields(parameters, fields...); }, maps::kMapperFields);
  nb::class_<Mapper>(m, "Mapper")
      .def(nb::init<const world::Fan&, double, const maps::MapperParameters&, const base::Pose&>(), nb::kw_only(),
           "fan"_a, "range_min_m"_a, "parameters"_a, "start"_a)
      .def(
          "due_at",
          [](const Mapper& mapper, const base::Pose& odometry) {
            base::Check(odometry, "the pose of the odometry");
            return mapper.DueAt(odometry);
          },
          "odometry"_a)
      .def(
          "step",
          [](Mapper& mapper, const base::Pose& odometry, const Covariance& p, const Array<const float, -1>& ranges_m,
             const Array<const bool, -1>& masked) {
            return mapper.Step({odometry, {p[0], p[1], p[2], p[3], p[4], p[5]}}, ValuesOf<float>(ranges_m),
                               ValuesOf<std::uint8_t>(masked));
          },
          "odometry"_a, "covariance"_a, "ranges_m"_a, "masked"_a)
      .def_prop_ro("pose", &Mapper::pose)
      .def_prop_ro("covariance",
                   [](const Mapper& mapper) {
                     const Eigen::Matrix3d& p = mapper.covariance();
                     return Covariance{p(0, 0), p(0, 1), p(0, 2), p(1, 1), p(1, 2), p(2, 2)};
                   })
      .def_prop_ro("is_lost", &Mapper::is_lost)
      .def_prop_ro("bytes", &Mapper::Bytes)
      .def(
          "take_changes", [](Mapper& mapper, int factor) { return PlacedOf(mapper.TakeChanges(factor)); }, "factor"_a)
      .def_prop_ro("num_submaps", [](const Mapper& mapper) { return mapper.submaps().size(); });
}

}  // namespace

void BindMaps(nb::module_&& m) {
  BindDistanceField(m);
  BindBeamModel(m);
  BindParticleFilter(m);
  BindSubmapSearch(m);
  BindMapper(m);
}

}  // namespace robotteamsim::bindings

// _core.propagation: fading of radio and voice.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "casters.hpp"
#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/radio.hpp"
#include "robotteamsim/propagation/voice.hpp"

namespace nanobind::detail {

using robotteamsim::propagation::PointMm;

template <>
struct type_caster<PointMm> : TupleCaster<PointMm, &PointMm::x, &PointMm::y> {};

}  // namespace nanobind::detail

namespace robotteamsim::bindings {
namespace {

using propagation::FaceSet, propagation::MapView, propagation::Positions, propagation::RadioModel;
using propagation::PointMm, propagation::RoundToMm, propagation::Storey, propagation::VoiceModel;
using propagation::VoiceSource;
using OtherThreadsRun = nb::call_guard<nb::gil_scoped_release>;

double PathLoss(const FaceSet& faces, const RadioModel& model, const base::Point& a, const base::Point& b,
                int floors_crossed) {
  return propagation::PathLossDb(faces, model, RoundToMm(a, "a_m"), RoundToMm(b, "b_m"), floors_crossed);
}

/// Returns the grid of one of `count` maps of equal shape that lie one below the other in an array.
plan::GridShape GridOf(const base::Point& origin, double resolution_m, const MapView& maps, std::size_t count) {
  return {origin, resolution_m,
          static_cast<int>(maps.rows() / std::max<Eigen::Index>(static_cast<Eigen::Index>(count), 1)),
          static_cast<int>(maps.cols())};
}

int StoreysOf(const FaceSet& faces) { return static_cast<int>(faces.storeys().size()); }

// Maps are written into arrays of the caller.

void WriteBestMap(const FaceSet& faces, const RadioModel& model, const std::vector<base::Point>& transmitters,
                  int floors_crossed, const base::Point& origin, double resolution_m, MapView map, int threads) {
  propagation::WriteHighest(faces, propagation::RadioSources(model, transmitters, floors_crossed, StoreysOf(faces)),
                            GridOf(origin, resolution_m, map, 1), map, {threads});
}

void WriteMaps(const FaceSet& faces, const RadioModel& model, const std::vector<base::Point>& transmitters,
               int floors_crossed, const base::Point& origin, double resolution_m, MapView maps, int threads) {
  const plan::GridShape grid = GridOf(origin, resolution_m, maps, transmitters.size());
  propagation::WriteEach(faces, propagation::RadioSources(model, transmitters, floors_crossed, StoreysOf(faces)), grid,
                         maps, {threads});
}

void WriteVoices(const FaceSet& faces, const VoiceModel& model, const std::vector<VoiceSource>& sources,
                 const base::Point& origin, double resolution_m, const Eigen::Ref<const propagation::SolidCells>& solid,
                 MapView map, int threads) {
  propagation::WriteVoiceMap(faces, model, sources, GridOf(origin, resolution_m, map, 1), solid, map, {threads});
}

void BindRadio(nb::module_& m) {
  nb::class_<RadioModel>(m, "RadioModel")
      .def(nb::init<double, double, double, double, double, double>(), nb::kw_only(), "tx_power_dbm"_a,
           "constant_loss_db"_a, "slope_db"_a, "min_distance_m"_a, "floor_loss_db"_a, "floor_exponent"_a);
  m.def("path_loss_db", &PathLoss, "faces"_a, "model"_a, "a_m"_a, "b_m"_a, "floors_crossed"_a = 0);
  m.def(
      "rssi_matrix_dbm",
      [](const FaceSet& faces, const RadioModel& model, const Eigen::Ref<const Positions>& positions_m) {
        return propagation::RssiMatrixDbm(faces, model, positions_m);
      },
      "faces"_a, "model"_a, "positions_m"_a);
  m.def("write_best_rssi_map_dbm", &WriteBestMap, "faces"_a, "model"_a, "transmitters_m"_a, "floors_crossed"_a,
        "origin_m"_a, "resolution_m"_a, "out"_a, "threads"_a, OtherThreadsRun());
  m.def("write_rssi_maps_dbm", &WriteMaps, "faces"_a, "model"_a, "transmitters_m"_a, "floors_crossed"_a, "origin_m"_a,
        "resolution_m"_a, "out"_a, "threads"_a, OtherThreadsRun());
}

void BindVoice(nb::module_& m) {
  nb::class_<VoiceModel>(m, "VoiceModel")
      .def(nb::init<double, double, double>(), nb::kw_only(), "noise_db"_a, "unit_db"_a, "min_distance_m"_a);
  nb::class_<VoiceSource>(m, "VoiceSource")
      .def(nb::init<base::Point, double, double>(), "position_m"_a, "constant_db"_a, "exponent"_a);
  m.def(
      "voice_level_db",
      [](const FaceSet& faces, const VoiceModel& model, const VoiceSource& source, const base::Point& at_m) {
        return propagation::VoiceLevelDb(faces, model, source, RoundToMm(at_m, "at_m"));
      },
      "faces"_a, "model"_a, "source"_a, "at_m"_a);
  m.def("write_voice_map_db", &WriteVoices, "faces"_a, "model"_a, "sources"_a, "origin_m"_a, "resolution_m"_a,
        "solid"_a, "out"_a, "threads"_a, OtherThreadsRun());
}

}  // namespace

void BindPropagation(nb::module_&& m) {
  nb::class_<Storey>(m, "Storey")
      .def(nb::init<PointMm, PointMm, PointMm, std::int64_t, std::int64_t, std::int32_t,
                    std::vector<std::vector<PointMm>>>(),
           nb::kw_only(), "least_mm"_a, "most_mm"_a, "origin_mm"_a, "floor_mm"_a, "ceiling_mm"_a, "floor_weight"_a,
           "openings_mm"_a);
  nb::class_<FaceSet>(m, "FaceSet")
      .def(nb::init<const std::vector<std::array<std::int64_t, 4>>&, const std::vector<std::int32_t>&,
                    std::vector<Storey>>(),
           "ends_mm"_a, "weights"_a, "storeys"_a = std::vector<Storey>())
      .def("set_active", &FaceSet::SetActive, "face"_a, "active"_a)
      .def(
          "weight_between",
          [](const FaceSet& faces, const base::Point& a_m, const base::Point& b_m) {
            return faces.WeightBetween(RoundToMm(a_m, "a_m"), RoundToMm(b_m, "b_m"));
          },
          "a_m"_a, "b_m"_a);
  BindRadio(m);
  BindVoice(m);
}

}  // namespace robotteamsim::bindings

// _core.propagation: fading of radio and voice.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "bindings.hpp"
#include "geometry.hpp"
#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/radio.hpp"
#include "robotteamsim/propagation/voice.hpp"

namespace robotteamsim::bindings {
namespace {

double PathLoss(const propagation::FaceSet& faces, const propagation::RadioModel& model, const base::Point& a,
                const base::Point& b, int floors_crossed) {
  return propagation::PathLossDb(faces, model, propagation::RoundToMm(a, "a_m"), propagation::RoundToMm(b, "b_m"),
                                 floors_crossed);
}

/// Returns the grid of one of `count` maps of equal shape that lie one below the other in an array.
plan::GridShape GridOf(const base::Point& origin, double resolution_m, const propagation::MapView& maps,
                       std::size_t count) {
  return {origin, resolution_m,
          static_cast<int>(maps.rows() / std::max<Eigen::Index>(static_cast<Eigen::Index>(count), 1)),
          static_cast<int>(maps.cols())};
}

// Maps are written into arrays of the caller; other Python threads run meanwhile.

void WriteBestMap(const propagation::FaceSet& faces, const propagation::RadioModel& model,
                  const std::vector<base::Point>& transmitters, int floors_crossed, const base::Point& origin,
                  double resolution_m, propagation::MapView map, int threads) {
  const nb::gil_scoped_release released;
  propagation::WriteHighest(faces, propagation::RadioSources(model, transmitters, floors_crossed),
                            GridOf(origin, resolution_m, map, 1), map, {threads});
}

void WriteMaps(const propagation::FaceSet& faces, const propagation::RadioModel& model,
               const std::vector<base::Point>& transmitters, int floors_crossed, const base::Point& origin,
               double resolution_m, propagation::MapView maps, int threads) {
  const nb::gil_scoped_release released;
  const plan::GridShape grid = GridOf(origin, resolution_m, maps, transmitters.size());
  propagation::WriteEach(faces, propagation::RadioSources(model, transmitters, floors_crossed), grid, maps, {threads});
}

void WriteVoices(const propagation::FaceSet& faces, const propagation::VoiceModel& model,
                 const std::vector<propagation::VoiceSource>& sources, const base::Point& origin, double resolution_m,
                 const Eigen::Ref<const propagation::SolidCells>& solid, propagation::MapView map, int threads) {
  const nb::gil_scoped_release released;
  propagation::WriteVoiceMap(faces, model, sources, GridOf(origin, resolution_m, map, 1), solid, map, {threads});
}

void BindRadio(nb::module_& m) {
  nb::class_<propagation::RadioModel>(m, "RadioModel")
      .def(
          "__init__",
          [](propagation::RadioModel* self, double tx_power_dbm, double constant_loss_db, double slope_db,
             double min_distance_m, double floor_loss_db, double floor_exponent) {
            new (self) propagation::RadioModel{tx_power_dbm,   constant_loss_db, slope_db,
                                               min_distance_m, floor_loss_db,    floor_exponent};
          },
          nb::kw_only(), "tx_power_dbm"_a, "constant_loss_db"_a, "slope_db"_a, "min_distance_m"_a, "floor_loss_db"_a,
          "floor_exponent"_a);
  m.def("path_loss_db", &PathLoss, "faces"_a, "model"_a, "a_m"_a, "b_m"_a, "floors_crossed"_a = 0);
  m.def(
      "rssi_matrix_dbm",
      [](const propagation::FaceSet& faces, const propagation::RadioModel& model,
         const Eigen::Ref<const propagation::Positions>& positions_m) {
        return propagation::RssiMatrixDbm(faces, model, positions_m);
      },
      "faces"_a, "model"_a, "positions_m"_a);
  m.def(
      "write_rssi_matrix_dbm",
      [](const propagation::FaceSet& faces, const propagation::RadioModel& model,
         const Eigen::Ref<const propagation::Positions>& positions_m,
         Eigen::Ref<propagation::CellValues> out) { propagation::WriteRssiMatrixDbm(faces, model, positions_m, out); },
      "faces"_a, "model"_a, "positions_m"_a, "out"_a);
  m.def("write_best_rssi_map_dbm", &WriteBestMap, "faces"_a, "model"_a, "transmitters_m"_a, "floors_crossed"_a,
        "origin_m"_a, "resolution_m"_a, "out"_a, "threads"_a);
  m.def("write_rssi_maps_dbm", &WriteMaps, "faces"_a, "model"_a, "transmitters_m"_a, "floors_crossed"_a, "origin_m"_a,
        "resolution_m"_a, "out"_a, "threads"_a);
  nb::class_<propagation::WeightMap>(m, "WeightMap")
      .def(
          "__init__",
          [](propagation::WeightMap* self, const propagation::FaceSet& faces, const base::Point& tx_m,
             const base::Point& origin_m, double resolution_m, int rows, int columns) {
            new (self) propagation::WeightMap(faces, propagation::RoundToMm(tx_m, "tx_m"),
                                              {origin_m, resolution_m, rows, columns});
          },
          "faces"_a, "tx_m"_a, "origin_m"_a, "resolution_m"_a, "rows"_a, "columns"_a)
      .def("update", &propagation::WeightMap::Update, "faces"_a)
      .def(
          "write_rssi_dbm",
          [](const propagation::WeightMap& weights, const propagation::RadioModel& model, int floors_crossed,
             propagation::MapView out) { weights.WriteValues(propagation::RadioFading(model, floors_crossed), out); },
          "model"_a, "floors_crossed"_a, "out"_a);
}

void BindVoice(nb::module_& m) {
  nb::class_<propagation::VoiceModel>(m, "VoiceModel")
      .def(
          "__init__",
          [](propagation::VoiceModel* self, double noise_db, double unit_db, double min_distance_m) {
            new (self) propagation::VoiceModel{noise_db, unit_db, min_distance_m};
          },
          nb::kw_only(), "noise_db"_a, "unit_db"_a, "min_distance_m"_a);
  nb::class_<propagation::VoiceSource>(m, "VoiceSource")
      .def(
          "__init__",
          [](propagation::VoiceSource* self, const base::Point& position_m, double constant_db, double exponent) {
            new (self) propagation::VoiceSource{position_m, constant_db, exponent};
          },
          "position_m"_a, "constant_db"_a, "exponent"_a);
  m.def(
      "voice_level_db",
      [](const propagation::FaceSet& faces, const propagation::VoiceModel& model,
         const propagation::VoiceSource& source, const base::Point& at_m) {
        return propagation::VoiceLevelDb(faces, model, source, propagation::RoundToMm(at_m, "at_m"));
      },
      "faces"_a, "model"_a, "source"_a, "at_m"_a);
  m.def("write_voice_map_db", &WriteVoices, "faces"_a, "model"_a, "sources"_a, "origin_m"_a, "resolution_m"_a,
        "solid"_a, "out"_a, "threads"_a);
}

}  // namespace

void BindPropagation(nb::module_&& m) {
  nb::class_<propagation::FaceSet>(m, "FaceSet")
      .def(nb::init<const std::vector<std::array<std::int64_t, 4>>&, const std::vector<std::int32_t>&>(), "ends_mm"_a,
           "weights"_a)
      .def("set_active", &propagation::FaceSet::SetActive, "face"_a, "active"_a)
      .def(
          "weight_between",
          [](const propagation::FaceSet& faces, const base::Point& a_m, const base::Point& b_m) {
            return faces.WeightBetween(propagation::RoundToMm(a_m, "a_m"), propagation::RoundToMm(b_m, "b_m"));
          },
          "a_m"_a, "b_m"_a);
  BindRadio(m);
  BindVoice(m);
}

}  // namespace robotteamsim::bindings

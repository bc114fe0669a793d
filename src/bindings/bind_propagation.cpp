// Floor 2: how radio and voice fade.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "arrays.hpp"
#include "bindings.hpp"
#include "fast_calls.hpp"
#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/radio.hpp"
#include "robotteamsim/propagation/voice.hpp"
#include "tuples.hpp"

namespace py = pybind11;

namespace robotteamsim::bindings {
namespace {

using XY = std::pair<double, double>;

Point ToPoint(const XY& xy) { return {xy.first, xy.second}; }

PointMm ToMm(const XY& xy, const char* name) { return RoundToMm(ToPoint(xy), name); }

std::vector<FieldSource> RadioSources(const RadioModel& model, const std::vector<XY>& transmitters,
                                      int floors_crossed) {
  const Fading fading = RadioFading(model, floors_crossed);
  std::vector<FieldSource> sources;
  for (const XY& transmitter : transmitters) sources.push_back({ToMm(transmitter, "tx_m"), fading});
  return sources;
}

double PathLoss(const FaceSet& faces, const RadioModel& model, const XY& a, const XY& b, int floors_crossed) {
  return PathLossDb(faces, model, ToMm(a, "a_m"), ToMm(b, "b_m"), floors_crossed);
}

/// Returns the grid of one of `count` maps of equal shape that lie one below the other in an array.
GridShape GridOf(const XY& origin, double resolution_m, const MapView& maps, std::size_t count) {
  return {ToPoint(origin), resolution_m,
          static_cast<int>(maps.rows() / std::max<Eigen::Index>(static_cast<Eigen::Index>(count), 1)),
          static_cast<int>(maps.cols())};
}

/// What robots hear by one voice map.
class VoiceEar {
 public:
  using Values = py::array_t<float, py::array::c_style>;

  VoiceEar(const XY& origin, double resolution_m, Values values, double radius_m, py::type reading)
      : values_(std::move(values)),
        radius_(radius_m),
        readings_(std::move(reading)),
        places_(py::type::of(py::tuple())) {
    if (values_.ndim() != 2) throw std::invalid_argument("values must have shape (rows, cols)");
    grid_ = {ToPoint(origin), resolution_m, static_cast<int>(values_.shape(0)), static_cast<int>(values_.shape(1))};
  }

  // A `VoiceReading` of each robot: the value of its own cell, 0 beyond the map; whether a cell within the radius is
  // above 0; the centre of the highest such cell, or where the robot is; its value, or 0.
  py::tuple Hear(const Doubles& positions_m) {
    if (positions_m.ndim() != 2 || positions_m.shape(1) != 2) throw std::invalid_argument("positions_m must be (n, 2)");
    py::tuple heard(positions_m.shape(0));
    last_.resize(static_cast<std::size_t>(positions_m.shape(0)));
    for (py::ssize_t i = 0; i < positions_m.shape(0); ++i) {
      const double* const position = positions_m.data() + 2 * i;
      PyTuple_SET_ITEM(heard.ptr(), i, HearAt({position[0], position[1]}, &last_[i]).release().ptr());
    }
    return heard;
  }

 private:
  // Args: last: the loudest cell when the robot heard last.
  py::object HearAt(const Point& at, std::optional<Cell>* last) const {
    if (!std::isfinite(at.x) || !std::isfinite(at.y)) {
      throw py::value_error(py::str("position_m must be finite, got ({}, {})").format(at.x, at.y));
    }
    const Eigen::Map<const MapValues> values(values_.data(), grid_.rows, grid_.cols);
    const double row = std::floor((at.y - grid_.origin.y) / grid_.resolution);
    const double col = std::floor((at.x - grid_.origin.x) / grid_.resolution);
    const bool is_inside = row >= 0.0 && row < grid_.rows && col >= 0.0 && col < grid_.cols;
    const double own = is_inside ? values(static_cast<int>(row), static_cast<int>(col)) : 0.0F;
    const std::optional<Cell> cell = LoudestCell(grid_, values, at, radius_, *last);
    *last = cell;
    const Point best = cell ? CellCenter(grid_, cell->row, cell->col) : at;
    py::object place = places_.Of({PyFloat_FromDouble(best.x), PyFloat_FromDouble(best.y)});
    return readings_.Of({PyFloat_FromDouble(own), py::bool_(cell.has_value()).release().ptr(), place.release().ptr(),
                         PyFloat_FromDouble(cell ? cell->value : 0.0)});
  }

  Values values_;
  double radius_;
  TupleClass readings_, places_;
  GridShape grid_;
  std::vector<std::optional<Cell>> last_;  // of each robot
};

void BindRadio(py::module_& m) {
  py::class_<RadioModel>(m, "RadioModel")
      .def(py::init([](double tx_power_dbm, double constant_loss_db, double slope_db, double min_distance_m,
                       double floor_loss_db, double floor_exponent) {
             return RadioModel{tx_power_dbm, constant_loss_db, slope_db, min_distance_m, floor_loss_db, floor_exponent};
           }),
           py::kw_only(), py::arg("tx_power_dbm"), py::arg("constant_loss_db"), py::arg("slope_db"),
           py::arg("min_distance_m"), py::arg("floor_loss_db"), py::arg("floor_exponent"));
  DefFast<&PathLoss>(m, "path_loss_db");
  m.def("rssi_matrix_dbm",
        [](const FaceSet& faces, const RadioModel& model, const Eigen::Ref<const Positions>& positions) {
          return RssiMatrixDbm(faces, model, positions);
        });
  m.def("write_rssi_matrix_dbm",
        [](const FaceSet& faces, const RadioModel& model, const Eigen::Ref<const Positions>& positions,
           Eigen::Ref<CellValues> rssi_dbm) { WriteRssiMatrixDbm(faces, model, positions, rssi_dbm); });
  // Maps are written into arrays of the caller; other Python threads run on meanwhile.
  m.def("write_best_rssi_map_dbm",
        [](const FaceSet& faces, const RadioModel& model, const std::vector<XY>& transmitters, int floors_crossed,
           const XY& origin, double resolution_m, MapView map, int threads) {
          const py::gil_scoped_release released;
          WriteHighest(faces, RadioSources(model, transmitters, floors_crossed), GridOf(origin, resolution_m, map, 1),
                       map, {threads});
        });
  m.def("write_rssi_maps_dbm",
        [](const FaceSet& faces, const RadioModel& model, const std::vector<XY>& transmitters, int floors_crossed,
           const XY& origin, double resolution_m, MapView maps, int threads) {
          const py::gil_scoped_release released;
          const GridShape grid = GridOf(origin, resolution_m, maps, transmitters.size());
          WriteEach(faces, RadioSources(model, transmitters, floors_crossed), grid, maps, {threads});
        });
  py::class_<WeightMap>(m, "WeightMap")
      .def(py::init(
          [](const FaceSet& faces, const XY& source, const XY& origin, double resolution_m, int rows, int cols) {
            return WeightMap(faces, ToMm(source, "tx_m"), {ToPoint(origin), resolution_m, rows, cols});
          }))
      .def("update", &WeightMap::Update)
      .def("write_rssi_dbm", [](const WeightMap& weights, const RadioModel& model, int floors_crossed, MapView map) {
        weights.WriteValues(RadioFading(model, floors_crossed), map);
      });
}

void BindVoice(py::module_& m) {
  py::class_<VoiceModel>(m, "VoiceModel")
      .def(py::init([](double noise_db, double unit_db, double min_distance_m) {
             return VoiceModel{noise_db, unit_db, min_distance_m};
           }),
           py::kw_only(), py::arg("noise_db"), py::arg("unit_db"), py::arg("min_distance_m"));
  py::class_<VoiceSource>(m, "VoiceSource").def(py::init([](const XY& position, double constant_db, double exponent) {
    return VoiceSource{ToPoint(position), constant_db, exponent};
  }));
  m.def("voice_level_db", [](const FaceSet& faces, const VoiceModel& model, const VoiceSource& source, const XY& at) {
    return VoiceLevelDb(faces, model, source, ToMm(at, "at_m"));
  });
  m.def("write_voice_map_db",
        [](const FaceSet& faces, const VoiceModel& model, const std::vector<VoiceSource>& sources, const XY& origin,
           double resolution_m, const Eigen::Ref<const SolidCells>& solid, MapView map, int threads) {
          const py::gil_scoped_release released;
          WriteVoiceMap(faces, model, sources, GridOf(origin, resolution_m, map, 1), solid, map, {threads});
        });
  py::class_<VoiceEar> ear(m, "VoiceEar");
  ear.def(py::init<const XY&, double, VoiceEar::Values, double, py::type>(), py::arg("origin"), py::arg("resolution_m"),
          py::arg("values"), py::arg("radius_m"), py::arg("reading"));
  DefFast<&VoiceEar::Hear>(ear, "hear");
}

}  // namespace

void BindPropagation(py::module_& m) {
  py::class_<FaceSet>(m, "FaceSet")
      .def(py::init<const std::vector<std::array<std::int64_t, 4>>&, const std::vector<std::int32_t>&>(),
           py::arg("ends_mm"), py::arg("weights"))
      .def("set_active", &FaceSet::SetActive)
      .def("weight_between", [](const FaceSet& faces, const XY& a, const XY& b) {
        return faces.WeightBetween(ToMm(a, "a_m"), ToMm(b, "b_m"));
      });
  BindRadio(m);
  BindVoice(m);
}

}  // namespace robotteamsim::bindings

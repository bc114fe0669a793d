#include "robotteamsim/propagation/radio.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace robotteamsim {
namespace {

double LossDb(const RadioModel& model, PointMm a, PointMm b, std::int64_t wall_units) {
  const double distance_m = std::max(DistanceM(a, b), model.min_distance_m);
  const double one_slope_db = model.constant_loss_db + model.slope_db * std::log10(distance_m);  // (2)
  return one_slope_db + static_cast<double>(wall_units) / kRadioUnitsPerDb;                      // (3), (4)
}

}  // namespace

double FloorLossDb(const RadioModel& model, int floors_crossed) {
  if (floors_crossed < 0) {
    throw std::invalid_argument("floors_crossed must be >= 0, got " + std::to_string(floors_crossed));
  }
  const double k = floors_crossed;
  return k == 0.0 ? 0.0 : std::pow(k, (k + 2.0) / (k + 1.0) - model.floor_exponent) * model.floor_loss_db;
}

double PathLossDb(const FaceSet& faces, const RadioModel& model, PointMm a, PointMm b, int floors_crossed) {
  return LossDb(model, a, b, faces.WeightBetween(a, b)) + FloorLossDb(model, floors_crossed);
}

CellValues RssiMatrixDbm(const FaceSet& faces, const RadioModel& model, const Eigen::Ref<const Positions>& positions) {
  const Eigen::Index n = positions.rows();
  std::vector<PointMm> points;
  for (Eigen::Index i = 0; i < n; ++i) {
    points.push_back(RoundToMm({positions(i, 0), positions(i, 1)}, "position of robot " + std::to_string(i)));
  }
  CellValues rssi_dbm = CellValues::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = i + 1; j < n; ++j) {
      rssi_dbm(i, j) = rssi_dbm(j, i) = model.tx_power_dbm - PathLossDb(faces, model, points[i], points[j]);
    }
  }
  return rssi_dbm;
}

Fading RadioFading(const RadioModel& model, int floors_crossed) {
  const double constant_db = model.tx_power_dbm - model.constant_loss_db - FloorLossDb(model, floors_crossed);
  return {constant_db, model.slope_db, 1.0 / kRadioUnitsPerDb, model.min_distance_m};
}

}  // namespace robotteamsim

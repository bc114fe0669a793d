#include "robotteamsim/propagation/radio.hpp"

#include <algorithm>
#include <cmath>
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

double PathLossDb(const FaceSet& faces, const RadioModel& model, PointMm a, PointMm b) {
  return LossDb(model, a, b, faces.WeightBetween(a, b));
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

CellValues RssiMapDbm(const FaceSet& faces, const RadioModel& model, PointMm transmitter, const GridShape& grid) {
  const CellCentersMm centers(grid);
  CellValues rssi_dbm(grid.rows, grid.cols);
  for (int row = 0; row < grid.rows; ++row) {
    const std::vector<std::int64_t> units = faces.WeightsAlongRow(transmitter, centers.y[row], centers.x);
    for (int col = 0; col < grid.cols; ++col) {
      const PointMm cell{centers.x[col], centers.y[row]};
      rssi_dbm(row, col) = model.tx_power_dbm - LossDb(model, transmitter, cell, units[col]);
    }
  }
  return rssi_dbm;
}

}  // namespace robotteamsim

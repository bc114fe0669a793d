#pragma once

#include <Eigen/Core>

#include "robotteamsim/plan/types.hpp"
#include "robotteamsim/propagation/cells.hpp"
#include "robotteamsim/propagation/face_set.hpp"

namespace robotteamsim {

/// Faces for radio weigh in units of 0.05 dB: half of every loss in Table 3 is a whole number of them.
constexpr double kRadioUnitsPerDb = 20.0;

/// The multi-wall radio model on one floor [dissertation, eq. 2-4]; the walls are in the faces.
struct RadioModel {
  double tx_power_dbm = 0.0;
  double constant_loss_db = 0.0;  ///< l0 + l_c
  double slope_db = 0.0;          ///< 10 * gamma
  double min_distance_m = 0.0;    ///< distances below count as this
};

/// Positions [m], one row per robot.
using Positions = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

/// Returns L of eq. (3) between two points [dB]: l0 + l_c + 10 gamma log10(d) + losses of walls and closed doors.
double PathLossDb(const FaceSet& faces, const RadioModel& model, PointMm a, PointMm b);

/// Returns the signal strength between all pairs of robots [dBm]: tx power - L; symmetric to the bit, diagonal 0.
/// Throws std::invalid_argument, naming the robot, where a position is not finite.
CellValues RssiMatrixDbm(const FaceSet& faces, const RadioModel& model, const Eigen::Ref<const Positions>& positions);

/// Returns the signal strength at the centre of every cell for one transmitter [dBm].
CellValues RssiMapDbm(const FaceSet& faces, const RadioModel& model, PointMm transmitter, const GridShape& grid);

}  // namespace robotteamsim

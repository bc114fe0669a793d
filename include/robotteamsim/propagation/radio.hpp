#pragma once

#include <Eigen/Core>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/base/simd.hpp"
#include "robotteamsim/propagation/cells.hpp"
#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/maps/field_maps.hpp"

namespace robotteamsim::propagation {

/// Faces for radio weigh in units of 0.05 dB: half of every loss in Table 3 is a whole number of them.
constexpr double kRadioUnitsPerDb = 20.0;

/// The multi-wall radio model [dissertation, eq. 2-4]; the walls of the floor are in the faces.
struct RadioModel {
  double tx_power_dbm = 0.0;
  double constant_loss_db = 0.0;  ///< l0 + l_c
  double slope_db = 0.0;          ///< 10 * gamma
  double min_distance_m = 0.0;    ///< distances below count as this
  double floor_loss_db = 0.0;     ///< L_f, of the first floor crossed
  double floor_exponent = 0.0;    ///< b: how much less each further one costs
};

/// Returns the loss of the floors crossed [dB]: k^((k + 2) / (k + 1) - b) L_f, the last term of eq. (4); 0 for none.
/// Throws std::invalid_argument where their number is negative.
double FloorLossDb(const RadioModel& model, int floors_crossed);

/// Positions [m], one row per robot.
using Positions = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

/// Returns L of eq. (3) between two points [dB]: l0 + l_c + 10 gamma log10(d) + losses of walls, closed doors and
/// floors.
double PathLossDb(const FaceSet& faces, const RadioModel& model, PointMm a, PointMm b, int floors_crossed = 0);

/// Writes the signal strength between all pairs of robots [dBm]: tx power - L; symmetric to the bit, diagonal 0.
/// Each is tx power - PathLossDb to the bit, with any instruction set.
/// Throws std::invalid_argument, naming the robot, where a position is not finite, and where the matrix is not of one
/// row and one column per robot.
void WriteRssiMatrixDbm(const FaceSet& faces, const RadioModel& model, const Eigen::Ref<const Positions>& positions,
                        Eigen::Ref<CellValues> rssi_dbm, base::Simd simd = base::BestSimd());

/// Returns what WriteRssiMatrixDbm writes, in fresh memory: a large matrix takes an eighth longer.
CellValues RssiMatrixDbm(const FaceSet& faces, const RadioModel& model, const Eigen::Ref<const Positions>& positions,
                         base::Simd simd = base::BestSimd());

/// Returns how the signal of a transmitter fades [dBm], for maps: tx power - L, within 4e-5 dB.
Fading RadioFading(const RadioModel& model, int floors_crossed = 0);

}  // namespace robotteamsim::propagation

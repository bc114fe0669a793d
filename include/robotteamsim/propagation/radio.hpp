#pragma once

#include <Eigen/Core>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/base/simd.hpp"
#include "robotteamsim/propagation/cells.hpp"
#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/maps/field_maps.hpp"

namespace robotteamsim::propagation {

/// The unit of radio faces is 0.05 dB: half of every loss in Table 3 is a multiple of it.
constexpr double kRadioUnitsPerDb = 20.0;

/// The multi-wall radio model [dissertation, eq. 2-4]; the faces hold the walls of the floor.
struct RadioModel {
  double tx_power_dbm = 0.0;
  double constant_loss_db = 0.0;  ///< l0 + l_c
  double slope_db = 0.0;          ///< 10 * gamma
  double min_distance_m = 0.0;    ///< lower limit of distances
  double floor_loss_db = 0.0;     ///< L_f, of the first floor crossed
  double floor_exponent = 0.0;    ///< b: reduces the loss of further floors
};

/// Returns the loss of the floors crossed [dB]: k^((k + 2) / (k + 1) - b) L_f, the last term of eq. (4); 0 for none.
/// Throws std::invalid_argument if their number is negative or the loss is not finite.
double FloorLossDb(const RadioModel& model, int floors_crossed);

/// Throws std::invalid_argument if a number of a model is not finite or its shortest distance is not above 0.
void CheckRadioModel(const RadioModel& model);

/// Positions [m], one row per robot.
using Positions = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

/// Returns L of eq. (3) between two points [dB]: l0 + l_c + 10 gamma log10(d) + losses of walls, closed doors and
/// floors. Args: floors_crossed: besides those between the storeys of the building.
double PathLossDb(const FaceSet& faces, const RadioModel& model, PointMm a, PointMm b, int floors_crossed = 0);

/// Writes the signal strength between all pairs of robots [dBm]: tx power - L; symmetric to the bit, diagonal 0. Each
/// value is tx power - PathLossDb to the bit, with any instruction set.
/// Throws std::invalid_argument, naming the robot, if a position is not finite or the matrix does not have one row and
/// one column per robot.
void WriteRssiMatrixDbm(const FaceSet& faces, const RadioModel& model, const Eigen::Ref<const Positions>& positions,
                        Eigen::Ref<CellValues> rssi_dbm, base::Simd simd = base::BestSimd());

/// Returns the matrix of WriteRssiMatrixDbm in new memory, which takes an eighth longer for a large matrix.
CellValues RssiMatrixDbm(const FaceSet& faces, const RadioModel& model, const Eigen::Ref<const Positions>& positions,
                         base::Simd simd = base::BestSimd());

/// Returns the fading of a transmitter's signal for maps [dBm]: tx power - L, within 4e-5 dB.
Fading RadioFading(const RadioModel& model, int floors_crossed = 0);

/// Returns the sources of transmitters' signals, with the fading of RadioFading. Args: storeys: of the building.
/// Throws std::invalid_argument if a position is not finite or beyond 1000 km.
std::vector<FieldSource> RadioSources(const RadioModel& model, const std::vector<base::Point>& transmitters,
                                      int floors_crossed = 0, int storeys = 1);

}  // namespace robotteamsim::propagation

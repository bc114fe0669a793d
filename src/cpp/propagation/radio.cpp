#include "robotteamsim/propagation/radio.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/base/large_pages.hpp"
#include "robotteamsim/base/log10.hpp"
#include "robotteamsim/propagation/links/link_weights.hpp"
#include "robotteamsim/propagation/links/storey_links.hpp"

namespace robotteamsim::propagation {
namespace {

/// Above any number of floors.
constexpr int kMostFloors = 1'000'000'000;

void CheckFloors(int floors_crossed) {
  if (floors_crossed < 0) {
    throw std::invalid_argument("floors_crossed must be >= 0, got " + std::to_string(floors_crossed));
  }
  if (floors_crossed > kMostFloors) {
    throw std::invalid_argument("floors_crossed must be at most " + std::to_string(kMostFloors) + ", got " +
                                std::to_string(floors_crossed));
  }
}

/// Returns L of eq. (3), (4) without floors; shared by single losses and rows of links, so that both agree to the bit.
ROBOTTEAMSIM_INLINE double LossDb(const RadioModel& model, double square_mm2, double wall_units) {
  const double min_mm = model.min_distance_m * 1000.0;
  const double limited_mm2 = std::max(square_mm2, min_mm * min_mm);
  const double one_slope_db = model.constant_loss_db + 0.5 * model.slope_db * base::Log10(limited_mm2 * 1e-6);  // (2)
  return one_slope_db + wall_units / kRadioUnitsPerDb;  // (3), (4)
}

/// Writes the signals of the links from a robot to those after it. They are computed in the order of the targets and
/// then gathered, so that the matrix, too large for the caches, is written sequentially.
/// Args: signals_dbm: room for whole blocks of targets.
ROBOTTEAMSIM_INLINE void WriteSignals(const RadioModel& model, const LinkTargets& targets,
                                      double* __restrict signals_dbm, double* __restrict rssi_dbm) {
  const RadioModel m = model;
  const int count = targets.count;
  for (int first = 0; first < count; first += kLinkLanes) {
    const TargetBlock& block = targets.blocks[first / kLinkLanes];
#pragma GCC unroll 1  // if unrolled here, the lanes would not be vectorised
    for (int i = 0; i < kLinkLanes; ++i) {
      const double square_mm2 = block.x[i] * block.x[i] + block.y[i] * block.y[i];
      signals_dbm[first + i] = m.tx_power_dbm - LossDb(m, square_mm2, block.weight[i]);
    }
  }
  const std::int32_t* __restrict const places = targets.places;
  for (int i = 0; i < count; ++i) rssi_dbm[i] = signals_dbm[places[i]];
}

/// Up to this number of robots, single links are as fast as tables of directions and faces.
constexpr Eigen::Index kFewRobots = 8;

void WriteFewSignals(const FaceSet& faces, const RadioModel& model, const std::vector<PointMm>& points,
                     Eigen::Ref<CellValues> rssi_dbm) {
  const auto n = static_cast<Eigen::Index>(points.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    rssi_dbm(i, i) = 0.0;
    for (Eigen::Index j = i + 1; j < n; ++j) {
      rssi_dbm(i, j) = rssi_dbm(j, i) = model.tx_power_dbm - PathLossDb(faces, model, points[i], points[j]);
    }
  }
}

/// Number of rows of a large matrix that are mirrored together: enough that writes fill whole cache lines.
constexpr Eigen::Index kMirroredRows = 32;

/// Copies the part above the diagonal of rows top .. end - 1 of a square matrix below the diagonal.
void MirrorRows(Eigen::Index top, Eigen::Index end, Eigen::Ref<CellValues> matrix) {
  constexpr Eigen::Index kAhead = 8;  // rows; they are a whole row apart, which processors do not prefetch themselves
  constexpr Eigen::Index kPerLine = 64 / sizeof(double);
  const Eigen::Index size = matrix.rows();
  for (Eigen::Index row = top + 1; row < size; ++row) {
    if (row + kAhead < size) {
      for (Eigen::Index col = top; col < end + kPerLine - 1; col += kPerLine) {
        __builtin_prefetch(&matrix(row + kAhead, std::min(col, end - 1)), 1);
      }
    }
    for (Eigen::Index col = top; col < std::min(end, row); ++col) matrix(row, col) = matrix(col, row);
  }
}

/// Writes the signals between robots on one storey.
void WriteStoreySignals(const FaceSet& faces, const RadioModel& model, const std::vector<PointMm>& points,
                        Eigen::Ref<CellValues> rssi_dbm, base::Simd simd);

/// Writes the signals between robots on several storeys.
class BuildingSignals {
 public:
  BuildingSignals(const FaceSet& faces, const RadioModel& model, const std::vector<PointMm>& points, base::Simd simd)
      : faces_(faces), model_(model), simd_(simd), on_storey_(faces.storeys().size()), links_(faces, simd) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      Team& team = on_storey_[faces.StoreyOf(points[i])];
      team.robots.push_back(static_cast<Eigen::Index>(i));
      team.points.push_back(points[i]);
    }
    for (std::size_t k = 0; k <= on_storey_.size(); ++k) floors_db_.push_back(FloorLossDb(model, static_cast<int>(k)));
  }

  void Write(Eigen::Ref<CellValues> rssi_dbm) {
    for (std::size_t i = 0; i < on_storey_.size(); ++i) {
      const Team& team = on_storey_[i];
      const auto count = static_cast<Eigen::Index>(team.robots.size());
      CellValues signals_dbm(count, count);
      WriteStoreySignals(faces_.OnStorey(i), model_, team.points, signals_dbm, simd_);
      rssi_dbm(team.robots, team.robots) = signals_dbm;
      for (std::size_t j = 0; j < on_storey_.size(); ++j) {
        if (faces_.IsAbove(j, i)) WriteBetween(i, j, rssi_dbm);
      }
    }
  }

 private:
  struct Team {
    std::vector<Eigen::Index> robots;
    std::vector<PointMm> points;
  };

  void WriteBetween(std::size_t low, std::size_t high, Eigen::Ref<CellValues> rssi_dbm) {
    const Team &below = on_storey_[low], &above = on_storey_[high];
    if (below.robots.empty() || above.robots.empty()) return;
    const CellValues weights = links_.WallsBetween(low, below.points, high, above.points);
    for (Eigen::Index i = 0; i < weights.rows(); ++i) {
      for (Eigen::Index j = 0; j < weights.cols(); ++j) {
        const Ray ray = faces_.ThroughFloors(low, below.points[i], high, above.points[j]);
        const double units = weights(i, j) + static_cast<double>(ray.weight);
        const double signal_dbm =
            model_.tx_power_dbm - (LossDb(model_, ray.square_mm2, units) + floors_db_[ray.floors]);
        rssi_dbm(below.robots[i], above.robots[j]) = rssi_dbm(above.robots[j], below.robots[i]) = signal_dbm;
      }
    }
  }

  const FaceSet& faces_;
  const RadioModel& model_;
  const base::Simd simd_;
  std::vector<Team> on_storey_;
  StoreyLinks links_;
  std::vector<double> floors_db_;
};

PointMm RobotAt(const Eigen::Ref<const Positions>& positions, Eigen::Index robot) {
  const base::Point at{positions(robot, 0), positions(robot, 1)};
  // Composing a name allocates memory: only for invalid positions.
  if (std::abs(at.x) < 1e5 && std::abs(at.y) < 1e5) return RoundToMm(at, {});
  return RoundToMm(at, "position of robot " + std::to_string(robot));
}

using Signals = void (*)(const RadioModel&, const LinkTargets&, double*, double*);

#define ROBOTTEAMSIM_SIGNALS(Name, attributes)                                                            \
  attributes void Name##Signals(const RadioModel& model, const LinkTargets& targets, double* signals_dbm, \
                                double* rssi_dbm) {                                                       \
    WriteSignals(model, targets, signals_dbm, rssi_dbm);                                                  \
  }
ROBOTTEAMSIM_FOR_EACH_SIMD(ROBOTTEAMSIM_SIGNALS)

void WriteStoreySignals(const FaceSet& faces, const RadioModel& model, const std::vector<PointMm>& points,
                        Eigen::Ref<CellValues> rssi_dbm, base::Simd simd) {
  const auto n = static_cast<Eigen::Index>(points.size());
  if (n <= kFewRobots) return WriteFewSignals(faces, model, points, rssi_dbm);
  LinkWeights links(faces, simd);
  const Signals write_signals = base::SimdVersion<Signals>(simd, PortableSignals, Avx2Signals, Avx512Signals);
  std::vector<double> signals_dbm(n + kLinkLanes);
  for (Eigen::Index top = 0; top < n; top += kMirroredRows) {
    const Eigen::Index end = std::min(top + kMirroredRows, n);
    for (Eigen::Index i = top; i < end; ++i) {
      double* const diagonal = &rssi_dbm(i, i);
      *diagonal = 0.0;
      const LinkTargets later = links.From(points[i], points.data() + i + 1, static_cast<std::size_t>(n - i - 1));
      write_signals(model, later, signals_dbm.data(), diagonal + 1);
    }
    MirrorRows(top, end, rssi_dbm);
  }
}

}  // namespace

double FloorLossDb(const RadioModel& model, int floors_crossed) {
  CheckFloors(floors_crossed);
  const double k = floors_crossed;
  const double loss_db =
      k == 0.0 ? 0.0 : std::pow(k, (k + 2.0) / (k + 1.0) - model.floor_exponent) * model.floor_loss_db;
  base::Check(loss_db, "the loss of the floors");
  return loss_db;
}

void CheckRadioModel(const RadioModel& model) {
  for (const double value :
       {model.tx_power_dbm, model.constant_loss_db, model.slope_db, model.floor_loss_db, model.floor_exponent}) {
    base::Check(value, "each parameter of a radio model");
  }
  base::CheckPositive(model.min_distance_m, "min_distance_m");
}

double PathLossDb(const FaceSet& faces, const RadioModel& model, PointMm a, PointMm b, int floors_crossed) {
  CheckRadioModel(model);
  CheckFloors(floors_crossed);
  const Ray ray = faces.Between(a, b);
  return LossDb(model, ray.square_mm2, static_cast<double>(ray.weight)) +
         FloorLossDb(model, floors_crossed + ray.floors);
}

void WriteRssiMatrixDbm(const FaceSet& faces, const RadioModel& model, const Eigen::Ref<const Positions>& positions,
                        Eigen::Ref<CellValues> rssi_dbm, base::Simd simd) {
  CheckRadioModel(model);
  const Eigen::Index n = positions.rows();
  if (rssi_dbm.rows() != n || rssi_dbm.cols() != n) {
    throw std::invalid_argument("the matrix must have " + std::to_string(n) + " rows and columns, got " +
                                std::to_string(rssi_dbm.rows()) + " and " + std::to_string(rssi_dbm.cols()));
  }
  std::vector<PointMm> points;
  points.reserve(n);
  for (Eigen::Index i = 0; i < n; ++i) points.push_back(RobotAt(positions, i));
  if (faces.storeys().size() > 1) return BuildingSignals(faces, model, points, simd).Write(rssi_dbm);
  WriteStoreySignals(faces, model, points, rssi_dbm, simd);
}

CellValues RssiMatrixDbm(const FaceSet& faces, const RadioModel& model, const Eigen::Ref<const Positions>& positions,
                         base::Simd simd) {
  CellValues rssi_dbm(positions.rows(), positions.rows());
  base::AskForLargePages(rssi_dbm.data(), static_cast<std::size_t>(rssi_dbm.size()) * sizeof(double));
  WriteRssiMatrixDbm(faces, model, positions, rssi_dbm, simd);
  return rssi_dbm;
}

Fading RadioFading(const RadioModel& model, int floors_crossed) {
  CheckRadioModel(model);
  const double constant_db = model.tx_power_dbm - model.constant_loss_db - FloorLossDb(model, floors_crossed);
  return {constant_db, model.slope_db, 1.0 / kRadioUnitsPerDb, model.min_distance_m};
}

std::vector<FieldSource> RadioSources(const RadioModel& model, const std::vector<base::Point>& transmitters,
                                      int floors_crossed, int storeys) {
  const Fading fading = RadioFading(model, floors_crossed);
  std::vector<double> floors_db;
  for (int k = floors_crossed; k <= floors_crossed + storeys; ++k) {
    floors_db.push_back(FloorLossDb(model, k) - FloorLossDb(model, floors_crossed));
  }
  std::vector<FieldSource> sources;
  sources.reserve(transmitters.size());
  for (const base::Point& transmitter : transmitters) {
    sources.push_back({RoundToMm(transmitter, "tx_m"), fading, floors_db});
  }
  return sources;
}

}  // namespace robotteamsim::propagation

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::propagation {

/// A point of the map frame in whole millimetres, in which crossings are computed without rounding errors.
struct PointMm {
  std::int64_t x = 0;
  std::int64_t y = 0;
};

/// Largest coordinate of the exact arithmetic [mm]: 1000 km, so that every product fits 64 bits.
constexpr std::int64_t kMaxCoordinateMm = 1'000'000'000;

/// Returns a point [m] rounded to whole millimetres, halves (within 1e-6 mm, for rounding errors) away from zero.
/// Throws std::invalid_argument, naming `place`, if a coordinate is not finite or beyond 1000 km.
PointMm RoundToMm(const base::Point& point, std::string_view place);

/// Returns the distance between two points [m].
double DistanceM(PointMm a, PointMm b);

/// A segment with a weight for each ray that crosses it.
struct Face {
  PointMm start;
  PointMm end;
  std::int32_t weight = 0;       ///< 0 if it is not active
  std::size_t start_vertex = 0;  ///< index in FaceSet::Vertices()
  std::size_t end_vertex = 0;
};

/// One level of a building: the part of the plan in which it is drawn, and where that lies in the building.
struct Storey {
  /// The weight of a floor that counts as one of `Ray::floors`.
  static constexpr std::int32_t kCounted = -1;

  PointMm least;  ///< the corners of its part of the plan
  PointMm most;
  PointMm origin;                              ///< lies exactly above or below the origins of the others
  std::int64_t floor_mm = 0;                   ///< height of its floor
  std::int64_t ceiling_mm = 0;                 ///< rays above it do not meet its walls
  std::int32_t floor_weight = kCounted;        ///< of its floor
  std::vector<std::vector<PointMm>> openings;  ///< polygons in its floor, through which rays pass without loss
};

/// What lies on the straight line between two points.
struct Ray {
  double square_mm2 = 0.0;  ///< of its length
  std::int64_t weight = 0;  ///< sum over the faces that it crosses, and the floors that have a weight
  int floors = 0;           ///< number of other floors that it crosses
};

/// Returns the point at a share of the way from a to b, rounded to whole millimetres.
PointMm Along(PointMm a, PointMm b, double share);

/// Returns whether a point is to the left of a face, seen from its start to its end, with the tie rule of FaceSet.
bool IsLeftOf(const Face& face, PointMm point);

/// The faces of a floor plan: segments with a weight for each ray that crosses them. Weights are integers, so their
/// sums are exact in any order; the unit (0.05 dB, half a wall) is chosen by the caller.
///
/// A tie, a ray through the end of a face or along it, is broken by shifting all faces by the same infinitely small
/// (eps, eps^2) [edelsbrunner1990]. The shifted faces have no ties, so the weight from a to b is that from b to a, and
/// a longer ray never weighs less.
///
/// The levels of a building lie side by side in its plan. Between two of them a ray is straight in space: its ends are
/// `kHeightMm` above the floors, and it crosses the faces of each level that it passes below its ceiling, and the
/// floors in between, except for their openings. It is the same in both directions.
class FaceSet {
 public:
  static constexpr std::int64_t kHeightMm = 500;

  /// Args: ends: x1, y1, x2, y2 of each face [mm], two different points; weights: of each face, >= 0; storeys: none if
  /// everything is on one level.
  /// Throws std::invalid_argument if the lists have different lengths, a coordinate is beyond 1000 km, a face, weight
  /// or storey is invalid, or two storeys have floors at the same height.
  FaceSet(const std::vector<std::array<std::int64_t, 4>>& ends, const std::vector<std::int32_t>& weights,
          std::vector<Storey> storeys = {});

  std::size_t Size() const { return weight_.size(); }
  Face At(std::size_t face) const;

  /// The current weight of each face, 0 if it is not active.
  const std::vector<std::int32_t>& Weights() const { return weight_; }

  /// The distinct end points of the faces.
  const std::vector<PointMm>& Vertices() const { return vertices_; }

  /// The sum of the weights of all faces, active or not: an upper bound for any ray.
  std::int64_t TotalWeight() const { return total_weight_; }

  /// Activates a face (a closed door) or deactivates it (an open door). Throws std::invalid_argument if there is no
  /// such face.
  void SetActive(std::size_t face, bool active);

  /// Returns the sum of the weights of the faces that the segment from a to b crosses in the plan.
  std::int64_t WeightBetween(PointMm a, PointMm b) const;

  const std::vector<Storey>& storeys() const { return storeys_; }

  /// Returns the index of the storey in which a point lies, or of the nearest one; 0 without storeys.
  std::size_t StoreyOf(PointMm point) const;

  /// Returns what lies between two points in the building: without storeys, and on one storey, WeightBetween.
  Ray Between(PointMm a, PointMm b) const;

  /// A storey that rays between two others pass, and between which shares of their way.
  struct Passed {
    std::size_t storey;
    double from;
    double to;
  };

  /// What rays from a storey to one above have in common.
  struct Rise {
    double square_mm2 = 0.0;         ///< of the difference of heights; all else is only for a storey above
    double leaving = 0.0;            ///< share of the way at which they leave the lower storey
    double entering = 0.0;           ///< .. and enter the upper one
    std::vector<Passed> floors;      ///< the floors that they cross, all at `from`
    std::vector<Passed> in_between;  ///< the storeys whose faces they cross besides
  };

  /// Returns the faces of a storey alone.
  const FaceSet& OnStorey(std::size_t storey) const { return on_storey_[storey]; }
  const Rise& RiseOf(std::size_t low, std::size_t high) const { return rises_[low * storeys_.size() + high]; }

  /// Returns a point of one storey as if it were on another, exactly above or below.
  PointMm Moved(PointMm point, std::size_t from, std::size_t to) const {
    const PointMm a = storeys_[from].origin, b = storeys_[to].origin;
    return {point.x - a.x + b.x, point.y - a.y + b.y};
  }

  bool IsAbove(std::size_t storey, std::size_t other) const {
    return storeys_[storey].floor_mm > storeys_[other].floor_mm;
  }

  // Of a ray between points of two storeys, in any order:

  /// Returns the square of its length [mm^2].
  double SquareBetween(std::size_t of_a, PointMm a, std::size_t of_b, PointMm b) const;

  /// Returns its length and what the floors cost.
  Ray ThroughFloors(std::size_t of_a, PointMm a, std::size_t of_b, PointMm b) const;

  /// Returns the sum of the weights of the faces that it crosses: on the storeys in between, of those up to where it
  /// leaves the storey, less those up to where it enters it.
  std::int64_t WallsBetween(std::size_t of_a, PointMm a, std::size_t of_b, PointMm b) const;

 private:
  /// The bounding box of consecutive faces, edges included.
  struct Box {
    PointMm least;
    PointMm most;
  };

  void NumberVertices();
  void BoxFaces();
  void CheckStoreys() const;
  void DivideFaces();
  Rise RiseBetween(std::size_t low, std::size_t high) const;

  // One array per quantity, for the loop over all faces.
  std::vector<std::int64_t> start_x_;
  std::vector<std::int64_t> start_y_;
  std::vector<std::int64_t> end_x_;
  std::vector<std::int64_t> end_y_;
  std::vector<std::int32_t> weight_;       // 0 if the face is not active
  std::vector<std::int32_t> full_weight_;  // where it is
  std::vector<Box> boxes_;                 // one for each kFacesPerBox consecutive faces
  std::vector<PointMm> vertices_;
  std::vector<std::array<std::size_t, 2>> vertices_of_face_;  // start, end
  std::int64_t total_weight_ = 0;
  std::vector<Storey> storeys_;
  std::vector<Rise> rises_;                                           // from each storey to each, if there are several
  std::vector<FaceSet> on_storey_;                                    // likewise
  std::vector<std::pair<std::size_t, std::size_t>> place_on_storey_;  // of each face: its storey, and its index there
};

}  // namespace robotteamsim::propagation

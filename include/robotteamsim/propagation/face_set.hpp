#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
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

/// Returns whether a point is to the left of a face, seen from its start to its end, with the tie rule of FaceSet.
bool IsLeftOf(const Face& face, PointMm point);

/// The faces of a floor plan: segments with a weight for each ray that crosses them. Weights are integers, so their
/// sums are exact in any order; the unit (0.05 dB, half a wall) is chosen by the caller.
///
/// A tie, a ray through the end of a face or along it, is broken by shifting all faces by the same infinitely small
/// (eps, eps^2) [edelsbrunner1990]. The shifted faces have no ties, so the weight from a to b is that from b to a, and
/// a longer ray never weighs less.
class FaceSet {
 public:
  /// Args: ends: x1, y1, x2, y2 of each face [mm], two different points; weights: of each face, >= 0.
  /// Throws std::invalid_argument if the lists have different lengths, a coordinate is beyond 1000 km, or a face or
  /// weight is invalid.
  FaceSet(const std::vector<std::array<std::int64_t, 4>>& ends, const std::vector<std::int32_t>& weights);

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

  /// Returns the sum of the weights of the faces that the segment from a to b crosses.
  std::int64_t WeightBetween(PointMm a, PointMm b) const;

 private:
  /// The bounding box of consecutive faces, edges included.
  struct Box {
    PointMm least;
    PointMm most;
  };

  void NumberVertices();
  void BoxFaces();

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
};

}  // namespace robotteamsim::propagation

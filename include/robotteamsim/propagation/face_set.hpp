#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::propagation {

/// A point of the map frame in whole millimetres: the unit in which crossings are counted, without rounding errors.
struct PointMm {
  std::int64_t x = 0;
  std::int64_t y = 0;
};

/// Largest coordinate that the exact arithmetic takes [mm]: 1000 km, so that every product fits 64 bits.
constexpr std::int64_t kMaxCoordinateMm = 1'000'000'000;

/// Returns a point [m] rounded to whole millimetres, halves away from zero.
/// Throws std::invalid_argument, naming `place`, where a coordinate is not finite or beyond 1000 km.
PointMm RoundToMm(const base::Point& point, std::string_view place);

/// Returns the distance between two points [m].
double DistanceM(PointMm a, PointMm b);

/// A segment that weighs on whatever passes through it.
struct Face {
  PointMm start;
  PointMm end;
  std::int32_t weight = 0;       ///< 0 where it is not active
  std::size_t start_vertex = 0;  ///< index in FaceSet::Vertices()
  std::size_t end_vertex = 0;
};

/// Returns whether a point lies to the left of a face from its start to its end, ties decided as FaceSet does.
bool IsLeftOf(const Face& face, PointMm point);

/// The faces of a floor plan: segments that weigh on whatever passes through them. Weights are integers, so their sums
/// are exact in any order; what a unit means (0.05 dB, half a wall) is the business of whoever made the faces.
///
/// A ray through the end of a face, or along it, is decided by moving all faces by the same infinitely small
/// (eps, eps^2) [edelsbrunner1990]. The moved faces have no such ties, so the weight from a to b is that
/// from b to a, and it never falls when a ray is made longer.
class FaceSet {
 public:
  /// Args: ends: x1, y1, x2, y2 of each face [mm], the two ends different; weights: of each face, >= 0.
  /// Throws std::invalid_argument on lists of different length, coordinates beyond 1000 km, and such faces or weights.
  FaceSet(const std::vector<std::array<std::int64_t, 4>>& ends, const std::vector<std::int32_t>& weights);

  std::size_t Size() const { return weight_.size(); }
  Face At(std::size_t face) const;

  /// The weight of each face as it is now, 0 where it is not active.
  const std::vector<std::int32_t>& Weights() const { return weight_; }

  /// The different points at which faces end.
  const std::vector<PointMm>& Vertices() const { return vertices_; }

  /// Sum of the weights of all faces, active or not: no ray weighs more.
  std::int64_t TotalWeight() const { return total_weight_; }

  /// Lets a face weigh (a closed door) or not (an open one). Throws std::invalid_argument where there is no such face.
  void SetActive(std::size_t face, bool active);

  /// Returns the sum of the weights of the faces that the segment from a to b crosses.
  std::int64_t WeightBetween(PointMm a, PointMm b) const;

 private:
  /// What faces that follow each other lie in, edges included.
  struct Box {
    PointMm least;
    PointMm most;
  };

  void NumberVertices();
  void BoxFaces();

  // One list per quantity: the loop over all faces reads them in order.
  std::vector<std::int64_t> start_x_;
  std::vector<std::int64_t> start_y_;
  std::vector<std::int64_t> end_x_;
  std::vector<std::int64_t> end_y_;
  std::vector<std::int32_t> weight_;       // 0 where the face is not active
  std::vector<std::int32_t> full_weight_;  // where it is
  std::vector<Box> boxes_;                 // of the first kFacesPerBox faces, the next ones, and so on
  std::vector<PointMm> vertices_;
  std::vector<std::array<std::size_t, 2>> vertices_of_face_;  // start, end
  std::int64_t total_weight_ = 0;
};

}  // namespace robotteamsim::propagation

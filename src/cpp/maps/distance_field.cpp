#include "robotteamsim/maps/distance_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::maps {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// From a cell at a distance between centres [cells], any point of it is nearer to any point of the occupied cell by at
/// most two half diagonals.
constexpr double kTwoHalfDiagonals = 1.4143;

/// Makes a beam enter the next cell despite rounding [cells].
constexpr double kIntoNext = 1e-9;

/// The lower envelope of parabolas [felzenszwalb2012, Section 2.1].
class Envelope {
 public:
  explicit Envelope(std::size_t size) : apex_(size), begin_(size + 1) {}

  /// Replaces each value f(q) by the least of (q - p)^2 + f(p) over all p.
  void Transform(std::vector<double>* values) {
    std::vector<double>& f = *values;
    int last = -1;
    for (int q = 0; q < static_cast<int>(f.size()); ++q) {
      if (f[q] == kInfinity) continue;
      double from = -kInfinity;
      while (last >= 0) {
        const int p = apex_[last];
        from = ((f[q] + 1.0 * q * q) - (f[p] + 1.0 * p * p)) / (2.0 * (q - p));
        if (from > begin_[last]) break;
        --last;
      }
      ++last;
      apex_[last] = q;
      begin_[last] = last == 0 ? -kInfinity : from;
    }
    if (last < 0) return;
    begin_[last + 1] = kInfinity;
    heights_ = f;
    for (int q = 0, k = 0; q < static_cast<int>(f.size()); ++q) {
      while (begin_[k + 1] < q) ++k;
      const double d = q - apex_[k];
      f[q] = d * d + heights_[apex_[k]];
    }
  }

 private:
  std::vector<int> apex_;      ///< of each parabola of the envelope
  std::vector<double> begin_;  ///< where each becomes the lowest
  std::vector<double> heights_;
};

/// Returns how far a beam goes from `place` to the border of its cell, in one axis [cells].
double ToBorder(double place, double cell, double direction) {
  if (direction == 0.0) return kInfinity;
  return (direction > 0.0 ? cell + 1.0 - place : cell - place) / direction;
}

}  // namespace

DistanceField::DistanceField(const plan::GridShape& shape, const std::vector<std::uint8_t>& occupied) : shape_(shape) {
  plan::CheckShape(shape, occupied.size());
  std::vector<double> squared(occupied.size());
  for (std::size_t i = 0; i < occupied.size(); ++i) squared[i] = occupied[i] != 0 ? 0.0 : kInfinity;
  const auto rows = static_cast<std::size_t>(shape.rows), cols = static_cast<std::size_t>(shape.cols);
  Envelope envelope(std::max(rows, cols));
  std::vector<double> line(rows);
  for (std::size_t col = 0; col < cols; ++col) {
    for (std::size_t row = 0; row < rows; ++row) line[row] = squared[row * cols + col];
    envelope.Transform(&line);
    for (std::size_t row = 0; row < rows; ++row) squared[row * cols + col] = line[row];
  }
  line.resize(cols);
  cells_.resize(squared.size());
  for (std::size_t row = 0; row < rows; ++row) {
    std::copy_n(squared.begin() + static_cast<std::ptrdiff_t>(row * cols), cols, line.begin());
    envelope.Transform(&line);
    for (std::size_t col = 0; col < cols; ++col) cells_[row * cols + col] = static_cast<float>(std::sqrt(line[col]));
  }
}

std::vector<float> DistanceField::distances_m() const {
  std::vector<float> distances_m(cells_.size());
  std::transform(cells_.begin(), cells_.end(), distances_m.begin(),
                 [this](float cells) { return static_cast<float>(cells * shape_.resolution_m); });
  return distances_m;
}

double DistanceField::Trace(const base::Point& origin, const base::Point& direction, double range_max_m) const {
  const double x0 = (origin.x - shape_.origin.x) / shape_.resolution_m;
  const double y0 = (origin.y - shape_.origin.y) / shape_.resolution_m;
  const double most = range_max_m / shape_.resolution_m;
  double length = 0.0;  // in cells, as all here
  while (length <= most) {
    const double x = x0 + length * direction.x, y = y0 + length * direction.y;
    const double col = std::floor(x), row = std::floor(y);
    if (!(col >= 0.0 && col < shape_.cols && row >= 0.0 && row < shape_.rows)) return kInfinity;
    const float free = cells_[static_cast<std::size_t>(row) * shape_.cols + static_cast<std::size_t>(col)];
    if (free == 0.0F) return length * shape_.resolution_m;
    const double safe = free - kTwoHalfDiagonals;
    if (safe > 1.0) {
      length += safe;
    } else {
      length += std::max(0.0, std::min(ToBorder(x, col, direction.x), ToBorder(y, row, direction.y))) + kIntoNext;
    }
  }
  return kInfinity;
}

}  // namespace robotteamsim::maps

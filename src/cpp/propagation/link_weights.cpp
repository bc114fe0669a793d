#include "robotteamsim/propagation/link_weights.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace robotteamsim {
namespace {

/// Products of coordinates up to here, and their sums, are whole numbers below 2^53.
constexpr std::int64_t kExactCoordinateMm = 1 << 22;

/// Fewer targets than this are counted one by one.
constexpr std::size_t kFewTargets = 8;

/// As many bins of directions as targets, within these limits.
constexpr int kMinBins = 512;
constexpr int kMaxBins = 8192;

bool IsExactInDoubles(PointMm point) { return std::max(std::abs(point.x), std::abs(point.y)) <= kExactCoordinateMm; }

bool IsOnFace(const Face& face, PointMm point) {
  const auto is_between = [](std::int64_t a, std::int64_t b, std::int64_t value) {
    return std::min(a, b) <= value && value <= std::max(a, b);
  };
  return is_between(face.start.x, face.end.x, point.x) && is_between(face.start.y, face.end.y, point.y);
}

}  // namespace

LinkWeights::LinkWeights(const FaceSet& faces, std::vector<PointMm> points, Simd simd)
    : face_set_(faces), points_(std::move(points)), kernels_(LinkKernelsFor(simd)) {
  for (const PointMm& point : points_) {
    exact_in_doubles_ = exact_in_doubles_ && IsExactInDoubles(point);
    point_x_.push_back(static_cast<double>(point.x));
    point_y_.push_back(static_cast<double>(point.y));
  }
  if (points_.size() <= kFewTargets) return;
  for (std::size_t i = 0; i < faces.Size(); ++i) {
    if (faces.Weights()[i] == 0) continue;
    AddFace(faces.At(i));
    number_in_set_.push_back(i);
  }
  const std::size_t num_faces = faces_.weight.size();
  for (auto* const seen : {&faces_.side, &faces_.normal_x, &faces_.normal_y, &faces_.beyond}) seen->resize(num_faces);
  for (auto* const ends : {&faces_.right, &faces_.left}) ends->resize(num_faces);
  faces_.seen.resize(num_faces + 1);
  const std::size_t num_corners = corners_.x.size();
  corners_.direction.resize(num_corners);
  for (auto* const runs : {&corners_.bin, &corners_.first_run, &corners_.end_run}) runs->resize(num_corners);
}

void LinkWeights::AddFace(const Face& face) {
  const auto& [start, end, weight, start_vertex, end_vertex] = face;
  exact_in_doubles_ = exact_in_doubles_ && IsExactInDoubles(start) && IsExactInDoubles(end);
  faces_.start.push_back(AddCorner(start));
  faces_.end.push_back(AddCorner(end));
  faces_.start_x.push_back(static_cast<double>(start.x));
  faces_.start_y.push_back(static_cast<double>(start.y));
  faces_.along_x.push_back(static_cast<double>(end.x - start.x));
  faces_.along_y.push_back(static_cast<double>(end.y - start.y));
  faces_.tie_is_left.push_back(IsLeftOf(face, start) ? 1.0 : 0.0);
  faces_.weight.push_back(static_cast<double>(weight));
}

std::int32_t LinkWeights::AddCorner(PointMm corner) {
  const auto x = static_cast<double>(corner.x);
  const auto y = static_cast<double>(corner.y);
  // Outlines are chains: mostly a face starts where the last one ended.
  if (corners_.x.empty() || corners_.x.back() != x || corners_.y.back() != y) {
    corners_.x.push_back(x);
    corners_.y.push_back(y);
  }
  return static_cast<std::int32_t>(corners_.x.size()) - 1;
}

const std::vector<double>& LinkWeights::After(std::size_t source) {
  const std::size_t count = points_.size() - source - 1;
  weights_.resize(count);
  if (!exact_in_doubles_ || count < kFewTargets) {
    CountOneByOne(source);
    return weights_;
  }
  int num_bins = kMinBins;
  while (num_bins < kMaxBins && num_bins < static_cast<int>(count)) num_bins *= 2;
  bin_start_.assign(num_bins + 1, 0);
  const LinkSource seen_from{point_x_[source], point_y_[source], num_bins, bin_start_.data()};
  SortTargets(seen_from, source + 1);
  kernels_.add_weights(seen_from, &corners_, &faces_, static_cast<int>(count), blocks_.data());
  for (std::size_t k = 0; k < count; ++k) {
    weights_[order_[k]] = blocks_[k / TargetBlock::kLanes].weight[k % TargetBlock::kLanes];
  }
  AddFacesAt(source);
  return weights_;
}

void LinkWeights::CountOneByOne(std::size_t source) {
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    weights_[i] = static_cast<double>(face_set_.WeightBetween(points_[source], points_[source + 1 + i]));
  }
}

void LinkWeights::SortTargets(const LinkSource& source, std::size_t first) {
  const auto count = static_cast<std::int32_t>(weights_.size());
  directions_.resize(count);
  bins_.resize(count);
  order_.resize(count);
  kernels_.find_directions(source, &point_x_[first], &point_y_[first], count, directions_.data(), bins_.data());
  // Places in bin b are handed out from bin_start_[b + 1], which so becomes the end of the bin.
  for (const std::int32_t bin : bins_) ++bin_start_[bin + 1];
  std::int32_t start = 0;
  for (int bin = 1; bin <= source.num_bins; ++bin) start += std::exchange(bin_start_[bin], start);
  for (std::int32_t i = 0; i < count; ++i) order_[bin_start_[bins_[i] + 1]++] = i;
  blocks_.resize(count / TargetBlock::kLanes + 1);
  kernels_.fill_blocks(source, &point_x_[first], &point_y_[first], directions_.data(), order_.data(), count,
                       blocks_.data());
}

void LinkWeights::AddFacesAt(std::size_t source) {
  for (std::size_t i = 0; i < faces_.side.size(); ++i) {
    // From elsewhere on its line, a face is seen edge on: a ray has both ends on the same side.
    if (faces_.side[i] != 0.0 || !IsOnFace(face_set_.At(number_in_set_[i]), points_[source])) continue;
    const Face face = face_set_.At(number_in_set_[i]);
    const FaceSet alone({{face.start.x, face.start.y, face.end.x, face.end.y}}, {face.weight});
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      weights_[k] += static_cast<double>(alone.WeightBetween(points_[source], points_[source + 1 + k]));
    }
  }
}

}  // namespace robotteamsim

#include "robotteamsim/propagation/links/link_weights.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <utility>

namespace robotteamsim::propagation {
namespace {

/// Products of coordinates up to this limit, and their sums, are whole numbers below 2^53.
constexpr std::int64_t kExactCoordinateMm = 1 << 22;

/// As many bins of directions as targets, within these limits.
constexpr int kMinBins = 128;
constexpr int kMaxBins = 8192;

bool IsExactInDoubles(PointMm point) { return std::max(std::abs(point.x), std::abs(point.y)) <= kExactCoordinateMm; }

/// Returns twice the signed area of the triangle a, b, c.
std::int64_t TurnToLeft(PointMm a, PointMm b, PointMm c) {
  return (b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x);
}

/// Returns the four faces from `first` on if they form a convex ring with its inside to the left; else nothing.
std::optional<std::array<Face, 4>> RingAt(const FaceSet& faces, std::size_t first) {
  if (first + 4 > faces.Size()) return std::nullopt;
  std::array<Face, 4> ring = {faces.At(first), faces.At(first + 1), faces.At(first + 2), faces.At(first + 3)};
  int lefts = 0, rights = 0;
  for (int j = 0; j < 4; ++j) {
    const Face& next = ring[(j + 1) % 4];
    if (ring[j].end_vertex != next.start_vertex || ring[j].weight != next.weight) return std::nullopt;
    const std::int64_t turn = TurnToLeft(ring[j].start, ring[j].end, next.end);
    lefts += turn > 0 ? 1 : 0;
    rights += turn < 0 ? 1 : 0;
  }
  if (lefts < 4 && rights < 4) return std::nullopt;
  if (rights == 4) {
    std::reverse(ring.begin(), ring.end());
    for (Face& face : ring) std::swap(face.start, face.end);
  }
  return ring;
}

bool IsAlongX(const Face& face) { return face.start.y == face.end.y; }
bool IsAlongY(const Face& face) { return face.start.x == face.end.x; }

}  // namespace

LinkWeights::LinkWeights(const FaceSet& faces, base::Simd simd) : face_set_(faces), kernels_(LinkKernelsFor(simd)) {
  for (const PointMm& corner : faces.Vertices()) exact_in_doubles_ = exact_in_doubles_ && IsExactInDoubles(corner);
  if (exact_in_doubles_) AddFaces();
}

void LinkWeights::AddFaces() {
  std::size_t i = 0;
  while (i < face_set_.Size()) {
    std::optional<std::array<Face, 4>> ring = RingAt(face_set_, i);
    if (face_set_.Weights()[i] > 0) AddScreenAt(i, ring);
    i += ring ? 4 : 1;
  }
  const std::size_t most = std::max({faces_.blocks.size(), rings_.blocks.size(), boxes_.blocks.size()});
  scratch_.resize(kLinkLanes * most + 1);
}

void LinkWeights::AddScreenAt(std::size_t first_face, std::optional<std::array<Face, 4>> ring) {
  if (!ring) return AddScreen<1>(first_face, {face_set_.At(first_face)}, false, &faces_);
  // The first face of a box is along y, so that its normal is along x.
  if (IsAlongX(ring->front())) std::rotate(ring->begin(), ring->begin() + 1, ring->end());
  const bool is_box = IsAlongY((*ring)[0]) && IsAlongX((*ring)[1]) && IsAlongY((*ring)[2]) && IsAlongX((*ring)[3]);
  AddScreen<4>(first_face, *ring, is_box, is_box ? &boxes_ : &rings_);
}

template <int kFaces>
void LinkWeights::AddScreen(std::size_t first_face, const std::array<Face, kFaces>& faces, bool is_box,
                            Screens<kFaces>* screens) {
  const std::size_t lane = screens->first_face.size() % kLinkLanes;
  if (lane == 0) screens->blocks.emplace_back(ScreenBlock<kFaces>{});
  screens->first_face.push_back(first_face);
  ScreenBlock<kFaces>& block = screens->blocks.back();
  block.weight[lane] = static_cast<double>(faces.front().weight);
  for (int j = 0; j < kFaces; ++j) {
    const Face& face = faces[j];
    const std::int64_t dx = face.end.x - face.start.x;
    const std::int64_t dy = face.end.y - face.start.y;
    const std::int64_t unit = is_box ? std::abs(dx + dy) : 1;
    block.x[j][lane] = static_cast<double>(face.start.x);
    block.y[j][lane] = static_cast<double>(face.start.y);
    const std::int64_t normal_x = -dy / unit, normal_y = dx / unit;  // without remainder
    block.normal_x[j][lane] = static_cast<double>(normal_x);
    block.normal_y[j][lane] = static_cast<double>(normal_y);
    block.least_left[j][lane] = IsLeftOf(face, face.start) ? 0.0 : 1.0;
    const int next = (j + 1) % ScreenBlock<kFaces>::kCorners;
    block.x[next][lane] = static_cast<double>(face.end.x);
    block.y[next][lane] = static_cast<double>(face.end.y);
  }
}

LinkTargets LinkWeights::From(PointMm source, const PointMm* targets, std::size_t count) {
  order_.resize(count);
  places_.resize(count);
  blocks_.resize(count / kLinkLanes + 1);
  if (!exact_in_doubles_ || !IsExactInDoubles(source) || !std::all_of(targets, targets + count, IsExactInDoubles)) {
    CountOneByOne(source, targets);
  } else {
    SortTargets(source, targets);
    const auto num_faces = static_cast<int>(faces_.blocks.size());
    const auto num_boxes = static_cast<int>(boxes_.blocks.size());
    const auto num_rings = static_cast<int>(rings_.blocks.size());
    if (kernels_.add_faces(seen_from_, faces_.blocks.data(), num_faces, scratch_.data(), blocks_.data())) {
      AddScreensAt(source, targets, faces_);
    }
    if (kernels_.add_rings(seen_from_, rings_.blocks.data(), num_rings, scratch_.data(), blocks_.data())) {
      AddScreensAt(source, targets, rings_);
    }
    if (kernels_.add_boxes(seen_from_, boxes_.blocks.data(), num_boxes, scratch_.data(), blocks_.data())) {
      AddScreensAt(source, targets, boxes_);
    }
  }
  return {static_cast<int>(count), blocks_.data(), places_.data()};
}

void LinkWeights::CountOneByOne(PointMm source, const PointMm* targets) {
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const PointMm to = targets[k];
    TargetBlock& block = blocks_[k / kLinkLanes];
    const std::size_t lane = k % kLinkLanes;
    places_[k] = static_cast<std::int32_t>(k);
    block.x[lane] = static_cast<double>(to.x - source.x);
    block.y[lane] = static_cast<double>(to.y - source.y);
    block.weight[lane] = static_cast<double>(face_set_.WeightBetween(source, to));
  }
}

void LinkWeights::SortTargets(PointMm source, const PointMm* targets) {
  const auto count = static_cast<std::int32_t>(places_.size());
  target_x_.resize(count);
  target_y_.resize(count);
  for (std::int32_t i = 0; i < count; ++i) {
    target_x_[i] = static_cast<double>(targets[i].x);
    target_y_[i] = static_cast<double>(targets[i].y);
  }
  int num_bins = kMinBins;
  while (num_bins < kMaxBins && 4 * num_bins < count) num_bins *= 2;
  bin_start_.assign(num_bins + 1, 0);
  seen_from_ = {static_cast<double>(source.x), static_cast<double>(source.y), num_bins, bin_start_.data(), count};
  const double *const x = target_x_.data(), *const y = target_y_.data();
  directions_.resize(count);
  bins_.resize(count);
  kernels_.find_directions(seen_from_, x, y, directions_.data(), bins_.data());
  // Places in bin b are assigned from bin_start_[b + 1], which thus becomes the end of the bin.
  for (const std::int32_t bin : bins_) ++bin_start_[bin + 1];
  std::int32_t start = 0;
  for (int bin = 1; bin <= num_bins; ++bin) start += std::exchange(bin_start_[bin], start);
  for (std::int32_t i = 0; i < count; ++i) {
    const std::int32_t place = bin_start_[bins_[i] + 1]++;
    places_[i] = place;
    order_[place] = i;
  }
  kernels_.fill_blocks(seen_from_, x, y, directions_.data(), order_.data(), blocks_.data());
}

template <int kFaces>
void LinkWeights::AddScreensAt(PointMm source, const PointMm* targets, const Screens<kFaces>& screens) {
  for (std::size_t s = 0; s < screens.first_face.size(); ++s) {
    if (screens.blocks[s / kLinkLanes].left_out[s % kLinkLanes] == 0.0) continue;
    for (int j = 0; j < kFaces; ++j) {
      const Face face = face_set_.At(screens.first_face[s] + j);
      const FaceSet alone({{face.start.x, face.start.y, face.end.x, face.end.y}}, {face.weight});
      for (std::size_t i = 0; i < places_.size(); ++i) {
        const auto weight = alone.WeightBetween(source, targets[i]);
        blocks_[places_[i] / kLinkLanes].weight[places_[i] % kLinkLanes] += static_cast<double>(weight);
      }
    }
  }
}

}  // namespace robotteamsim::propagation

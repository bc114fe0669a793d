#include "robotteamsim/propagation/links/link_weights.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>
#include <vector>

#include "../scenes.hpp"

namespace robotteamsim::propagation {
namespace {

std::vector<PointMm> Points(std::mt19937* generator, int count, std::int64_t width, std::int64_t height,
                            PointMm from = {0, 0}) {
  std::vector<PointMm> points;
  for (int i = 0; i < count; ++i) {
    const std::int64_t x = from.x + scenes::Draw(generator, 0, width);
    points.push_back({x, from.y + scenes::Draw(generator, 0, height)});
  }
  return points;
}

/// Compares every link with FaceSet::WeightBetween, both ways, with each instruction set of this machine.
void ExpectExact(const FaceSet& faces, const std::vector<PointMm>& points) {
  for (const base::Simd simd : {base::Simd::kPortable, base::Simd::kAvx2, base::Simd::kAvx512}) {
    if (!base::IsSupported(simd)) continue;
    LinkWeights links(faces, simd);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const LinkTargets targets = links.From(points[i], points.data() + i + 1, points.size() - i - 1);
      ASSERT_EQ(targets.count, points.size() - i - 1);
      std::vector<bool> is_there(targets.count, false);
      for (int after = 0; after < targets.count; ++after) {
        const PointMm a = points[i];
        const PointMm b = points.at(i + 1 + after);
        const int k = targets.places[after];
        const TargetBlock& block = targets.blocks[k / kLinkLanes];
        const int lane = k % kLinkLanes;
        is_there.at(k) = true;
        ASSERT_EQ(block.x[lane], static_cast<double>(b.x - a.x));
        ASSERT_EQ(block.y[lane], static_cast<double>(b.y - a.y));
        ASSERT_EQ(block.weight[lane], static_cast<double>(faces.WeightBetween(a, b)))
            << "(" << a.x << ", " << a.y << ") to (" << b.x << ", " << b.y << ")";
        ASSERT_EQ(block.weight[lane], static_cast<double>(faces.WeightBetween(b, a)));
      }
      EXPECT_EQ(std::count(is_there.begin(), is_there.end(), false), 0);
    }
  }
}

TEST(LinkWeights, AreThoseOfEachLinkOnRandomFloors) {
  std::mt19937 generator(11);
  for (const int n : {0, 1, 2, 8, 9, 10, 16, 17, 64, 100, 300}) {
    for (const int oblique_percent : {0, 30, 100}) {
      ExpectExact(scenes::Walls(&generator, 40, oblique_percent), Points(&generator, n, 60'000, 40'000));
    }
  }
}

TEST(LinkWeights, AreThoseOfEachLinkOnALattice) {
  // Nearly every link runs through a corner or along a face; robots stand on faces, on corners, and on each other.
  std::mt19937 generator(12);
  for (int floor = 0; floor < 150; ++floor) {
    const std::int64_t size = 3 + floor % 12;
    ExpectExact(scenes::Lattice(&generator, 1 + floor % 40, size, 7), Points(&generator, 60, size, size, {-1, -1}));
  }
}

TEST(LinkWeights, AreThoseOfEachLinkAmongRingsOfFourOnALattice) {
  std::mt19937 generator(19);
  for (int floor = 0; floor < 300; ++floor) {
    const std::int64_t size = 2 + floor % 12;
    FaceSet faces = scenes::LatticeQuads(&generator, 1 + floor % 40, size, 7);
    const std::vector<PointMm> points = Points(&generator, 60, size + 1, size + 1, {-1, -1});
    ExpectExact(faces, points);
    for (std::size_t face = floor % 5; face < faces.Size(); face += 5) faces.SetActive(face, false);
    ExpectExact(faces, points);
  }
}

TEST(LinkWeights, AreThoseOfEachLinkThroughARectangleWhicheverWayAround) {
  std::vector<PointMm> points;
  for (std::int64_t x = -2; x <= 6; ++x) {
    for (std::int64_t y = -2; y <= 5; ++y) points.push_back({x, y});
  }
  std::vector<PointMm> corners = {{0, 0}, {4, 0}, {4, 3}, {0, 3}};
  for (int turn = 0; turn < 2; ++turn) {
    for (int first = 0; first < 4; ++first) {
      scenes::Outline outline;
      outline.AddRing(corners, 5);
      ExpectExact(FaceSet(outline.ends, outline.weights), points);
      std::rotate(corners.begin(), corners.begin() + 1, corners.end());
    }
    std::reverse(corners.begin(), corners.end());
  }
}

TEST(LinkWeights, AreThoseOfEachLinkFromAndToCornersAndFacesOfAFloor) {
  std::mt19937 generator(13);
  const FaceSet faces = scenes::Walls(&generator, 60, 30);
  std::vector<PointMm> points = Points(&generator, 40, 60'000, 40'000);
  for (std::size_t i = 0; i < faces.Vertices().size(); i += 3) {
    const PointMm corner = faces.Vertices()[i];
    points.push_back(corner);
    points.push_back({corner.x + 1, corner.y});
    points.push_back({corner.x, points.front().y});  // straight above or below a corner
  }
  points.insert(points.end(), 5, points.front());
  ExpectExact(faces, points);
}

TEST(LinkWeights, AreThoseOfEachLinkAmongTwentyThousandFaces) {
  std::mt19937 generator(14);
  const FaceSet faces = scenes::Walls(&generator, 5000, 20, 600);
  ASSERT_GT(faces.Size(), 19'000u);
  ExpectExact(faces, Points(&generator, 40, 60'000, 40'000));
}

TEST(LinkWeights, AreThoseOfEachLinkWhereDirectionsHardlyDiffer) {
  // Robots and walls in opposite corners of the largest square that is exact in doubles.
  constexpr std::int64_t kFar = 1 << 22;
  std::mt19937 generator(15);
  scenes::Outline outline;
  for (int i = 0; i < 40; ++i) {
    const std::vector<PointMm> ends = Points(&generator, 2, 4, 4, {kFar - 4, kFar - 4});
    outline.AddRing({ends[0], ends[1]}, 1 + i);
  }
  std::vector<PointMm> points = Points(&generator, 40, 4, 4, {-kFar, -kFar});
  for (const PointMm& point : Points(&generator, 40, 6, 6, {kFar - 6, kFar - 6})) points.push_back(point);
  ExpectExact(FaceSet(outline.ends, outline.weights), points);
}

TEST(LinkWeights, AreExactWhereCoordinatesAreTooLargeForDoubles) {
  std::mt19937 generator(16);
  const std::int64_t far = kMaxCoordinateMm;
  scenes::Outline outline;
  for (int i = 0; i < 20; ++i) outline.AddRing(Points(&generator, 3, 50, 50, {far - 50, far - 50}), 3);
  std::vector<PointMm> points = Points(&generator, 30, 50, 50, {far - 50, far - 50});
  points.push_back({-far, -far});
  ExpectExact(FaceSet(outline.ends, outline.weights), points);
}

TEST(LinkWeights, FollowDoors) {
  std::mt19937 generator(17);
  FaceSet faces = scenes::Walls(&generator, 40, 20);
  const std::vector<PointMm> points = Points(&generator, 60, 60'000, 40'000);
  for (std::size_t face = 0; face < faces.Size(); face += 2) faces.SetActive(face, false);
  ExpectExact(faces, points);
  for (std::size_t face = 0; face < faces.Size(); face += 4) faces.SetActive(face, true);
  ExpectExact(faces, points);
}

TEST(LinkWeights, AreZeroWithoutFaces) {
  std::mt19937 generator(18);
  ExpectExact(FaceSet({}, {}), Points(&generator, 30, 1000, 1000));
}

}  // namespace
}  // namespace robotteamsim::propagation

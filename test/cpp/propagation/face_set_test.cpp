#include "robotteamsim/propagation/face_set.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "scenes.hpp"

namespace robotteamsim::propagation {
namespace {

using Ends = std::vector<std::array<std::int64_t, 4>>;

/// A wall from (0, -1000) to (200, 1000) mm: 1 per face.
FaceSet SquareWall() {
  return FaceSet({{0, -1000, 200, -1000}, {200, -1000, 200, 1000}, {200, 1000, 0, 1000}, {0, 1000, 0, -1000}},
                 {1, 1, 1, 1});
}

/// Closed triangles with corners on a coarse lattice, so that many rays run through corners and along faces.
FaceSet LatticeTriangles(std::mt19937* generator) {
  std::uniform_int_distribution<std::int64_t> coordinate(0, 12);
  Ends ends;
  std::vector<std::int32_t> weights;
  while (ends.size() < 60) {
    const auto draw = [&] { return PointMm{coordinate(*generator), coordinate(*generator)}; };
    const PointMm a = draw(), b = draw(), c = draw();
    if ((b.x - a.x) * (c.y - a.y) == (b.y - a.y) * (c.x - a.x)) continue;  // no area
    ends.insert(ends.end(), {{a.x, a.y, b.x, b.y}, {b.x, b.y, c.x, c.y}, {c.x, c.y, a.x, a.y}});
    weights.insert(weights.end(), 3, static_cast<std::int32_t>(1 + ends.size() % 7));
  }
  return FaceSet(ends, weights);
}

TEST(RoundToMm, TakesTheNearestHalfForAHalfWhateverItsBits) {
  // In doubles, 8.0255 * 1000 is below and 8.0265 * 1000 exactly a half.
  for (int mm = 0; mm < 20000; ++mm) {
    const double half = (mm + 0.5) / 1000.0;
    const PointMm point = RoundToMm({half, -half}, "point");
    ASSERT_EQ(point.x, mm + 1);
    ASSERT_EQ(point.y, -mm - 1);
    ASSERT_EQ(RoundToMm({half - 1e-8, 0.0}, "point").x, mm);
  }
}

TEST(RoundToMm, RoundsHalvesAwayFromZero) {
  const PointMm point = RoundToMm({0.0005, -1.2345}, "point");
  EXPECT_EQ(point.x, 1);
  EXPECT_EQ(point.y, -1235);
}

TEST(RoundToMm, RefusesWhatIsNotFiniteAndNamesThePlace) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e9}) {
    try {
      RoundToMm({0.0, bad}, "position of robot 2");
      FAIL() << "accepted " << bad;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("position of robot 2 must be finite"), std::string::npos);
    }
  }
}

TEST(FaceSet, ARayThroughAWallPaysForBothFaces) {
  EXPECT_EQ(SquareWall().WeightBetween({-1000, 0}, {1000, 0}), 2);
  EXPECT_EQ(SquareWall().WeightBetween({-1000, -300}, {1000, 400}), 2);
  EXPECT_EQ(SquareWall().WeightBetween({-1000, 0}, {-10, 900}), 0);
}

TEST(FaceSet, AnEndInsideAWallPaysForOneFace) {
  EXPECT_EQ(SquareWall().WeightBetween({100, 0}, {1000, 0}), 1);
  EXPECT_EQ(SquareWall().WeightBetween({-1000, 0}, {100, 0}), 1);
  EXPECT_EQ(SquareWall().WeightBetween({100, 0}, {120, 500}), 0);
  EXPECT_EQ(SquareWall().WeightBetween({100, 0}, {100, 0}), 0);
}

TEST(FaceSet, ARayAlongAFaceIsInsideOrOutside) {
  // The walls move by (+eps, +eps^2): the ray along the left face then runs outside, that along the right one inside.
  EXPECT_EQ(SquareWall().WeightBetween({0, -3000}, {0, 3000}), 0);
  EXPECT_EQ(SquareWall().WeightBetween({200, -3000}, {200, 3000}), 2);
  // By eps^2 upward: below the bottom face is outside, and the ray along the top face runs inside.
  EXPECT_EQ(SquareWall().WeightBetween({-3000, -1000}, {3000, -1000}), 0);
  EXPECT_EQ(SquareWall().WeightBetween({-3000, 1000}, {3000, 1000}), 2);
}

TEST(FaceSet, ARayThroughACornerCountsWholeFaces) {
  EXPECT_EQ(SquareWall().WeightBetween({-1000, 0}, {1000, 2000}) % 2, 0);     // through (0, 1000)
  EXPECT_EQ(SquareWall().WeightBetween({-800, 2000}, {1200, 0}) % 2, 0);      // through (200, 1000)
  EXPECT_EQ(SquareWall().WeightBetween({-900, -6000}, {1100, 6000}) % 2, 0);  // corner to corner
}

TEST(FaceSet, WeightsAreTheSameBothWaysOnALattice) {
  std::mt19937 generator(1);
  const FaceSet faces = LatticeTriangles(&generator);
  for (std::int64_t a = 0; a < 169; ++a) {
    for (std::int64_t b = 0; b < a; ++b) {
      const PointMm from{a % 13, a / 13};
      const PointMm to{b % 13, b / 13};
      ASSERT_EQ(faces.WeightBetween(from, to), faces.WeightBetween(to, from)) << a << " " << b;
    }
  }
}

TEST(FaceSet, WeightNeverFallsAlongARay) {
  std::mt19937 generator(2);
  std::uniform_int_distribution<std::int64_t> step(-3, 3);
  const FaceSet faces = LatticeTriangles(&generator);
  for (int ray = 0; ray < 500; ++ray) {
    const PointMm from{6 + step(generator), 6 + step(generator)};
    const PointMm direction{step(generator), step(generator)};
    std::int64_t before = 0;
    for (std::int64_t k = 0; k < 10; ++k) {
      const std::int64_t now = faces.WeightBetween(from, {from.x + k * direction.x, from.y + k * direction.y});
      ASSERT_GE(now, before) << "ray " << ray << ", step " << k;
      before = now;
    }
  }
}

TEST(FaceSet, WeightNeverFallsAlongARayThroughABuilding) {
  std::mt19937 generator(3);
  for (int ray = 0; ray < 2000; ++ray) {
    const FaceSet faces = scenes::Walls(&generator, 10, 50);
    const PointMm from{scenes::Draw(&generator, 0, 60'000), scenes::Draw(&generator, 0, 40'000)};
    const PointMm step{scenes::Draw(&generator, -900, 900), scenes::Draw(&generator, -900, 900)};
    std::int64_t before = 0;
    for (std::int64_t k = 1; k <= 40; ++k) {
      const std::int64_t now = faces.WeightBetween(from, {from.x + k * step.x, from.y + k * step.y});
      ASSERT_GE(now, before) << "ray " << ray << ", step " << k;
      before = now;
    }
  }
}

TEST(FaceSet, StaysExactAtTheLimitOfCoordinates) {
  const std::int64_t far = kMaxCoordinateMm;
  const FaceSet faces({{-far, -far, far, far}}, {1});
  EXPECT_EQ(faces.WeightBetween({far - 1, far}, {far, far - 1}), 1);
  EXPECT_EQ(faces.WeightBetween({far - 2, far}, {far - 1, far}), 0);
}

TEST(FaceSet, AnInactiveFaceWeighsNothing) {
  FaceSet faces = SquareWall();
  faces.SetActive(1, false);
  EXPECT_EQ(faces.WeightBetween({-1000, 0}, {1000, 0}), 1);
  faces.SetActive(1, true);
  EXPECT_EQ(faces.WeightBetween({-1000, 0}, {1000, 0}), 2);
  EXPECT_THROW(faces.SetActive(4, true), std::invalid_argument);
}

TEST(FaceSet, NumbersEachVertexOnce) {
  const FaceSet faces = SquareWall();
  EXPECT_EQ(faces.Vertices().size(), 4u);
  for (std::size_t i = 0; i < faces.Size(); ++i) {
    EXPECT_EQ(faces.At(i).end_vertex, faces.At((i + 1) % 4).start_vertex);
    EXPECT_EQ(faces.Vertices()[faces.At(i).start_vertex].x, faces.At(i).start.x);
    EXPECT_EQ(faces.Vertices()[faces.At(i).start_vertex].y, faces.At(i).start.y);
  }
}

TEST(FaceSet, TotalWeightCountsInactiveFacesToo) {
  FaceSet faces = SquareWall();
  faces.SetActive(1, false);
  EXPECT_EQ(faces.TotalWeight(), 4);
  EXPECT_EQ(faces.Weights(), (std::vector<std::int32_t>{1, 0, 1, 1}));
  EXPECT_EQ(faces.At(1).weight, 0);
}

TEST(IsLeftOf, DecidesPointsOnTheFaceAsIfItHadMovedRightAndUp) {
  EXPECT_TRUE(IsLeftOf({{0, 0}, {0, 10}}, {0, 5}));   // upward: moved to the right of the point
  EXPECT_FALSE(IsLeftOf({{0, 10}, {0, 0}}, {0, 5}));  // downward
  EXPECT_FALSE(IsLeftOf({{0, 0}, {10, 0}}, {5, 0}));  // to the right: moved above the point
  EXPECT_TRUE(IsLeftOf({{10, 0}, {0, 0}}, {5, 0}));
  EXPECT_TRUE(IsLeftOf({{0, 0}, {10, 10}}, {5, 6}));
  EXPECT_FALSE(IsLeftOf({{0, 0}, {10, 10}}, {5, 4}));
}

TEST(FaceSet, RefusesFacesThatAreNone) {
  EXPECT_THROW(FaceSet({{0, 0, 1, 0}}, {}), std::invalid_argument);
  EXPECT_THROW(FaceSet({{3, 4, 3, 4}}, {1}), std::invalid_argument);
  EXPECT_THROW(FaceSet({{0, 0, 1, 0}}, {-1}), std::invalid_argument);
  EXPECT_THROW(FaceSet({{0, 0, kMaxCoordinateMm + 1, 0}}, {1}), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::propagation

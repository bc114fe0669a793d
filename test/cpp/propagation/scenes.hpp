// Floors for tests and benchmarks.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "robotteamsim/propagation/face_set.hpp"

namespace robotteamsim::propagation::scenes {

using Ends = std::vector<std::array<std::int64_t, 4>>;

/// Draws a whole number from low to high; the same on every machine, unlike std::uniform_int_distribution.
inline std::int64_t Draw(std::mt19937* generator, std::int64_t low, std::int64_t high) {
  return low + static_cast<std::int64_t>((*generator)() % static_cast<std::uint32_t>(high - low + 1));
}

/// Segments and their weights, in the making.
struct Outline {
  Ends ends;
  std::vector<std::int32_t> weights;

  void AddRing(const std::vector<PointMm>& corners, std::int32_t weight) {
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const PointMm& a = corners[i];
      const PointMm& b = corners[(i + 1) % corners.size()];
      if (a.x == b.x && a.y == b.y) continue;
      ends.push_back({a.x, a.y, b.x, b.y});
      weights.push_back(weight);
    }
  }
};

/// Closed triangles with corners on whole numbers from 0 to size - 1: on a small lattice, many rays run through corners
/// and along faces. Every other is one open segment instead.
inline FaceSet Lattice(std::mt19937* generator, int count, std::int64_t size, std::int32_t max_weight) {
  Outline outline;
  for (int i = 0; i < count; ++i) {
    const auto corner = [&] {
      const std::int64_t x = Draw(generator, 0, size - 1);
      return PointMm{x, Draw(generator, 0, size - 1)};
    };
    std::vector<PointMm> corners = {corner(), corner(), corner()};
    const auto weight = static_cast<std::int32_t>(Draw(generator, 1, max_weight));
    outline.AddRing(corners, weight);
    if (i % 2 == 1 && outline.ends.size() > 2) {
      outline.ends.resize(outline.ends.size() - 2);
      outline.weights.resize(outline.ends.size());
    }
  }
  return FaceSet(outline.ends, outline.weights);
}

/// Rings of four corners on whole numbers from 0 to size - 1: convex ones, others, and some that cross themselves.
inline FaceSet LatticeQuads(std::mt19937* generator, int count, std::int64_t size, std::int32_t max_weight) {
  Outline outline;
  for (int i = 0; i < count; ++i) {
    std::vector<PointMm> corners;
    for (int j = 0; j < 4; ++j) {
      const std::int64_t x = Draw(generator, 0, size - 1);
      corners.push_back({x, Draw(generator, 0, size - 1)});
    }
    outline.AddRing(corners, static_cast<std::int32_t>(Draw(generator, 1, max_weight)));
  }
  return FaceSet(outline.ends, outline.weights);
}

/// Walls of the four classes of Table 3 in 60 x 40 m, in units of 0.05 dB per face; a share of them oblique [percent].
inline FaceSet Walls(std::mt19937* generator, int count, int oblique_percent, std::int64_t max_length_mm = 6000) {
  constexpr std::int32_t kWeights[4] = {38, 39, 57, 124};
  Outline outline;
  for (int i = 0; i < count; ++i) {
    const auto wall_class = static_cast<int>(Draw(generator, 0, 3));
    const auto thickness = static_cast<double>(50 + 200 * wall_class + Draw(generator, 0, 150));
    const auto length = static_cast<double>(Draw(generator, max_length_mm / 12, max_length_mm));
    const std::int64_t x = Draw(generator, 0, 59'000);
    const std::int64_t y = Draw(generator, 0, 39'000);
    const bool is_oblique = Draw(generator, 0, 99) < oblique_percent;
    const double turns = static_cast<double>(Draw(generator, 0, 999)) / 1000.0;
    const double quarter = static_cast<double>(Draw(generator, 0, 1)) / 4.0;
    const double angle = 6.283185307179586 * (is_oblique ? turns : quarter);
    const auto corner = [&](double along, double across) {
      return PointMm{x + std::llround(along * std::cos(angle) - across * std::sin(angle)),
                     y + std::llround(along * std::sin(angle) + across * std::cos(angle))};
    };
    outline.AddRing({corner(0.0, 0.0), corner(length, 0.0), corner(length, thickness), corner(0.0, thickness)},
                    kWeights[wall_class]);
  }
  return FaceSet(outline.ends, outline.weights);
}

}  // namespace robotteamsim::propagation::scenes

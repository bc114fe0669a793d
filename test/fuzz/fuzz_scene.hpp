// A floor, a grid over it and transmitters, out of a fuzzer's bytes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "fuzz_bytes.hpp"
#include "robotteamsim/plan/grid.hpp"
#include "robotteamsim/propagation/face_set.hpp"

namespace robotteamsim::fuzz {

/// How far apart coordinates lie. On a small lattice many rays run through corners and along faces.
enum class Scale { kLattice, kRoom, kWorld, kEdge };

struct Scene {
  Scale scale = Scale::kLattice;
  std::vector<std::array<std::int64_t, 4>> ends;
  std::vector<std::int32_t> weights;
};

inline std::int64_t Coordinate(Bytes* bytes, Scale scale) {
  switch (scale) {
    case Scale::kLattice:
      return bytes->Draw(0, 12);
    case Scale::kRoom:
      return bytes->Draw(-2'000, 60'000);
    case Scale::kWorld:
      return bytes->Draw(-propagation::kMaxCoordinateMm, propagation::kMaxCoordinateMm);
    case Scale::kEdge:
      break;
  }
  // The last coordinates that are allowed, the first that are not, and 64 bits' own edge.
  constexpr std::array<std::int64_t, 8> kEdges = {propagation::kMaxCoordinateMm,
                                                  -propagation::kMaxCoordinateMm,
                                                  propagation::kMaxCoordinateMm + 1,
                                                  -propagation::kMaxCoordinateMm - 1,
                                                  INT64_MAX,
                                                  INT64_MIN,
                                                  0,
                                                  1};
  return kEdges[static_cast<std::size_t>(bytes->Draw(0, kEdges.size() - 1))];
}

/// Draws a place that the exact arithmetic takes.
inline propagation::PointMm Place(Bytes* bytes, Scale scale) {
  const Scale within = scale == Scale::kEdge ? Scale::kWorld : scale;
  const std::int64_t x = Coordinate(bytes, within);
  return {x, Coordinate(bytes, within)};
}

/// Draws closed rings and open segments; neighbours share their ends. Some weigh nothing, some are refused.
inline Scene DrawScene(Bytes* bytes) {
  Scene scene;
  scene.scale = static_cast<Scale>(bytes->Draw(0, 3));
  const std::int32_t max_weight = bytes->Draw(0, 15) == 0 ? INT32_MAX : 255;
  const auto rings = bytes->Draw(0, 12);
  for (std::int64_t i = 0; i < rings; ++i) {
    const auto corners = static_cast<int>(bytes->Draw(1, 6));
    const auto weight = static_cast<std::int32_t>(bytes->Draw(bytes->Draw(0, 63) == 0 ? -1 : 0, max_weight));
    const bool closed = bytes->Coin();
    const std::array<std::int64_t, 2> first = {Coordinate(bytes, scene.scale), Coordinate(bytes, scene.scale)};
    std::array<std::int64_t, 2> from = first;
    for (int k = 0; k < corners; ++k) {
      std::array<std::int64_t, 2> to = {Coordinate(bytes, scene.scale), Coordinate(bytes, scene.scale)};
      if (bytes->Coin()) to[static_cast<std::size_t>(bytes->Draw(0, 1))] = from[0];  // along an axis, or diagonal
      if (closed && k + 1 == corners) to = first;
      if (from == to && bytes->Draw(0, 15) != 0) continue;
      scene.ends.push_back({from[0], from[1], to[0], to[1]});
      scene.weights.push_back(weight);
      from = to;
    }
  }
  return scene;
}

/// Draws a grid of few cells that lies among the faces, or anywhere.
inline plan::GridShape DrawGrid(Bytes* bytes, Scale scale) {
  constexpr std::array<double, 8> kResolutions = {0.001, 0.002, 0.0015, 0.05, 0.25, 1.0 / 3.0, 1.0, 40'000.0};
  plan::GridShape grid;
  if (bytes->Draw(0, 31) == 0) {
    grid = {{bytes->AnyDouble(), bytes->AnyDouble()}, bytes->AnyDouble(), 0, 0};
  } else {
    const propagation::PointMm origin = Place(bytes, scale);
    const auto half_mm = static_cast<double>(bytes->Draw(0, 1)) / 2000.0;
    grid.origin = {static_cast<double>(origin.x) / 1000.0 - half_mm, static_cast<double>(origin.y) / 1000.0 - half_mm};
    grid.resolution_m = kResolutions[static_cast<std::size_t>(bytes->Draw(0, kResolutions.size() - 1))];
  }
  grid.rows = static_cast<int>(bytes->Draw(-1, 30));
  grid.cols = static_cast<int>(bytes->Draw(-1, 50));
  return grid;
}

}  // namespace robotteamsim::fuzz

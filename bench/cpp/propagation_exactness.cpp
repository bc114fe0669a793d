// Compares fast maps with one ray per cell, on as many cells as asked for; the two ways of links; and rays made longer.
// Nothing may differ. Usage: robotteamsim_exactness [millions of cells, 50 if not given]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "../../test/cpp/propagation/reference.hpp"
#include "../../test/cpp/propagation/scenes.hpp"
#include "robotteamsim/propagation/maps/field_maps.hpp"
#include "robotteamsim/propagation/radio.hpp"

namespace robotteamsim {
namespace {

using propagation::scenes::Draw;

const propagation::RadioModel kRadio{0.0, 47.4, 23.2, 0.1, 18.3, 0.46};

/// Floats are this fine up to here [dB].
constexpr double kFineBelowDb = 128.0;
/// Half of the lightest weight: what is nearer to the plain value has the same walls [dB].
constexpr double kSameWallsDb = 0.025;

struct Count {
  long long compared = 0;
  long long differing = 0;
  double worst_db = 0.0;  ///< of a value
};

/// Compares weights, and the values of a map, with one ray and one logarithm per cell.
void Compare(const propagation::FaceSet& faces, propagation::PointMm source, const plan::GridShape& grid,
             base::Simd simd, Count* count) {
  const propagation::Fading fading = propagation::RadioFading(kRadio);
  const propagation::CellCentersMm cells(grid);
  const std::vector<std::int32_t> weights = propagation::WeightsFrom(faces, source, grid);
  propagation::MapValues map(grid.rows, grid.cols);
  propagation::WriteHighest(faces, {{source, fading}}, grid, map, {1, simd});
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      const std::int64_t weight = propagation::reference::Weight(faces, source, cells, row, col);
      const double value_db = propagation::reference::ValueBehind(weight, source, fading, cells.At(row, col));
      const double error_db = std::abs(map(row, col) - value_db);
      ++count->compared;
      if (weights[row * grid.cols + col] != weight || error_db > kSameWallsDb) ++count->differing;
      if (std::abs(value_db) < kFineBelowDb) count->worst_db = std::max(count->worst_db, error_db);
    }
  }
}

/// Draws an instruction set of this machine.
base::Simd DrawSimd(std::mt19937* generator) {
  constexpr std::array<base::Simd, 3> kAll = {base::Simd::kPortable, base::Simd::kAvx2, base::Simd::kAvx512};
  const base::Simd drawn = kAll[Draw(generator, 0, 2)];
  return base::IsSupported(drawn) ? drawn : base::Simd::kPortable;
}

/// A map of one plan, then of the same with some faces switched off; another instruction set each time.
void CompareOne(propagation::FaceSet faces, propagation::PointMm source, const plan::GridShape& grid,
                std::mt19937* generator, Count* count) {
  const base::Simd simd = DrawSimd(generator);
  Compare(faces, source, grid, simd, count);
  for (int i = 0; i < 5; ++i) {
    faces.SetActive(Draw(generator, 0, static_cast<std::int64_t>(faces.Size()) - 1), false);
  }
  Compare(faces, source, grid, simd, count);
}

/// Lattice points: sources on vertices, rays through vertices and along faces, cells on the lattice or between.
void CompareLattice(std::mt19937* generator, Count* count) {
  const propagation::FaceSet faces =
      propagation::scenes::Lattice(generator, static_cast<int>(Draw(generator, 1, 40)), 30, 9);
  propagation::PointMm source{Draw(generator, -5, 35), Draw(generator, -5, 35)};
  if (Draw(generator, 0, 1) == 0) source = faces.Vertices().front();
  const double resolution_m = Draw(generator, 0, 3) == 0 ? 0.0017 : 0.001;
  CompareOne(faces, source, {{-0.004, -0.005}, resolution_m, 50, 120}, generator, count);
}

/// Buildings: oblique walls, sources in walls and outside, any resolution in whole millimetres and some that are not.
void CompareBuilding(std::mt19937* generator, Count* count) {
  const auto walls = static_cast<int>(Draw(generator, 1, 110));
  const propagation::FaceSet faces =
      propagation::scenes::Walls(generator, walls, static_cast<int>(Draw(generator, 0, 100)));
  propagation::PointMm source{Draw(generator, -10'000, 70'000), Draw(generator, -10'000, 50'000)};
  if (Draw(generator, 0, 3) == 0) {
    source = {faces.At(0).start.x + Draw(generator, -40, 40), faces.At(0).start.y + 20};
  }
  const double finer = Draw(generator, 0, 9) == 0 ? 0.001 / 3.0 : 0.0;
  const double resolution_m = static_cast<double>(Draw(generator, 20, 300)) / 1000.0 + finer;
  const plan::GridShape grid{{static_cast<double>(Draw(generator, -5000, 20'000)) / 1000.0, -1.0},
                             resolution_m,
                             static_cast<int>(Draw(generator, 1, 200)),
                             static_cast<int>(Draw(generator, 1, 300))};
  CompareOne(faces, source, grid, generator, count);
}

propagation::PointMm Anywhere(std::mt19937* generator) {
  return {Draw(generator, 0, 60'000), Draw(generator, 0, 40'000)};
}

/// Losses of both ways between two points, to the bit.
void CompareWays(const propagation::FaceSet& faces, propagation::PointMm a, propagation::PointMm b, Count* count) {
  ++count->compared;
  if (propagation::PathLossDb(faces, kRadio, a, b) != propagation::PathLossDb(faces, kRadio, b, a)) ++count->differing;
}

/// The walls of a ray that is made longer in equal steps; its ends lie exactly on one line.
void CompareAlong(const propagation::FaceSet& faces, propagation::PointMm from, propagation::PointMm step,
                  Count* count) {
  std::int64_t before = 0;
  for (int k = 1; k <= 40; ++k) {
    const std::int64_t weight = faces.WeightBetween(from, {from.x + k * step.x, from.y + k * step.y});
    ++count->compared;
    if (weight < before) ++count->differing;
    before = weight;
  }
}

void CompareMaps(long long wanted, std::mt19937* generator, Count* lattice, Count* building, Count* many) {
  const propagation::FaceSet twenty_thousand = propagation::scenes::Walls(generator, 5000, 50, 600);
  while (many->compared < wanted / 500) {
    CompareOne(twenty_thousand, Anywhere(generator), {{0.0, 0.0}, 1.0, 40, 60}, generator, many);
  }
  while (lattice->compared < wanted / 2) CompareLattice(generator, lattice);
  while (lattice->compared + building->compared + many->compared < wanted) CompareBuilding(generator, building);
}

void CompareRays(long long wanted, std::mt19937* generator, Count* ways, Count* lattice_ways, Count* along) {
  propagation::FaceSet walls({}, {});
  propagation::FaceSet triangles({}, {});
  const auto on_lattice = [&] { return propagation::PointMm{Draw(generator, -1, 9), Draw(generator, -1, 9)}; };
  for (long long i = 0; i < wanted; ++i) {
    if (i % 5000 == 0) walls = propagation::scenes::Walls(generator, 60, 50);
    if (i % 200 == 0) triangles = propagation::scenes::Lattice(generator, 12, 9, 9);
    const propagation::PointMm a = Anywhere(generator);
    CompareWays(walls, a, Anywhere(generator), ways);
    const propagation::PointMm corner = on_lattice();
    CompareWays(triangles, corner, on_lattice(), lattice_ways);
    if (i % 20 != 0) continue;
    CompareAlong(walls, a, {Draw(generator, -900, 900), Draw(generator, -900, 900)}, along);
    CompareAlong(triangles, corner, {Draw(generator, -2, 2), Draw(generator, -2, 2)}, along);
  }
}

/// The links of a team, found together, with the single losses; another instruction set each time.
void CompareTeam(const propagation::FaceSet& faces, const propagation::Positions& positions, std::mt19937* generator,
                 Count* count) {
  const propagation::CellValues rssi_dbm = propagation::RssiMatrixDbm(faces, kRadio, positions, DrawSimd(generator));
  for (Eigen::Index i = 0; i < positions.rows(); ++i) {
    const propagation::PointMm a = propagation::RoundToMm({positions(i, 0), positions(i, 1)}, "a");
    for (Eigen::Index j = i + 1; j < positions.rows(); ++j) {
      const propagation::PointMm b = propagation::RoundToMm({positions(j, 0), positions(j, 1)}, "b");
      const double expected_dbm = kRadio.tx_power_dbm - propagation::PathLossDb(faces, kRadio, a, b);
      ++count->compared;
      if (rssi_dbm(i, j) != expected_dbm || rssi_dbm(j, i) != expected_dbm) ++count->differing;
    }
  }
}

/// Teams in buildings, and on lattices of triangles or rings of four with robots on corners and faces.
void CompareTeams(long long wanted, std::mt19937* generator, Count* building, Count* lattice) {
  const auto team = [&](std::int64_t width, std::int64_t height) {
    propagation::Positions positions(Draw(generator, 9, 300), 2);
    for (Eigen::Index i = 0; i < positions.rows(); ++i) {
      positions(i, 0) = static_cast<double>(Draw(generator, -1, width)) / 1000.0;
      positions(i, 1) = static_cast<double>(Draw(generator, -1, height)) / 1000.0;
    }
    return positions;
  };
  while (building->compared < wanted) {
    const auto walls = static_cast<int>(Draw(generator, 1, 110));
    const propagation::FaceSet faces =
        propagation::scenes::Walls(generator, walls, static_cast<int>(Draw(generator, 0, 100)));
    CompareTeam(faces, team(60'000, 40'000), generator, building);
  }
  while (lattice->compared < wanted) {
    const std::int64_t size = Draw(generator, 2, 14);
    const auto count = static_cast<int>(Draw(generator, 1, 40));
    const bool is_of_four = Draw(generator, 0, 1) == 0;
    const propagation::FaceSet faces = is_of_four ? propagation::scenes::LatticeQuads(generator, count, size, 9)
                                                  : propagation::scenes::Lattice(generator, count, size, 9);
    CompareTeam(faces, team(size, size), generator, lattice);
  }
}

void Print(const char* what, const Count& count) {
  std::printf("%-42s %11lld compared, %lld differ\n", what, count.compared, count.differing);
}

int Main(int argc, char** argv) {
  const long long wanted = 1'000'000LL * (argc > 1 ? std::atoll(argv[1]) : 50);
  std::mt19937 generator(20);
  Count lattice, building, many, ways, lattice_ways, along, team, lattice_team;
  CompareMaps(wanted, &generator, &lattice, &building, &many);
  CompareRays(wanted / 50, &generator, &ways, &lattice_ways, &along);
  CompareTeams(wanted / 50, &generator, &team, &lattice_team);
  Print("cells, plans on a lattice", lattice);
  Print("cells, random buildings", building);
  Print("cells, 20,000 faces", many);
  Print("both ways of a link, random buildings", ways);
  Print("both ways of a link, on a lattice", lattice_ways);
  Print("links of teams, random buildings", team);
  Print("links of teams, on a lattice", lattice_team);
  Print("steps along a ray, walls that grow fewer", along);
  const double worst_db = std::max({lattice.worst_db, building.worst_db, many.worst_db});
  std::printf("largest error of a value above -128 dB: %.2g dB\n", worst_db);
  const long long differing = lattice.differing + building.differing + many.differing + ways.differing +
                              lattice_ways.differing + along.differing + team.differing + lattice_team.differing;
  return differing == 0 ? 0 : 1;
}

}  // namespace
}  // namespace robotteamsim

int main(int argc, char** argv) { return robotteamsim::Main(argc, argv); }

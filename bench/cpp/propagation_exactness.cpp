// Compares the weights of fast maps with one ray per cell, on as many cells as asked for; 0 may differ.
// Usage: robotteamsim_exactness [millions of cells, 50 if not given]
#include <cstdio>
#include <cstdlib>
#include <random>

#include "../../test/cpp/propagation/reference.hpp"
#include "../../test/cpp/propagation/scenes.hpp"
#include "robotteamsim/propagation/field_maps.hpp"

namespace robotteamsim {
namespace {

struct Count {
  long long cells = 0;
  long long differing = 0;
};

void Compare(const FaceSet& faces, const WeightMap& map, const GridShape& grid, Count* count) {
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      ++count->cells;
      if (map.At(row, col) != reference::Weight(faces, map.Source(), map.Cells(), row, col)) ++count->differing;
    }
  }
}

/// A map of one plan, then of the same with some faces switched off, kept up to date.
void CompareOne(FaceSet faces, PointMm source, const GridShape& grid, std::mt19937* generator, Count* count) {
  WeightMap map(faces, source, grid);
  Compare(faces, map, grid, count);
  for (int i = 0; i < 5; ++i) {
    faces.SetActive(scenes::Draw(generator, 0, static_cast<std::int64_t>(faces.Size()) - 1), false);
  }
  map.Update(faces);
  Compare(faces, map, grid, count);
}

/// Lattice points: sources on vertices, rays through vertices and along faces, cells on the lattice or between.
void CompareLattice(std::mt19937* generator, Count* count) {
  const FaceSet faces = scenes::Lattice(generator, static_cast<int>(scenes::Draw(generator, 1, 40)), 30, 9);
  PointMm source{scenes::Draw(generator, -5, 35), scenes::Draw(generator, -5, 35)};
  if (scenes::Draw(generator, 0, 1) == 0) source = faces.Vertices().front();
  const double resolution = scenes::Draw(generator, 0, 3) == 0 ? 0.0017 : 0.001;
  CompareOne(faces, source, {{-0.004, -0.005}, resolution, 50, 120}, generator, count);
}

/// Buildings: oblique walls, sources in walls and outside, any resolution in whole millimetres and some that are not.
void CompareBuilding(std::mt19937* generator, Count* count) {
  const auto walls = static_cast<int>(scenes::Draw(generator, 1, 110));
  const FaceSet faces = scenes::Walls(generator, walls, static_cast<int>(scenes::Draw(generator, 0, 100)));
  PointMm source{scenes::Draw(generator, -10'000, 70'000), scenes::Draw(generator, -10'000, 50'000)};
  if (scenes::Draw(generator, 0, 3) == 0) {
    source = {faces.At(0).start.x + scenes::Draw(generator, -40, 40), faces.At(0).start.y + 20};
  }
  const double finer = scenes::Draw(generator, 0, 9) == 0 ? 0.001 / 3.0 : 0.0;
  const double resolution = static_cast<double>(scenes::Draw(generator, 20, 300)) / 1000.0 + finer;
  const GridShape grid{{static_cast<double>(scenes::Draw(generator, -5000, 20'000)) / 1000.0, -1.0},
                       resolution,
                       static_cast<int>(scenes::Draw(generator, 1, 200)),
                       static_cast<int>(scenes::Draw(generator, 1, 300))};
  CompareOne(faces, source, grid, generator, count);
}

int Main(int argc, char** argv) {
  const long long wanted = 1'000'000LL * (argc > 1 ? std::atoll(argv[1]) : 50);
  std::mt19937 generator(20);
  Count lattice, building, many;
  const FaceSet twenty_thousand = scenes::Walls(&generator, 5000, 50, 600);
  while (many.cells < wanted / 500) {
    const PointMm source{scenes::Draw(&generator, 0, 60'000), scenes::Draw(&generator, 0, 40'000)};
    CompareOne(twenty_thousand, source, {{0.0, 0.0}, 1.0, 40, 60}, &generator, &many);
  }
  while (lattice.cells < wanted / 2) CompareLattice(&generator, &lattice);
  while (lattice.cells + building.cells + many.cells < wanted) CompareBuilding(&generator, &building);
  std::printf("plans on a lattice     %9lld cells, %lld differ\n", lattice.cells, lattice.differing);
  std::printf("random buildings       %9lld cells, %lld differ\n", building.cells, building.differing);
  std::printf("20,000 faces           %9lld cells, %lld differ\n", many.cells, many.differing);
  return lattice.differing + building.differing + many.differing == 0 ? 0 : 1;
}

}  // namespace
}  // namespace robotteamsim

int main(int argc, char** argv) { return robotteamsim::Main(argc, argv); }

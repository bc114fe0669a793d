// Maps of radio and voice on a floor of 60 x 40 m at 0.05 m, with 107 walls (428 faces) or 5,000 (20,000 faces), and
// single values; beside the plain way, one ray and one logarithm per cell.
#include <benchmark/benchmark.h>

#include <random>
#include <string>
#include <vector>

#include "../../test/cpp/propagation/reference.hpp"
#include "../../test/cpp/propagation/scenes.hpp"
#include "beside_memset.hpp"
#include "robotteamsim/propagation/field_maps.hpp"
#include "robotteamsim/propagation/radio.hpp"
#include "robotteamsim/propagation/voice.hpp"

namespace robotteamsim {
namespace {

using bench::kGrid;
using bench::Run;

constexpr int kCells = 960'000;
constexpr int kTransmitters = 16;
const Fading kRadio{-47.4, 23.2, 0.05, 0.1};

FaceSet Building(int walls, std::int64_t max_length_mm) {
  std::mt19937 generator(3);
  return scenes::Walls(&generator, walls, 10, max_length_mm);
}

const FaceSet& Garage() {
  static const FaceSet faces = Building(107, 6000);
  return faces;
}

const FaceSet& TwentyThousandFaces() {
  static const FaceSet faces = Building(5000, 600);
  return faces;
}

PointMm Transmitter(int turn) {
  constexpr PointMm kPlaces[] = {{4000, 5000}, {30'010, 20'007}, {52'333, 31'117}, {18'000, 7000}};
  return kPlaces[turn % 4];
}

void RadioMap(benchmark::State& state, Simd simd) {
  if (!IsSupported(simd)) return state.SkipWithError("this machine does not have the instruction set");
  MapValues map(kGrid.rows, kGrid.cols);
  Run(state, &map, kCells, [&](int turn) {
    WriteHighest(Garage(), {{Transmitter(turn), kRadio}}, kGrid, map, {1, simd});
  });
}

/// The plain way, on some rows of the map only.
void PlainMap(benchmark::State& state, const FaceSet& faces, int num_rows) {
  MapValues map(kGrid.rows, kGrid.cols);
  const CellCentersMm cells(kGrid);
  const int apart = kGrid.rows / num_rows;
  const auto some_rows = [&](int turn) {
    for (int row = turn % apart; row < kGrid.rows; row += apart) {
      for (int col = 0; col < kGrid.cols; ++col) {
        map(row, col) = static_cast<float>(reference::Value(faces, Transmitter(turn), kRadio, cells, row, col));
      }
    }
  };
  Run(state, &map, kCells, some_rows, apart);
}

void RadioMapPlain(benchmark::State& state) { PlainMap(state, Garage(), 20); }

void RadioMap20000Faces(benchmark::State& state) {
  MapValues map(kGrid.rows, kGrid.cols);
  Run(state, &map, kCells, [&](int turn) {
    WriteHighest(TwentyThousandFaces(), {{Transmitter(turn), kRadio}}, kGrid, map);
  });
}

void RadioMap20000FacesPlain(benchmark::State& state) { PlainMap(state, TwentyThousandFaces(), 1); }

std::vector<FieldSource> Transmitters() {
  std::vector<FieldSource> sources;
  for (int i = 0; i < kTransmitters; ++i) sources.push_back({{3000 + i * 3600, 2000 + i % 4 * 11'000}, kRadio});
  return sources;
}

/// Time per map.
void RadioMapEachOf16(benchmark::State& state) {
  const std::vector<FieldSource> sources = Transmitters();
  MapValues maps(kTransmitters * kGrid.rows, kGrid.cols);
  const MapWork work{static_cast<int>(state.range(0))};
  const auto write = [&](int) { WriteEach(Garage(), sources, kGrid, maps, work); };
  Run(state, &maps, kCells, write, 1.0 / kTransmitters, work.threads);
}

void RadioMapBestOf16(benchmark::State& state) {
  const std::vector<FieldSource> sources = Transmitters();
  MapValues map(kGrid.rows, kGrid.cols);
  const MapWork work{static_cast<int>(state.range(0))};
  const auto write = [&](int) { WriteHighest(Garage(), sources, kGrid, map, work); };
  Run(state, &map, kTransmitters * kCells, write, 1.0, work.threads);
}

void KeptMap(benchmark::State& state) {
  MapValues map(kGrid.rows, kGrid.cols);
  const WeightMap weights(Garage(), Transmitter(1), kGrid);
  Run(state, &map, kCells, [&](int) { weights.WriteValues(kRadio, map); });
}

/// Time per door.
void KeptMapDoor(benchmark::State& state) {
  constexpr int kDoors = 40;
  MapValues map(kGrid.rows, kGrid.cols);
  FaceSet faces = Garage();
  WeightMap weights(faces, Transmitter(1), kGrid);
  const auto toggle_all = [&](int turn) {
    for (int door = 0; door < kDoors; ++door) {
      faces.SetActive(4 * door, turn % 2 == 1);
      weights.Update(faces);
    }
  };
  Run(state, &map, 1, toggle_all, 1.0 / kDoors);
}

std::vector<VoiceSource> Victims() {
  std::vector<VoiceSource> sources;
  for (int i = 0; i < 5; ++i) sources.push_back({{5.0 + 11.0 * i, 4.0 + 7.5 * i}, -75.0 + i * 0.5, 5.0 + i * 0.2});
  return sources;
}

void VoiceMapOf5(benchmark::State& state) {
  MapValues map(kGrid.rows, kGrid.cols);
  const SolidCells solid = SolidCells::Constant(kGrid.rows, kGrid.cols, false);
  const VoiceModel model{10.0, 1.0, 0.1};
  const std::vector<VoiceSource> victims = Victims();
  Run(state, &map, kCells, [&](int) { WriteVoiceMap(Garage(), model, victims, kGrid, solid, map); });
}

void VoiceMapOf5Plain(benchmark::State& state) {
  constexpr int kApart = 80;
  MapValues map(kGrid.rows, kGrid.cols);
  const VoiceModel model{10.0, 1.0, 0.1};
  const std::vector<VoiceSource> victims = Victims();
  const CellCentersMm cells(kGrid);
  const auto some_rows = [&](int turn) {
    for (int row = turn % kApart; row < kGrid.rows; row += kApart) {
      for (int col = 0; col < kGrid.cols; ++col) {
        double best_db = 0.0;
        for (const VoiceSource& victim : victims) {
          best_db = std::max(best_db, VoiceLevelDb(Garage(), model, victim, cells.At(row, col)));
        }
        map(row, col) = best_db >= model.noise_db ? static_cast<float>(best_db) : 0.0F;
      }
    }
  };
  Run(state, &map, kCells, some_rows, kApart);
}

/// Time per value.
void PathLoss(benchmark::State& state) {
  constexpr int kValues = 1000;
  MapValues map(kGrid.rows, kGrid.cols);
  const RadioModel model{0.0, 47.4, 23.2, 0.1, 18.3, 0.46};
  const auto some_values = [&](int turn) {
    double sum_db = 0.0;
    for (int i = 0; i < kValues; ++i) {
      sum_db += PathLossDb(Garage(), model, Transmitter(turn), {i * 59, 40'000 - i * 31});
    }
    benchmark::DoNotOptimize(sum_db);
  };
  Run(state, &map, 1, some_values, 1.0 / kValues);
}

BENCHMARK_CAPTURE(RadioMap, portable, Simd::kPortable)->UseManualTime();
BENCHMARK_CAPTURE(RadioMap, avx2, Simd::kAvx2)->UseManualTime();
BENCHMARK_CAPTURE(RadioMap, avx512, Simd::kAvx512)->UseManualTime();
BENCHMARK(RadioMapPlain)->UseManualTime()->Iterations(8);
BENCHMARK(RadioMap20000Faces)->UseManualTime();
BENCHMARK(RadioMap20000FacesPlain)->UseManualTime()->Iterations(8);
BENCHMARK(RadioMapEachOf16)->Arg(1)->Arg(2)->UseManualTime();
BENCHMARK(RadioMapBestOf16)->Arg(1)->Arg(2)->UseManualTime();
BENCHMARK(KeptMap)->UseManualTime();
BENCHMARK(KeptMapDoor)->UseManualTime()->Iterations(200);
BENCHMARK(VoiceMapOf5)->UseManualTime();
BENCHMARK(VoiceMapOf5Plain)->UseManualTime()->Iterations(8);
BENCHMARK(PathLoss)->UseManualTime()->Iterations(100);

}  // namespace
}  // namespace robotteamsim

// Maps of radio and voice on a floor of 60 x 40 m at 0.05 m, with 107 walls (428 faces) or 5,000 (20,000 faces), and
// single values; beside the plain way, one ray and one logarithm per cell.
#include <benchmark/benchmark.h>

#include <random>
#include <string>
#include <vector>

#include "../../test/cpp/propagation/reference.hpp"
#include "../../test/cpp/propagation/scenes.hpp"
#include "beside_memset.hpp"
#include "robotteamsim/propagation/maps/field_maps.hpp"
#include "robotteamsim/propagation/radio.hpp"
#include "robotteamsim/propagation/voice.hpp"

namespace robotteamsim {
namespace {

using bench::kGrid;
using bench::Run;

constexpr int kCells = 960'000;
constexpr int kTransmitters = 16;
const propagation::Fading kRadio{-47.4, 23.2, 0.05, 0.1};

propagation::FaceSet Building(int walls, std::int64_t max_length_mm) {
  std::mt19937 generator(3);
  return propagation::scenes::Walls(&generator, walls, 10, max_length_mm);
}

const propagation::FaceSet& Garage() {
  static const propagation::FaceSet faces = Building(107, 6000);
  return faces;
}

const propagation::FaceSet& TwentyThousandFaces() {
  static const propagation::FaceSet faces = Building(5000, 600);
  return faces;
}

propagation::PointMm Transmitter(int turn) {
  constexpr propagation::PointMm kPlaces[] = {{4000, 5000}, {30'010, 20'007}, {52'333, 31'117}, {18'000, 7000}};
  return kPlaces[turn % 4];
}

void RadioMap(benchmark::State& state, base::Simd simd) {
  if (!base::IsSupported(simd)) return state.SkipWithError("this machine does not support the instruction set");
  propagation::MapValues map(kGrid.rows, kGrid.cols);
  Run(state, &map, kCells, [&](int turn) {
    propagation::WriteHighest(Garage(), {{Transmitter(turn), kRadio}}, kGrid, map, {1, simd});
  });
}

/// The plain way, on some rows of the map only.
void PlainMap(benchmark::State& state, const propagation::FaceSet& faces, int num_rows) {
  propagation::MapValues map(kGrid.rows, kGrid.cols);
  const propagation::CellCentersMm cells(kGrid);
  const int apart = kGrid.rows / num_rows;
  const auto some_rows = [&](int turn) {
    for (int row = turn % apart; row < kGrid.rows; row += apart) {
      for (int col = 0; col < kGrid.cols; ++col) {
        map(row, col) =
            static_cast<float>(propagation::reference::Value(faces, Transmitter(turn), kRadio, cells, row, col));
      }
    }
  };
  Run(state, &map, kCells, some_rows, apart);
}

void RadioMapPlain(benchmark::State& state) { PlainMap(state, Garage(), 20); }

void RadioMap20000Faces(benchmark::State& state) {
  propagation::MapValues map(kGrid.rows, kGrid.cols);
  Run(state, &map, kCells, [&](int turn) {
    propagation::WriteHighest(TwentyThousandFaces(), {{Transmitter(turn), kRadio}}, kGrid, map);
  });
}

void RadioMap20000FacesPlain(benchmark::State& state) { PlainMap(state, TwentyThousandFaces(), 1); }

std::vector<propagation::FieldSource> Transmitters() {
  std::vector<propagation::FieldSource> sources;
  for (int i = 0; i < kTransmitters; ++i) sources.push_back({{3000 + i * 3600, 2000 + i % 4 * 11'000}, kRadio});
  return sources;
}

/// Time per map.
void RadioMapEachOf16(benchmark::State& state) {
  const std::vector<propagation::FieldSource> sources = Transmitters();
  propagation::MapValues maps(kTransmitters * kGrid.rows, kGrid.cols);
  const propagation::MapWork work{static_cast<int>(state.range(0))};
  const auto write = [&](int) { propagation::WriteEach(Garage(), sources, kGrid, maps, work); };
  Run(state, &maps, kCells, write, 1.0 / kTransmitters, work.threads);
}

void RadioMapBestOf16(benchmark::State& state) {
  const std::vector<propagation::FieldSource> sources = Transmitters();
  propagation::MapValues map(kGrid.rows, kGrid.cols);
  const propagation::MapWork work{static_cast<int>(state.range(0))};
  const auto write = [&](int) { propagation::WriteHighest(Garage(), sources, kGrid, map, work); };
  Run(state, &map, kTransmitters * kCells, write, 1.0, work.threads);
}

std::vector<propagation::VoiceSource> Victims() {
  std::vector<propagation::VoiceSource> sources;
  for (int i = 0; i < 5; ++i) sources.push_back({{5.0 + 11.0 * i, 4.0 + 7.5 * i}, -75.0 + i * 0.5, 5.0 + i * 0.2});
  return sources;
}

void VoiceMapOf5(benchmark::State& state) {
  propagation::MapValues map(kGrid.rows, kGrid.cols);
  const propagation::SolidCells solid = propagation::SolidCells::Constant(kGrid.rows, kGrid.cols, false);
  const propagation::VoiceModel model{10.0, 1.0, 0.1};
  const std::vector<propagation::VoiceSource> victims = Victims();
  Run(state, &map, kCells, [&](int) { propagation::WriteVoiceMap(Garage(), model, victims, kGrid, solid, map); });
}

void VoiceMapOf5Plain(benchmark::State& state) {
  constexpr int kApart = 80;
  propagation::MapValues map(kGrid.rows, kGrid.cols);
  const propagation::VoiceModel model{10.0, 1.0, 0.1};
  const std::vector<propagation::VoiceSource> victims = Victims();
  const propagation::CellCentersMm cells(kGrid);
  const auto some_rows = [&](int turn) {
    for (int row = turn % kApart; row < kGrid.rows; row += kApart) {
      for (int col = 0; col < kGrid.cols; ++col) {
        double best_db = 0.0;
        for (const propagation::VoiceSource& victim : victims) {
          best_db = std::max(best_db, propagation::VoiceLevelDb(Garage(), model, victim, cells.At(row, col)));
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
  propagation::MapValues map(kGrid.rows, kGrid.cols);
  const propagation::RadioModel model{0.0, 47.4, 23.2, 0.1, 18.3, 0.46};
  const auto some_values = [&](int turn) {
    double sum_db = 0.0;
    for (int i = 0; i < kValues; ++i) {
      sum_db += propagation::PathLossDb(Garage(), model, Transmitter(turn), {i * 59, 40'000 - i * 31});
    }
    benchmark::DoNotOptimize(sum_db);
  };
  Run(state, &map, 1, some_values, 1.0 / kValues);
}

BENCHMARK_CAPTURE(RadioMap, portable, base::Simd::kPortable)->UseManualTime();
BENCHMARK_CAPTURE(RadioMap, avx2, base::Simd::kAvx2)->UseManualTime();
BENCHMARK_CAPTURE(RadioMap, avx512, base::Simd::kAvx512)->UseManualTime();
BENCHMARK(RadioMapPlain)->UseManualTime()->Iterations(8);
BENCHMARK(RadioMap20000Faces)->UseManualTime();
BENCHMARK(RadioMap20000FacesPlain)->UseManualTime()->Iterations(8);
BENCHMARK(RadioMapEachOf16)->Arg(1)->Arg(2)->UseManualTime();
BENCHMARK(RadioMapBestOf16)->Arg(1)->Arg(2)->UseManualTime();
BENCHMARK(VoiceMapOf5)->UseManualTime();
BENCHMARK(VoiceMapOf5Plain)->UseManualTime()->Iterations(8);
BENCHMARK(PathLoss)->UseManualTime()->Iterations(100);

}  // namespace
}  // namespace robotteamsim

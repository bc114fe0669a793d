// Any floor, any grid, any transmitters: maps, links and doors against one ray per value.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <vector>

#include "../cpp/propagation/reference.hpp"
#include "fuzz_bytes.hpp"
#include "fuzz_scene.hpp"
#include "robotteamsim/propagation/maps/field_maps.hpp"
#include "robotteamsim/propagation/radio.hpp"
#include "robotteamsim/propagation/voice.hpp"

namespace robotteamsim::fuzz {

inline std::optional<propagation::FaceSet> Faces(const Scene& scene) {
  try {
    return propagation::FaceSet(scene.ends, scene.weights);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

inline bool IsRefused(const plan::GridShape& grid) {
  try {
    const propagation::CellCentersMm cells(grid);
    return false;
  } catch (const std::invalid_argument&) {
    return true;
  }
}

inline bool SameBits(const propagation::MapValues& a, const propagation::MapValues& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

/// Whether a value of a map is the reference up to floats: 4e-5 dB where no term is beyond 128 dB, and a few of the
/// last bits of a larger one.
inline bool IsNear(float value, double expected, double wall_db) {
  const double largest = std::max({std::abs(expected), wall_db, 128.0});
  return std::abs(static_cast<double>(value) - expected) <= 4e-5 + 4e-7 * (largest - 128.0);
}

inline propagation::MapValues MapOf(const propagation::FaceSet& faces,
                                    const std::vector<propagation::FieldSource>& sources, const plan::GridShape& grid,
                                    const propagation::MapWork& work) {
  propagation::MapValues map = propagation::MapValues::Constant(grid.rows, grid.cols, std::nanf(""));
  propagation::WriteHighest(faces, sources, grid, map, work);
  return map;
}

/// Weights: those of all cells are one ray each, a ray weighs the same both ways, and a longer one never less.
inline void CheckWeights(const propagation::FaceSet& faces, propagation::PointMm source, const plan::GridShape& grid) {
  const propagation::CellCentersMm cells(grid);
  const std::vector<std::int32_t> weights = propagation::WeightsFrom(faces, source, grid);
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      const propagation::PointMm cell = cells.At(row, col);
      const std::int64_t weight = faces.WeightBetween(source, cell);
      Check(weights[row * grid.cols + col] == weight, "the weight of a cell is that of the ray to it");
      Check(faces.WeightBetween(cell, source) == weight, "a ray weighs the same both ways");
      const propagation::PointMm middle{source.x + (cell.x - source.x) / 2, source.y + (cell.y - source.y) / 2};
      const propagation::PointMm doubled{2 * middle.x - source.x, 2 * middle.y - source.y};  // on one line with both
      Check(faces.WeightBetween(source, middle) <= faces.WeightBetween(source, doubled), "a longer ray weighs no less");
    }
  }
}

/// Maps of one and of many sources: the reference, to the bit the same for any thread count and instruction set.
inline void CheckMaps(const propagation::FaceSet& faces, const std::vector<propagation::FieldSource>& sources,
                      const plan::GridShape& grid) {
  const propagation::MapValues map = MapOf(faces, sources, grid, {1, base::Simd::kPortable});
  const propagation::CellCentersMm cells(grid);
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      double expected = -1e300;
      double wall_db = 0.0;
      for (const propagation::FieldSource& source : sources) {
        expected =
            std::max(expected, propagation::reference::Value(faces, source.position, source.fading, cells, row, col));
        const auto weight =
            static_cast<double>(propagation::reference::Weight(faces, source.position, cells, row, col));
        wall_db = std::max(wall_db, weight * source.fading.unit_db);
      }
      Check(IsNear(map(row, col), expected, wall_db), "a map is the reference");
    }
  }
  for (const base::Simd simd : {base::Simd::kAvx2, base::Simd::kAvx512}) {
    if (base::IsSupported(simd))
      Check(SameBits(MapOf(faces, sources, grid, {1, simd}), map), "every instruction set agrees");
  }
  Check(SameBits(MapOf(faces, sources, grid, {3, base::BestSimd()}), map), "any number of threads agrees");
  propagation::MapValues each(grid.rows * static_cast<Eigen::Index>(sources.size()), grid.cols);
  propagation::WriteEach(faces, sources, grid, each);
  propagation::MapValues highest = each.topRows(grid.rows);
  for (std::size_t i = 1; i < sources.size(); ++i) {
    highest = highest.cwiseMax(each.middleRows(static_cast<Eigen::Index>(i) * grid.rows, grid.rows));
  }
  Check(SameBits(highest, map), "the highest of all maps is the map of all");
}

/// Doors: weights follow them, and a map is as before when they are.
inline void CheckDoors(Bytes* bytes, propagation::FaceSet faces, const propagation::FieldSource& source,
                       const plan::GridShape& grid) {
  CheckWeights(faces, source.position, grid);
  const propagation::MapValues before = MapOf(faces, {source}, grid, {});
  if (faces.Size() == 0) return;
  const auto last = static_cast<std::int64_t>(faces.Size()) - 1;
  for (int i = 0; i < 4; ++i) faces.SetActive(static_cast<std::size_t>(bytes->Draw(0, last)), bytes->Coin());
  CheckWeights(faces, source.position, grid);
  for (std::size_t i = 0; i < faces.Size(); ++i) faces.SetActive(i, true);
  Check(SameBits(MapOf(faces, {source}, grid, {}), before), "doors opened and closed again leave a map as it was");
}

/// Links: the single losses, the same both ways; a position that is none is refused.
inline void CheckLinks(Bytes* bytes, const propagation::FaceSet& faces, const propagation::RadioModel& model,
                       Scale scale) {
  propagation::Positions positions(bytes->Draw(0, 12), 2);
  bool sound = true;
  std::vector<propagation::PointMm> points;
  for (Eigen::Index i = 0; i < positions.rows(); ++i) {
    const propagation::PointMm place = Place(bytes, scale);
    positions.row(i) << static_cast<double>(place.x) / 1000.0, static_cast<double>(place.y) / 1000.0;
    if (bytes->Draw(0, 31) == 0) positions(i, bytes->Draw(0, 1)) = bytes->AnyDouble();
    try {
      points.push_back(propagation::RoundToMm({positions(i, 0), positions(i, 1)}, "position"));
    } catch (const std::invalid_argument&) {
      sound = false;
    }
  }
  propagation::CellValues rssi_dbm;
  try {
    rssi_dbm = propagation::RssiMatrixDbm(faces, model, positions);
  } catch (const std::invalid_argument&) {
    Check(!sound, "links are refused only where a position is");
    return;
  }
  Check(sound, "a position that is none is refused");
  for (Eigen::Index i = 0; i < positions.rows(); ++i) {
    for (Eigen::Index j = 0; j < positions.rows(); ++j) {
      const double expected =
          i == j ? 0.0 : model.tx_power_dbm - propagation::PathLossDb(faces, model, points[i], points[j]);
      Check(rssi_dbm(i, j) == expected, "links are the single losses");
    }
  }
}

/// Voices: each cell the loudest of all victims, nothing below the noise or in a wall.
inline void CheckVoices(Bytes* bytes, const propagation::FaceSet& faces, const plan::GridShape& grid, Scale scale) {
  const propagation::VoiceModel model{static_cast<double>(bytes->Draw(0, 80)),
                                      static_cast<double>(bytes->Draw(0, 400)) / 10.0, 0.1};
  std::vector<propagation::VoiceSource> sources(static_cast<std::size_t>(bytes->Draw(1, 3)));
  for (propagation::VoiceSource& source : sources) {
    const propagation::PointMm place = Place(bytes, scale);
    source = {{static_cast<double>(place.x) / 1000.0, static_cast<double>(place.y) / 1000.0},
              -static_cast<double>(bytes->Draw(0, 120)),
              static_cast<double>(bytes->Draw(10, 60)) / 10.0};
  }
  propagation::SolidCells solid = propagation::SolidCells::Constant(grid.rows, grid.cols, false);
  solid(bytes->Draw(0, grid.rows - 1), bytes->Draw(0, grid.cols - 1)) = true;
  propagation::MapValues map(grid.rows, grid.cols);
  propagation::WriteVoiceMap(faces, model, sources, grid, solid, map);
  const propagation::CellCentersMm cells(grid);
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      double expected = -1e300;
      double wall_db = 0.0;
      for (const propagation::VoiceSource& source : sources) {
        const propagation::PointMm at = propagation::RoundToMm(source.position, "source");
        expected = std::max(expected, propagation::VoiceLevelDb(faces, model, source, cells.At(row, col)));
        const auto weight = static_cast<double>(faces.WeightBetween(at, cells.At(row, col)));
        wall_db = std::max(wall_db, weight * model.unit_db);
      }
      if (solid(row, col)) {
        Check(map(row, col) == 0.0F, "no voice is heard in a wall");
      } else if (map(row, col) == 0.0F) {
        Check(expected < model.noise_db + 1e-3 || IsNear(0.0F, expected, wall_db),
              "what is louder than noise is heard");
      } else {
        Check(IsNear(map(row, col), expected, wall_db), "a voice map is the reference");
      }
    }
  }
}

/// Throws Disagreement where two ways of computing disagree; anything else that escapes is a mistake as well.
inline void FuzzPropagation(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const plan::GridShape any_grid = DrawGrid(&bytes, Scale::kLattice);
  const Scene scene = DrawScene(&bytes);
  const plan::GridShape grid = bytes.Coin() ? any_grid : DrawGrid(&bytes, scene.scale);
  const std::optional<propagation::FaceSet> faces = Faces(scene);
  if (!faces) return;
  const propagation::RadioModel model{static_cast<double>(bytes.Draw(-20, 30)), static_cast<double>(bytes.Draw(0, 100)),
                                      static_cast<double>(bytes.Draw(0, 600)) / 10.0,
                                      static_cast<double>(bytes.Draw(1, 2'000)) / 1000.0};
  CheckLinks(&bytes, *faces, model, scene.scale);
  if (IsRefused(grid)) return;
  std::vector<propagation::FieldSource> sources(static_cast<std::size_t>(bytes.Draw(1, 3)));
  for (propagation::FieldSource& source : sources)
    source = {Place(&bytes, scene.scale), propagation::RadioFading(model)};
  try {
    CheckMaps(*faces, sources, grid);
  } catch (const std::invalid_argument&) {
    // The only object left to refuse: sums that 32 bits cannot hold.
    Check(faces->TotalWeight() > 500'000'000, "maps are refused only where the weights are too large");
    return;
  }
  CheckDoors(&bytes, *faces, sources.front(), grid);
  CheckVoices(&bytes, *faces, grid, scene.scale);
}

}  // namespace robotteamsim::fuzz

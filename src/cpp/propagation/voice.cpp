#include "robotteamsim/propagation/voice.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::propagation {
namespace {

double LevelDb(const VoiceModel& model, const VoiceSource& source, const Ray& ray) {
  const double distance_m = std::max(std::sqrt(ray.square_mm2) / 1000.0, model.min_distance_m);
  const double walls_db = static_cast<double>(ray.weight) * model.unit_db;
  return -source.constant_db - 10.0 * source.exponent * std::log10(distance_m) - walls_db;  // (7)
}

void CheckModel(const VoiceModel& model, const VoiceSource& source) {
  base::Check(model.noise_db, "noise_db");
  base::Check(model.unit_db, "unit_db");
  base::CheckPositive(model.min_distance_m, "min_distance_m");
  base::Check(source.constant_db, "constant_db");
  base::Check(source.exponent, "exponent");
}

Fading FadingOf(const VoiceModel& model, const VoiceSource& source) {
  return {-source.constant_db, 10.0 * source.exponent, model.unit_db, model.min_distance_m};
}

}  // namespace

double VoiceLevelDb(const FaceSet& faces, const VoiceModel& model, const VoiceSource& source, PointMm at) {
  CheckModel(model, source);
  const PointMm from = RoundToMm(source.position, "position of a voice");
  return LevelDb(model, source, faces.Between(from, at));
}

void WriteVoiceMap(const FaceSet& faces, const VoiceModel& model, const std::vector<VoiceSource>& sources,
                   const plan::GridShape& grid, const Eigen::Ref<const SolidCells>& solid, MapView map,
                   const MapWork& work) {
  if (solid.rows() != grid.rows || solid.cols() != grid.cols) {
    throw std::invalid_argument("solid must have shape (" + std::to_string(grid.rows) + ", " +
                                std::to_string(grid.cols) + "), got (" + std::to_string(solid.rows()) + ", " +
                                std::to_string(solid.cols()) + ")");
  }
  CheckShape(map, grid.rows, grid.cols);
  if (sources.empty()) {
    map.setZero();
    return;
  }
  std::vector<FieldSource> field_sources;
  field_sources.reserve(sources.size());
  for (const VoiceSource& source : sources) {
    CheckModel(model, source);
    field_sources.push_back({RoundToMm(source.position, "position of a voice"), FadingOf(model, source)});
  }
  const auto noise_db = static_cast<float>(model.noise_db);
  WriteHighest(faces, field_sources, grid, map, {work.threads, work.simd, std::nextafter(noise_db, 0.0F)});
  for (int row = 0; row < grid.rows; ++row) {
    float* const values = &map(row, 0);
    const bool* const is_solid = solid.data() + row * solid.outerStride();
    for (int col = 0; col < grid.cols; ++col) {
      values[col] = values[col] >= noise_db && !is_solid[col] ? values[col] : 0.0F;
    }
  }
}

std::optional<Cell> LoudestCell(const plan::GridShape& grid, const Eigen::Ref<const MapValues>& values,
                                const base::Point& at, double radius_m, const std::optional<Cell>& guess) {
  // Cells from `from` to `to` - 1, one more than needed on each side; the distance decides.
  const auto clamped = [](double cell, int count) { return static_cast<int>(std::clamp(cell, 0.0, 1.0 * count)); };
  const auto from = [&](double origin, double center, int count) {
    return clamped(std::floor((center - radius_m - origin) / grid.resolution_m) - 1.0, count);
  };
  const auto to = [&](double origin, double center, int count) {
    return clamped(std::floor((center + radius_m - origin) / grid.resolution_m) + 2.0, count);
  };
  std::optional<Cell> best;
  const int col_from = from(grid.origin.x, at.x, grid.cols);
  const int col_to = to(grid.origin.x, at.x, grid.cols);
  const int row_to = to(grid.origin.y, at.y, grid.rows);
  const auto is_beyond = [&](int row, int col) {
    const base::Point center = CellCenter(grid, row, col);
    const double dx = center.x - at.x, dy = center.y - at.y;
    return dx * dx + dy * dy > radius_m * radius_m;
  };
  float highest = 0.0F;
  // Cells equal to the guess are found, and most lower cells are skipped.
  if (guess && !is_beyond(guess->row, guess->col)) highest = std::nextafter(values(guess->row, guess->col), 0.0F);
  for (int row = from(grid.origin.y, at.y, grid.rows); row < row_to; ++row) {
    const double dy = CellCenter(grid, row, 0).y - at.y;
    if (dy * dy > radius_m * radius_m) continue;
    for (int col = col_from; col < col_to; ++col) {
      if (values(row, col) <= highest) continue;
      if (is_beyond(row, col)) continue;
      highest = values(row, col);
      best = Cell{row, col, highest};
    }
  }
  return best;
}

}  // namespace robotteamsim::propagation

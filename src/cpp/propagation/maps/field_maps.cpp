#include "robotteamsim/propagation/maps/field_maps.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "robotteamsim/base/log10.hpp"
#include "robotteamsim/base/parallel.hpp"
#include "robotteamsim/propagation/links/storey_links.hpp"
#include "robotteamsim/propagation/maps/wall_shadows.hpp"

namespace robotteamsim::propagation {
namespace {

/// Rows are processed in bands whose changes of weight take about this many bytes, to stay in the core's cache.
constexpr std::size_t kBandBytes = 1 << 18;

/// Cells that are processed together for sources on other storeys.
constexpr int kDistantCells = 1 << 13;

bool FitsNarrow(const FaceSet& faces) { return faces.TotalWeight() <= std::numeric_limits<std::int16_t>::max(); }

/// One source and the shadows of the walls on the grid.
struct PreparedSource {
  PreparedSource(const FaceSet& faces, const FieldSource& source, const CellCentersMm& cells)
      : shadows(faces, source.position, cells), rows(source.fading, source.position, cells) {}

  WallShadows shadows;
  FadingRows rows;
};

/// Writes some columns of the highest values of all sources.
template <typename Weight>
void WriteColumns(const std::vector<const PreparedSource*>& sources, base::Simd simd, IndexRange cols, MapView map) {
  const FadeRows<Weight> fade = FadeRowsFor<Weight>(simd);
  const int width = cols.last - cols.first;
  const auto num_rows = static_cast<int>(map.rows());
  const auto band_rows = static_cast<int>(std::max<std::size_t>(kBandBytes / (sizeof(Weight) * width), 1));
  std::vector<Weight> changes(static_cast<std::size_t>(band_rows) * width);
  std::vector<Weight> running(sources.size() * width);
  std::vector<ShadowSweep> sweeps;
  sweeps.reserve(sources.size());
  for (const PreparedSource* source : sources) sweeps.emplace_back(source->shadows, cols);
  for (int row = 0; row < num_rows; row += band_rows) {
    const IndexRange rows{row, std::min(row + band_rows, num_rows)};
    for (std::size_t i = 0; i < sources.size(); ++i) {  // all sources, while the band is in the cache
      sweeps[i].AddChanges(rows, changes.data(), width);
      const WeightRows<Weight> weights{changes.data(), width, &running[i * width]};
      sources[i]->rows.Write(fade, rows, cols, weights, &map(row, cols.first), map.outerStride(), i > 0);
    }
  }
}

void WriteColumns(const std::vector<const PreparedSource*>& sources, base::Simd simd, bool narrow, IndexRange cols,
                  MapView map) {
  if (narrow) {
    WriteColumns<std::int16_t>(sources, simd, cols, map);
  } else {
    WriteColumns<std::int32_t>(sources, simd, cols, map);
  }
}

/// Divides the columns of a map into one part per thread, each of whole fading blocks.
std::vector<IndexRange> PartsOf(int cols, int threads) {
  const int blocks = (cols + kFadingBlock - 1) / kFadingBlock;
  const int parts = std::min(blocks, base::NumThreads(threads));
  std::vector<IndexRange> columns;
  columns.reserve(static_cast<std::size_t>(parts));
  for (int i = 0; i < parts; ++i) {
    columns.push_back({blocks * i / parts * kFadingBlock, std::min(blocks * (i + 1) / parts * kFadingBlock, cols)});
  }
  return columns;
}

void CheckSources(const std::vector<FieldSource>& sources) {
  if (sources.empty()) throw std::invalid_argument("a map needs at least one source");
}

/// As WriteHighest, where all is on one storey.
void WriteStorey(const FaceSet& faces, const std::vector<FieldSource>& sources, const plan::GridShape& grid,
                 MapView map, const MapWork& work) {
  const CellCentersMm cells(grid);
  const auto count = static_cast<int>(sources.size());
  std::vector<std::optional<PreparedSource>> prepared(sources.size());
  base::ForEachInParallel(count, work.threads, [&](int i) { prepared[i].emplace(faces, sources[i], cells); });
  std::vector<const PreparedSource*> all;
  all.reserve(prepared.size());
  for (const std::optional<PreparedSource>& source : prepared) all.push_back(&*source);
  const bool narrow = FitsNarrow(faces);
  const std::vector<IndexRange> parts = PartsOf(grid.cols, work.threads);
  base::ForEachInParallel(static_cast<int>(parts.size()), work.threads,
                          [&](int i) { WriteColumns(all, work.simd, narrow, parts[i], map); });
}

/// The cells of a grid whose centres lie on a storey.
struct StoreyCells {
  StoreyCells(const Storey& storey, const CellCentersMm& centers)
      : rows{centers.y.FirstFrom(storey.least.y), centers.y.FirstFrom(storey.most.y + 1)},
        cols{centers.x.FirstFrom(storey.least.x), centers.x.FirstFrom(storey.most.x + 1)} {}

  bool IsEmpty() const { return rows.first == rows.last || cols.first == cols.last; }

  plan::GridShape In(const plan::GridShape& grid) const {
    return {{grid.origin.x + cols.first * grid.resolution_m, grid.origin.y + rows.first * grid.resolution_m},
            grid.resolution_m,
            rows.last - rows.first,
            cols.last - cols.first};
  }

  IndexRange rows, cols;
};

/// A source on another storey than the cells of a map.
struct DistantSource {
  FieldSource source;
  std::size_t storey;
};

/// The value of a distant source at a cell, and what it would be without walls.
struct OpenValue {
  float* cell;
  double free_db;    // without floors, too
  double floors_db;  // of those without a weight
  std::int64_t floors_weight;

  double WithWalls(double unit_db, std::int64_t walls) const {
    return free_db - unit_db * static_cast<double>(floors_weight + walls) - floors_db;
  }
};

/// Writes the values of distant sources to rows of cells of a storey, where they are higher.
class DistantRows {
 public:
  DistantRows(const FaceSet& faces, std::size_t storey, const MapWork& work)
      : faces_(faces), storey_(storey), least_db_(work.least_db), links_(faces, work.simd) {}

  void WriteHigher(const DistantSource& from, const CellCentersMm& centers, IndexRange rows, IndexRange cols,
                   MapView map) {
    points_.clear();
    open_.clear();
    for (int row = rows.first; row < rows.last; ++row) {
      for (int col = cols.first; col < cols.last; ++col) LookAt(from, centers.At(row, col), &map(row, col));
    }
    const std::vector<PointMm> source{from.source.position};
    const CellValues walls = faces_.IsAbove(from.storey, storey_)
                                 ? links_.WallsBetween(storey_, points_, from.storey, source)
                                 : links_.WallsBetween(from.storey, source, storey_, points_);
    for (std::size_t i = 0; i < open_.size(); ++i) {
      const auto weight = static_cast<std::int64_t>(walls.data()[i]);
      const auto value_db = static_cast<float>(open_[i].WithWalls(from.source.fading.unit_db, weight));
      *open_[i].cell = std::max(*open_[i].cell, value_db);
    }
  }

 private:
  /// Notes a cell that may become higher.
  void LookAt(const DistantSource& from, PointMm center, float* cell) {
    const auto& [position, fading, floors_db] = from.source;
    const double least_db = std::max(*cell, least_db_);
    const double least_mm = fading.min_distance_m * 1000.0;
    const double square_mm2 = faces_.SquareBetween(from.storey, position, storey_, center);
    const double limited_mm2 = std::max(square_mm2, least_mm * least_mm);
    const double free_db = fading.constant_db - 0.5 * fading.slope_db * base::Log10(limited_mm2 * 1e-6);
    if (free_db <= least_db) return;
    const Ray ray = faces_.ThroughFloors(from.storey, position, storey_, center);
    const OpenValue value{cell, free_db, ray.floors > 0 ? floors_db.at(static_cast<std::size_t>(ray.floors)) : 0.0,
                          ray.weight};
    if (value.WithWalls(fading.unit_db, 0) <= least_db) return;
    open_.push_back(value);
    points_.push_back(center);
  }

  const FaceSet& faces_;
  const std::size_t storey_;
  const float least_db_;
  StoreyLinks links_;
  std::vector<OpenValue> open_;
  std::vector<PointMm> points_;  // their centres
};

/// As WriteHighest, for a building with storeys.
void WriteHighestOfStoreys(const FaceSet& faces, const std::vector<FieldSource>& sources, const plan::GridShape& grid,
                           MapView map, const MapWork& work) {
  map.setConstant(kNothingDb);
  const CellCentersMm centers(grid);
  for (std::size_t i = 0; i < faces.storeys().size(); ++i) {
    const StoreyCells cells(faces.storeys()[i], centers);
    if (cells.IsEmpty()) continue;
    const plan::GridShape part = cells.In(grid);
    std::vector<FieldSource> here;
    std::vector<DistantSource> elsewhere;
    for (const FieldSource& source : sources) {
      const std::size_t storey = faces.StoreyOf(source.position);
      if (storey == i) {
        here.push_back(source);
      } else {
        elsewhere.push_back({source, storey});
      }
    }
    MapView values = map.block(cells.rows.first, cells.cols.first, part.rows, part.cols);
    if (!here.empty()) WriteStorey(faces.OnStorey(i), here, part, values, work);
    if (elsewhere.empty()) continue;
    const int band_rows = std::max(kDistantCells / part.cols, 1);
    base::ForEachInParallel((part.rows + band_rows - 1) / band_rows, work.threads, [&](int band) {
      const int first = cells.rows.first + band * band_rows;
      const IndexRange rows{first, std::min(first + band_rows, cells.rows.last)};
      DistantRows distant(faces, i, work);
      for (const DistantSource& source : elsewhere) distant.WriteHigher(source, centers, rows, cells.cols, map);
    });
  }
}

}  // namespace

void CheckShape(const MapView& map, Eigen::Index rows, Eigen::Index cols) {
  if (map.rows() == rows && map.cols() == cols) return;
  throw std::invalid_argument("a map must have shape (" + std::to_string(rows) + ", " + std::to_string(cols) +
                              "), got (" + std::to_string(map.rows()) + ", " + std::to_string(map.cols()) + ")");
}

void WriteHighest(const FaceSet& faces, const std::vector<FieldSource>& sources, const plan::GridShape& grid,
                  MapView map, const MapWork& work) {
  CheckSources(sources);
  CheckShape(map, grid.rows, grid.cols);
  if (faces.storeys().size() > 1) return WriteHighestOfStoreys(faces, sources, grid, map, work);
  WriteStorey(faces, sources, grid, map, work);
}

void WriteEach(const FaceSet& faces, const std::vector<FieldSource>& sources, const plan::GridShape& grid, MapView maps,
               const MapWork& work) {
  CheckSources(sources);
  CheckShape(maps, grid.rows * static_cast<Eigen::Index>(sources.size()), grid.cols);
  const CellCentersMm cells(grid);
  const bool narrow = FitsNarrow(faces);
  base::ForEachInParallel(static_cast<int>(sources.size()), work.threads, [&](int i) {
    const MapView map = maps.middleRows(static_cast<Eigen::Index>(i) * grid.rows, grid.rows);
    if (faces.storeys().size() > 1)
      return WriteHighestOfStoreys(faces, {sources[i]}, grid, map, {1, work.simd, work.least_db});
    const PreparedSource prepared(faces, sources[i], cells);
    WriteColumns({&prepared}, work.simd, narrow, {0, grid.cols}, map);
  });
}

std::vector<std::int32_t> WeightsFrom(const FaceSet& faces, PointMm source, const plan::GridShape& grid) {
  const CellCentersMm cells(grid);
  const WallShadows shadows(faces, source, cells);
  const auto cols = static_cast<std::size_t>(grid.cols);
  std::vector<std::int32_t> weights(grid.rows * cols, 0);
  ShadowSweep(shadows, {0, grid.cols}).AddChanges({0, grid.rows}, weights.data(), grid.cols);
  for (std::size_t cell = cols; cell < weights.size(); ++cell) weights[cell] += weights[cell - cols];
  return weights;
}

}  // namespace robotteamsim::propagation

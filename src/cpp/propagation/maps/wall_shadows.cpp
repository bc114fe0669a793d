#include "robotteamsim/propagation/maps/wall_shadows.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace robotteamsim::propagation {
namespace {

/// With this limit, sums of up to three changes per face stay below 2^31.
constexpr std::int64_t kMaxTotalWeight = 500'000'000;

/// Returns the face directed to the right, or upward if it is vertical.
Face Rightward(Face face) {
  if (face.end.x < face.start.x || (face.end.x == face.start.x && face.end.y < face.start.y)) {
    std::swap(face.start, face.end);
    std::swap(face.start_vertex, face.end_vertex);
  }
  return face;
}

/// Returns the face directed upward, or to the right if it is horizontal.
Face Upward(Face face) {
  if (face.end.y < face.start.y || (face.end.y == face.start.y && face.end.x < face.start.x)) {
    std::swap(face.start, face.end);
    std::swap(face.start_vertex, face.end_vertex);
  }
  return face;
}

/// Returns per vertex the change of weight from the right to the left of the ray through it, looking outward from the
/// source: the faces that begin there to the left minus those to the right.
std::vector<std::int32_t> TurnsAtVertices(const FaceSet& faces, PointMm source) {
  std::vector<std::int32_t> turns(faces.Vertices().size(), 0);
  for (std::size_t i = 0; i < faces.Size(); ++i) {
    const Face face = faces.At(i);
    const std::int32_t turn = IsLeftOf(face, source) ? face.weight : -face.weight;
    turns[face.start_vertex] += turn;
    turns[face.end_vertex] -= turn;
  }
  return turns;
}

/// A line across the rows of a grid and the change of weight from its left to its right.
struct RowChange {
  GridLine line;           // along y
  std::int64_t above = 0;  // it crosses the rows with above < y <= up_to [mm]
  std::int64_t up_to = 0;
  int sign = 0;
};

constexpr std::int64_t kEverywhere = 2 * kMaxCoordinateMm;

/// Returns the crossings of rows with the ray from a vertex away from the source. Shifted by (eps, eps^2), a vertex at
/// the height of the source is above it, and a ray through a centre passes to the right of it.
std::optional<RowChange> RayAcrossRows(PointMm source, PointMm vertex) {
  const std::int64_t dx = vertex.x - source.x;
  const std::int64_t dy = vertex.y - source.y;
  if (dy > 0) return RowChange{{source.y, source.x, dy, dx, false}, vertex.y, kEverywhere, -1};
  if (dy < 0) return RowChange{{source.y, source.x, -dy, -dx, false}, -kEverywhere, vertex.y, 1};
  return std::nullopt;
}

/// Returns the crossings of rows with a face; the sign is that for a face of weight 1.
std::optional<RowChange> FaceAcrossRows(PointMm source, const Face& any_face) {
  const Face face = Upward(any_face);
  const std::int64_t dx = face.end.x - face.start.x;
  const std::int64_t dy = face.end.y - face.start.y;
  if (dy == 0) return std::nullopt;
  const int sign = IsLeftOf(face, source) ? 1 : -1;
  return RowChange{{face.start.y, face.start.x, dy, dx, false}, face.start.y, face.end.y, sign};
}

}  // namespace

WallShadows::WallShadows(const FaceSet& faces, PointMm source, const CellCentersMm& cells)
    : lowest_row_(cells.x.Count(), 0) {
  if (faces.TotalWeight() > kMaxTotalWeight) {
    throw std::invalid_argument("the sum of all weights must be at most " + std::to_string(kMaxTotalWeight) + ", got " +
                                std::to_string(faces.TotalWeight()));
  }
  const std::vector<std::int32_t> turns = TurnsAtVertices(faces, source);
  changes_.reserve(faces.Size() + turns.size());
  FillLowestRow(faces, source, cells, turns);
  AddRays(faces, source, cells, turns);
  AddFaces(faces, source, cells);
}

void WallShadows::FillLowestRow(const FaceSet& faces, PointMm source, const CellCentersMm& cells,
                                const std::vector<std::int32_t>& turns) {
  const std::int64_t y = cells.y.at.front();
  const auto add = [&](const std::optional<RowChange>& change, std::int32_t weight) {
    if (!change || change->above >= y || change->up_to < y) return;
    const int col = FirstBeyond(change->line, y, cells.x);
    if (col > 0 && col < cells.x.Count()) lowest_row_[col] += change->sign * weight;
  };
  for (std::size_t i = 0; i < turns.size(); ++i) {
    if (turns[i] != 0) add(RayAcrossRows(source, faces.Vertices()[i]), turns[i]);
  }
  for (std::size_t i = 0; i < faces.Size(); ++i) {
    if (faces.Weights()[i] != 0) add(FaceAcrossRows(source, faces.At(i)), faces.Weights()[i]);
  }
  auto weight = static_cast<std::int32_t>(faces.WeightBetween(source, cells.At(0, 0)));
  for (std::int32_t& value : lowest_row_) value = weight += value;
}

void WallShadows::AddRays(const FaceSet& faces, PointMm source, const CellCentersMm& cells,
                          const std::vector<std::int32_t>& turns) {
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const PointMm vertex = faces.Vertices()[i];
    const std::int64_t dx = vertex.x - source.x;
    const std::int64_t dy = vertex.y - source.y;
    if (turns[i] == 0) continue;
    const int next = cells.x.FirstFrom(vertex.x + 1);
    // Shifted by (eps, eps^2), a vertex above the source is to the right of it, and its ray passes all columns beyond
    // the grid. A vertex at the source is in the direction (eps, eps^2), which is horizontal.
    if (dx > 0 || (dx == 0 && dy == 0)) {
      const GridLine line{source.x, source.y, dx > 0 ? dx : 1, dy, dy > 0};
      AddLine(line, cells, {next, cells.x.Count()}, turns[i]);
    } else if (dx < 0) {
      AddLine({source.x, source.y, -dx, -dy, dy < 0}, cells, {0, next}, -turns[i]);
    }
  }
}

void WallShadows::AddFaces(const FaceSet& faces, PointMm source, const CellCentersMm& cells) {
  for (std::size_t i = 0; i < faces.Size(); ++i) {
    const Face face = Rightward(faces.At(i));
    const std::int64_t dx = face.end.x - face.start.x;
    const std::int64_t dy = face.end.y - face.start.y;
    if (face.weight == 0 || dx == 0) continue;
    const IndexRange columns{cells.x.FirstFrom(face.start.x + 1), cells.x.FirstFrom(face.end.x + 1)};
    const GridLine line{face.start.x, face.start.y, dx, dy, dy > 0};
    AddLine(line, cells, columns, IsLeftOf(face, source) ? -face.weight : face.weight);
  }
}

void WallShadows::AddLine(const GridLine& line, const CellCentersMm& cells, IndexRange columns, std::int32_t weight) {
  columns = InsideGrid(line, cells.x, cells.y, columns);
  if (columns.first >= columns.last) return;
  // Below and above the grid the line is crossed before the lowest row, or not at all.
  const auto is_inside = [&](int row) { return row > 0 && row < cells.y.Count(); };
  const auto steps = StepsOf(line, cells.x, cells.y, columns.first, columns.last - columns.first);
  if (!steps) {
    for (int col = columns.first; col < columns.last; ++col) {
      const int row = FirstBeyond(line, cells.x.at[col], cells.y);
      const SteppedLine in_column{static_cast<std::int64_t>(row) << SteppedLine::kFractionBits, 1};
      if (is_inside(row)) changes_.push_back({in_column, col, col + 1, weight});
    }
    return;
  }
  const int first = columns.first;
  while (columns.first < columns.last && !is_inside(steps->At(columns.first - first))) ++columns.first;
  while (columns.first < columns.last && !is_inside(steps->At(columns.last - 1 - first))) --columns.last;
  if (columns.first >= columns.last) return;
  const std::int64_t position = steps->position + (columns.first - first) * steps->step;
  changes_.push_back({{position, steps->step}, columns.first, columns.last, weight});
}

ShadowSweep::ShadowSweep(const WallShadows& shadows, IndexRange columns)
    : lowest_row_(shadows.lowest_row_.data() + columns.first), width_(columns.last - columns.first) {
  lines_.reserve(shadows.changes_.size());
  for (const WallShadows::Change& change : shadows.changes_) {
    const int first = std::max(change.first, columns.first);
    const int count = std::min(change.last, columns.last) - first;
    if (count <= 0) continue;
    const std::int64_t step = change.rows.step;
    const std::int64_t at_first = change.rows.position + (first - change.first) * step;
    const std::int64_t at_last = at_first + (count - 1) * step;
    if (step >= 0) {
      lines_.push_back({at_first, step, at_last + step, first - columns.first, 1, change.weight});
    } else {
      lines_.push_back({at_last, -step, at_first - step, first + count - 1 - columns.first, -1, change.weight});
    }
  }
}

template <typename Weight>
void ShadowSweep::AddChanges(IndexRange rows, Weight* block, std::ptrdiff_t stride) {
  const auto add = [](Weight* cell, std::int32_t weight) { *cell = static_cast<Weight>(*cell + weight); };
  if (rows.first == 0) {
    for (int col = 0; col < width_; ++col) add(block + col, lowest_row_[col]);
  }
  const std::int64_t first_position = static_cast<std::int64_t>(rows.first) << SteppedLine::kFractionBits;
  const std::int64_t beyond = static_cast<std::int64_t>(rows.last - rows.first) << SteppedLine::kFractionBits;
  for (Line& line : lines_) {
    const std::int64_t limit = std::min(beyond, line.end - first_position);
    std::int64_t position = line.position - first_position;
    std::ptrdiff_t col = line.col;
    for (; position < limit; position += line.step, col += line.direction) {
      add(block + (position >> SteppedLine::kFractionBits) * stride + col, line.weight);
    }
    line.position = position + first_position;
    line.col = static_cast<int>(col);
  }
}

template void ShadowSweep::AddChanges(IndexRange, std::int16_t*, std::ptrdiff_t);
template void ShadowSweep::AddChanges(IndexRange, std::int32_t*, std::ptrdiff_t);

}  // namespace robotteamsim::propagation

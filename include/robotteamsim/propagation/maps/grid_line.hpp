#pragma once

#include <cstdint>
#include <optional>

#include "robotteamsim/propagation/cells.hpp"

namespace robotteamsim::propagation {

/// A straight line over a grid, seen along one axis: for each centre along that axis it passes the other axis, across,
/// at one place. What is asked of it is always the first centre across that lies beyond that place.
struct GridLine {
  std::int64_t along = 0;  ///< a point of the line [mm]
  std::int64_t across = 0;
  std::int64_t d_along = 1;  ///< its direction [mm], d_along > 0
  std::int64_t d_across = 0;
  bool centers_on_it_are_beyond = false;
};

/// Returns the index of the first centre across that lies beyond the line where it passes a place along [mm].
int FirstBeyond(const GridLine& line, std::int64_t place_along, const CentersMm& across);

/// The same in fixed-point steps, several times as fast: FirstBeyond at the centre `first` + i along is the whole part
/// of (position + i * step) / 2^kFractionBits.
struct SteppedLine {
  static constexpr int kFractionBits = 40;

  std::int64_t position = 0;
  std::int64_t step = 0;  ///< never 0

  int At(std::int64_t i) const { return static_cast<int>((position + i * step) >> kFractionBits); }
};

/// Returns the steps of a line for `count` centres along from `first`; they may lead beyond the grid's ends. Nothing
/// where the steps would not be exact: a pitch that is not whole, or a line that is very long or very steep.
std::optional<SteppedLine> StepsOf(const GridLine& line, const CentersMm& along, const CentersMm& across, int first,
                                   int count);

/// Returns, of the centres along in a range, those at which FirstBeyond can lie in 1 .. across.Count() - 1; at the ends
/// there may be a few too many.
IndexRange InsideGrid(const GridLine& line, const CentersMm& along, const CentersMm& across, IndexRange range);

}  // namespace robotteamsim::propagation

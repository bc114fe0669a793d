#pragma once

#include <cstdint>
#include <optional>

#include "robotteamsim/propagation/cells.hpp"

namespace robotteamsim::propagation {

/// A straight line over a grid as a function of one axis: at each centre along that axis it has one place on the other
/// axis, across. The query is always for the first centre across beyond that place.
struct GridLine {
  std::int64_t along = 0;  ///< a point of the line [mm]
  std::int64_t across = 0;
  std::int64_t d_along = 1;  ///< its direction [mm], d_along > 0
  std::int64_t d_across = 0;
  bool centers_on_it_are_beyond = false;
};

/// Returns the index of the first centre across beyond the line at a place along [mm].
int FirstBeyond(const GridLine& line, std::int64_t place_along, const CentersMm& across);

/// The same in fixed-point steps: FirstBeyond at the centre `first` + i along is the integer part of (position + i *
/// step) / 2^kFractionBits.
struct SteppedLine {
  static constexpr int kFractionBits = 40;

  std::int64_t position = 0;
  std::int64_t step = 0;  ///< never 0

  int At(std::int64_t i) const { return static_cast<int>((position + i * step) >> kFractionBits); }
};

/// Returns the steps of a line for `count` centres along from `first`; they may lead beyond the grid. Nothing if the
/// steps would not be exact: the pitch is not a whole number, or the line is very long or very steep.
std::optional<SteppedLine> StepsOf(const GridLine& line, const CentersMm& along, const CentersMm& across, int first,
                                   int count);

/// Returns the centres along in a range at which FirstBeyond can be in 1 .. across.Count() - 1, possibly with a few
/// more at the ends.
IndexRange InsideGrid(const GridLine& line, const CentersMm& along, const CentersMm& across, IndexRange range);

}  // namespace robotteamsim::propagation

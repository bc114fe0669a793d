#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace robotteamsim::plan {

/// What a search notes of the cells of a grid.
///
/// Entries are valid only if their stamp is that of the current search: they need not be cleared.
struct SearchNotes {
  std::uint32_t search = 0;
  std::vector<std::uint32_t> stamps;
  std::vector<double> lengths_m;
  std::vector<int> parents;
};

/// Returns the notes for a new search of a grid with so many cells. They are as large as a grid; therefore all grids
/// of a thread share them. They are valid until the next search of this thread begins.
inline SearchNotes& NewSearchNotes(std::size_t cells) {
  thread_local SearchNotes notes;
  if (notes.stamps.size() < cells) {
    notes.stamps.resize(cells);
    notes.lengths_m.resize(cells);
    notes.parents.resize(cells);
  }
  if (++notes.search == 0) {
    std::fill(notes.stamps.begin(), notes.stamps.end(), 0);
    notes.search = 1;
  }
  return notes;
}

}  // namespace robotteamsim::plan

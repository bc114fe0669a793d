#pragma once

#include <cstddef>

namespace robotteamsim::base {

/// A view of a table, stored row by row.
template <typename Value>
struct Table {
  Value* data = nullptr;
  std::size_t rows = 0;
  std::size_t cols = 0;

  bool HasShape(std::size_t num_rows, std::size_t num_cols) const { return rows == num_rows && cols == num_cols; }
  bool IsEmpty() const { return rows == 0 || cols == 0; }
  Value* Row(std::size_t row) const { return data + row * cols; }
};

}  // namespace robotteamsim::base

#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include "robotteamsim/base/table.hpp"

namespace robotteamsim::bindings {

/// A NumPy array in C order; -1 is an extent of any length. Arguments of another type or order are converted.
template <typename Value, nanobind::ssize_t... extents>
using Array =
    nanobind::ndarray<Value, nanobind::numpy, nanobind::shape<extents...>, nanobind::c_contig, nanobind::device::cpu>;

using Points = Array<const double, -1, 2>;
using Triples = Array<const double, -1, 3>;

/// An array of the numbers in a vector, whose memory it takes over.
template <typename Value, nanobind::ssize_t... extents, typename Stored>
Array<Value, extents...> ArrayOf(std::vector<Stored> values, const std::array<std::size_t, sizeof...(extents)>& shape) {
  static_assert(sizeof(Stored) % sizeof(Value) == 0);
  std::size_t size = 1;
  for (const std::size_t extent : shape) size *= extent;
  if (size * sizeof(Value) != values.size() * sizeof(Stored)) throw std::logic_error("not the size of the array");
  auto* const kept = new std::vector<Stored>(std::move(values));
  const nanobind::capsule owner(kept, [](void* memory) noexcept { delete static_cast<std::vector<Stored>*>(memory); });
  return Array<Value, extents...>(reinterpret_cast<Value*>(kept->data()), shape.size(), shape.data(), owner);
}

/// An array whose numbers are not set yet.
template <typename Value>
Array<Value, -1, -1> NewTable(std::size_t rows, std::size_t cols) {
  auto* const numbers = new Value[rows * cols];
  const nanobind::capsule owner(numbers, [](void* memory) noexcept { delete[] static_cast<Value*>(memory); });
  return Array<Value, -1, -1>(numbers, {rows, cols}, owner);
}

template <typename Value>
Array<Value, -1> ArrayOf(std::vector<Value> values) {
  const std::size_t size = values.size();
  return ArrayOf<Value, -1>(std::move(values), {size});
}

/// The values of a grid's cells; one row per row of cells.
template <typename Value, typename Stored>
Array<Value, -1, -1> CellsOf(std::vector<Stored> values, int rows, int cols) {
  return ArrayOf<Value, -1, -1>(std::move(values), {static_cast<std::size_t>(rows), static_cast<std::size_t>(cols)});
}

/// One row of `count` numbers per record; records of doubles only.
template <nanobind::ssize_t count, typename Record>
Array<double, -1, count> RowsOf(std::vector<Record> records) {
  static_assert(sizeof(Record) == count * sizeof(double));
  const std::size_t size = records.size();
  return ArrayOf<double, -1, count>(std::move(records), {size, count});
}

/// The rows of an array of numbers as records; records of doubles only.
template <typename Record, nanobind::ssize_t count>
std::vector<Record> RecordsOf(const Array<const double, -1, count>& rows) {
  static_assert(sizeof(Record) == count * sizeof(double));
  const auto* const records = reinterpret_cast<const Record*>(rows.data());
  return {records, records + rows.shape(0)};
}

/// All values of an array, row by row.
template <typename Value, typename Values>
std::vector<Value> ValuesOf(const Values& values) {
  return std::vector<Value>(values.data(), values.data() + values.size());  // not {}: pointers convert to bool
}

template <typename Value>
base::Table<Value> TableOf(const Array<Value, -1, -1>& rows) {
  return {rows.data(), rows.shape(0), rows.shape(1)};
}

inline Array<bool, -1> FlagsOf(const std::vector<bool>& values) {
  return ArrayOf<bool, -1>(std::vector<unsigned char>(values.begin(), values.end()), {values.size()});
}

}  // namespace robotteamsim::bindings

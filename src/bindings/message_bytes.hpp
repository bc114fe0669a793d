#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>

namespace robotteamsim::bindings {

inline constexpr char kCdrHeader[] = {0, 1, 0, 0};  // little endian

/// The bytes of a message, little endian. In CDR each number is aligned to its own size [OMG DDSI-RTPS, 10].
class Bytes {
 public:
  explicit Bytes(bool is_cdr) : is_cdr_(is_cdr) {
    if (is_cdr) bytes_.assign(std::begin(kCdrHeader), std::end(kCdrHeader));
  }

  bool is_cdr() const { return is_cdr_; }
  const std::string& bytes() const { return bytes_; }

  template <typename Number>
  void Put(Number number) {
    Align(sizeof(Number));
    Append(&number, sizeof(Number));
  }
  void Align(std::size_t size) {
    if (!is_cdr_) return;
    while ((bytes_.size() - sizeof(kCdrHeader)) % size != 0) bytes_.push_back('\0');
  }
  void Append(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }
  void PutCount(std::size_t count) {
    if (count > std::numeric_limits<std::uint32_t>::max()) throw std::out_of_range("too many values");
    Put(static_cast<std::uint32_t>(count));
  }
  void PutText(const char* text, std::size_t size) {
    PutCount(is_cdr_ ? size + 1 : size);
    Append(text, size);
    if (is_cdr_) bytes_.push_back('\0');
  }

 private:
  bool is_cdr_;
  std::string bytes_;
};

/// Reads the bytes of a message that anybody may have written. All throw std::invalid_argument where they are too few.
class Source {
 public:
  Source(const char* data, std::size_t size, bool is_cdr) : data_(data), size_(size), is_cdr_(is_cdr) {
    if (!is_cdr) return;
    is_swapped_ = Skip(sizeof(kCdrHeader))[1] == 0;  // big endian
  }

  std::size_t left() const { return size_ - place_; }
  bool is_cdr() const { return is_cdr_; }

  template <typename Number>
  Number Get() {
    Number number;
    Align(sizeof(Number));
    Copy(&number, sizeof(Number), 1);
    return number;
  }
  void Align(std::size_t size) {
    if (!is_cdr_) return;
    const std::size_t past = (place_ - sizeof(kCdrHeader)) % size;
    if (past != 0) Skip(size - past);
  }
  /// Copies numbers of `size` bytes, of which there are enough.
  void Copy(void* to, std::size_t size, std::size_t count) {
    const char* from = Skip(size * count);
    if (count == 0) return;
    std::memcpy(to, from, size * count);
    if (!is_swapped_) return;
    auto* bytes = static_cast<char*>(to);
    for (std::size_t i = 0; i < count; ++i) std::reverse(bytes + i * size, bytes + (i + 1) * size);
  }
  /// Returns the number of values that follow. Args: least_bytes: of each of them.
  std::size_t GetCount(std::size_t least_bytes) {
    const std::size_t count = Get<std::uint32_t>();
    if (count > left() / std::max<std::size_t>(least_bytes, 1)) throw std::invalid_argument("too short");
    return count;
  }
  const char* Skip(std::size_t size) {
    if (size > left()) throw std::invalid_argument("too short");
    const char* from = data_ + place_;
    place_ += size;
    return from;
  }

 private:
  const char* data_;
  std::size_t size_, place_ = 0;
  bool is_cdr_, is_swapped_ = false;
};

}  // namespace robotteamsim::bindings

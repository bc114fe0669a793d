// Values of all kinds from the bytes that a fuzzer hands out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>

namespace robotteamsim::fuzz {

/// What a target throws where two ways of computing disagree.
class Disagreement : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Throws Disagreement unless a claim holds.
inline void Check(bool holds, const char* claim) {
  if (!holds) throw Disagreement(claim);
}

/// Bytes, read from the front; 0 when they are used up, so that every input is a whole one.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}

  std::size_t Left() const { return left_; }

  std::uint64_t Take(int count) {
    std::uint64_t value = 0;
    for (int i = 0; i < count; ++i) {
      value = value << 8U | (left_ > 0 ? *data_ : 0U);
      if (left_ > 0) {
        ++data_;
        --left_;
      }
    }
    return value;
  }

  bool Coin() { return (Take(1) & 1U) != 0; }

  /// Draws a whole number from low to high.
  std::int64_t Draw(std::int64_t low, std::int64_t high) {
    const auto choices = static_cast<std::uint64_t>(high - low) + 1;
    const int count = choices <= 256 ? 1 : choices <= 65536 ? 2 : 8;
    return low + static_cast<std::int64_t>(Take(count) % choices);
  }

  /// Draws any float64 there is, and those with a meaning of their own more often than by chance.
  double AnyDouble() {
    constexpr std::array<double, 12> kSpecial = {0.0,
                                                 -0.0,
                                                 1.0,
                                                 -1.0,
                                                 0.0005,
                                                 1e6,
                                                 -1e6,
                                                 1000000.0005,
                                                 1e308,
                                                 std::numeric_limits<double>::infinity(),
                                                 std::numeric_limits<double>::quiet_NaN(),
                                                 std::numeric_limits<double>::denorm_min()};
    if (Coin()) return kSpecial[static_cast<std::size_t>(Draw(0, kSpecial.size() - 1))];
    const std::uint64_t bits = Take(8);
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

}  // namespace robotteamsim::fuzz

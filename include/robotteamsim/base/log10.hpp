#pragma once

#include <cstdint>
#include <cstring>

namespace robotteamsim::base {

/// Returns the decimal logarithm of a normal number x > 0, within 3 units in the last place.
///
/// std::log10 uses different instructions on different processors and rounds differently. This one consists of
/// additions, multiplications and one division without a branch: it returns the same bits on every machine, scalar or
/// vectorised.
inline double Log10(double x) {
  constexpr std::uint64_t kHalfRootBits = 0x3FE6A09E667F3BCD;  // sqrt(1/2)
  constexpr std::uint64_t kOneBits = 0x3FF0000000000000;
  constexpr std::uint64_t kFractionBits = 0x000FFFFFFFFFFFFF;
  constexpr std::uint64_t kTwoTo52Bits = 0x4330000000000000;
  // x = 2^k m, where sqrt(1/2) <= m < sqrt(2).
  std::uint64_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  bits += kOneBits - kHalfRootBits;
  const std::uint64_t exponent_bits = kTwoTo52Bits | (bits >> 52);
  const std::uint64_t m_bits = (bits & kFractionBits) + kHalfRootBits;
  double k, m;
  std::memcpy(&k, &exponent_bits, sizeof k);
  std::memcpy(&m, &m_bits, sizeof m);
  k -= 0x1p52 + 1023.0;
  // log m = 2 artanh(s) = 2 (s + s^3/3 + s^5/5 + ...), where |s| < 0.172: ten terms reach the last bit.
  constexpr double kTwoLog10E = 0.86858896380650365530;
  constexpr double kLog10Of2 = 0.30102999566398119521;
  const double s = (m - 1.0) / (m + 1.0);
  const double z = s * s;
  double sum = kTwoLog10E / 19.0;
  sum = sum * z + kTwoLog10E / 17.0;
  sum = sum * z + kTwoLog10E / 15.0;
  sum = sum * z + kTwoLog10E / 13.0;
  sum = sum * z + kTwoLog10E / 11.0;
  sum = sum * z + kTwoLog10E / 9.0;
  sum = sum * z + kTwoLog10E / 7.0;
  sum = sum * z + kTwoLog10E / 5.0;
  sum = sum * z + kTwoLog10E / 3.0;
  return k * kLog10Of2 + (kTwoLog10E * s + s * z * sum);
}

}  // namespace robotteamsim::base

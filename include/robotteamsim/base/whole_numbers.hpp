#pragma once

#include <cstdint>

namespace robotteamsim::base {

/// Returns floor(numerator / positive).
inline std::int64_t FloorDivide(std::int64_t numerator, std::int64_t positive) {
  // Below 2^52 the quotient of doubles is never rounded up to a whole number: it differs from the next one by at least
  // 1/positive, which is more than its last bit. Doubles divide about three times as fast as 64-bit integers.
  constexpr std::int64_t kExactInDouble = std::int64_t{1} << 52;
  if (numerator > -kExactInDouble && numerator < kExactInDouble && positive < kExactInDouble) {
    const double quotient = static_cast<double>(numerator) / static_cast<double>(positive);
    const auto truncated = static_cast<std::int64_t>(quotient);
    return truncated - (quotient < static_cast<double>(truncated) ? 1 : 0);
  }
  const std::int64_t quotient = numerator / positive;
  return quotient - (numerator % positive < 0 ? 1 : 0);
}

}  // namespace robotteamsim::base

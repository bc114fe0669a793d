#include "robotteamsim/base/simd.hpp"

namespace robotteamsim::base {

bool IsSupported(Simd simd) {
  if (simd == Simd::kPortable) return true;
#if ROBOTTEAMSIM_HAS_X86_TARGETS
  if (simd == Simd::kAvx2) return __builtin_cpu_supports("avx2");
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
#else
  return false;
#endif
}

Simd BestSimd() {
  if (IsSupported(Simd::kAvx512)) return Simd::kAvx512;
  return IsSupported(Simd::kAvx2) ? Simd::kAvx2 : Simd::kPortable;
}

}  // namespace robotteamsim::base

#pragma once

#include <stdexcept>

// A hot loop is written once, as a plain inline function, and compiled once per instruction set: the compiler makes it
// as wide as the target of the function that it is inlined into. -ffp-contract=off prevents fused multiply-adds. A
// macro with the parameters (name, attributes) defines that function; ROBOTTEAMSIM_FOR_EACH_SIMD expands it for all
// sets, and SimdVersion picks one. On other machines than x86 all versions are the portable one.
// The attribute target_clones is shorter, but a test could not run each version, and it needs ELF. Highway would be a
// dependency of each wheel and of each program that links the library, for loops that need no intrinsics. Use this
// only where `make bench` shows that it matters: in the loops over maps and links.
#if defined(__GNUC__) && defined(__x86_64__)
#define ROBOTTEAMSIM_HAS_X86_TARGETS 1
#define ROBOTTEAMSIM_AVX2 __attribute__((target("avx2")))
#if defined(__clang__)
#define ROBOTTEAMSIM_AVX512 __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl")))
#else
#define ROBOTTEAMSIM_AVX512 __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width=512")))
#endif
#else
#define ROBOTTEAMSIM_HAS_X86_TARGETS 0
#define ROBOTTEAMSIM_AVX2
#define ROBOTTEAMSIM_AVX512
#endif

#define ROBOTTEAMSIM_FOR_EACH_SIMD(Define) \
  Define(Portable, ) Define(Avx2, ROBOTTEAMSIM_AVX2) Define(Avx512, ROBOTTEAMSIM_AVX512)

#if defined(__GNUC__)
#define ROBOTTEAMSIM_INLINE inline __attribute__((always_inline))
#else
#define ROBOTTEAMSIM_INLINE inline
#endif

namespace robotteamsim::base {

/// The instruction sets that hot loops are compiled for. All return the same bits: they do the same multiplications and
/// additions, never fused.
enum class Simd { kPortable, kAvx2, kAvx512 };

/// Returns whether this machine supports an instruction set.
bool IsSupported(Simd simd);

/// Returns the widest instruction set of this machine.
Simd BestSimd();

/// Returns the version of a loop for an instruction set: a pointer to a function, or to a table of them.
/// Throws std::invalid_argument if this machine does not support the instruction set.
template <typename Version>
Version SimdVersion(Simd simd, Version portable, Version avx2, Version avx512) {
  if (!IsSupported(simd)) throw std::invalid_argument("this machine does not support the requested instruction set");
  if (simd == Simd::kAvx512) return avx512;
  return simd == Simd::kAvx2 ? avx2 : portable;
}

}  // namespace robotteamsim::base

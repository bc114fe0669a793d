#pragma once

// Hot loops are written once, in plain C++, and compiled once per instruction set: the compiler makes them as wide as
// the target of the function that they are inlined into. -ffp-contract=off keeps it from fusing.
#if defined(__GNUC__) && defined(__x86_64__)
#define ROBOTTEAMSIM_HAS_X86_TARGETS 1
#define ROBOTTEAMSIM_AVX2 __attribute__((target("avx2")))
#if defined(__clang__)
#define ROBOTTEAMSIM_AVX512 __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl")))
#else
#define ROBOTTEAMSIM_AVX512 __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width=512")))
#endif
#endif
#if defined(__GNUC__)
#define ROBOTTEAMSIM_INLINE inline __attribute__((always_inline))
#else
#define ROBOTTEAMSIM_INLINE inline
#endif

namespace robotteamsim {

/// The instruction sets that hot loops are compiled for. Values are the same to the bit with each: they do the same
/// multiplications and additions one by one, never fused.
enum class Simd { kPortable, kAvx2, kAvx512 };

/// Returns whether this machine has an instruction set.
bool IsSupported(Simd simd);

/// Returns the widest instruction set of this machine.
Simd BestSimd();

}  // namespace robotteamsim

#pragma once

#include <functional>

namespace robotteamsim::base {

/// Returns the number of threads; 0 means one per core. Throws std::invalid_argument if it is negative.
int NumThreads(int threads);

/// Calls job(0) .. job(count - 1), each once, from several threads; the jobs must not write to the same memory.
/// Args: threads: as for NumThreads; 1: only the calling thread. Throws the first exception of a job.
// std::execution would need TBB, and OpenMP a runtime, in each wheel and each program that links the library.
void ForEachInParallel(int count, int threads, const std::function<void(int)>& job);

}  // namespace robotteamsim::base

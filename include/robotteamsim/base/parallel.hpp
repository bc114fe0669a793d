#pragma once

#include <functional>

namespace robotteamsim::base {

/// Returns the number of threads: the machine's for 0. Throws std::invalid_argument where it is negative.
int NumThreads(int threads);

/// Calls job(0) .. job(count - 1), each once, from as many threads; the jobs must not write to the same place.
/// Args: threads: as for NumThreads; 1 is the calling thread alone. Throws the first exception of a job.
void ForEachInParallel(int count, int threads, const std::function<void(int)>& job);

}  // namespace robotteamsim::base

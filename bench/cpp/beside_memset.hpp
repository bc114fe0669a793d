// What benchmarks of maps share: the map's size, and a memset of it as the measure of the machine.
//
// Each turn of a benchmark does the work and then fills the map by memset, so both see the same machine: the counter
// `memsets` is the median of the work over the median of the memset. What one thread does is timed by its processor's
// time, so that other programs do not count.
#pragma once

#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <vector>

#include "robotteamsim/propagation/cells.hpp"

namespace robotteamsim::bench {

/// Tells who compiled the benchmarks, for the record.
inline const bool kToldCompiler = [] {
#if defined(__clang__)
  benchmark::AddCustomContext("compiler", "clang " __clang_version__);
#elif defined(__GNUC__)
  benchmark::AddCustomContext("compiler", "g++ " __VERSION__);
#else
  benchmark::AddCustomContext("compiler", "unknown");
#endif
  return true;
}();

/// 960,000 cells on a floor of 60 x 40 m.
inline const plan::GridShape kGrid{{0.0, 0.0}, 0.05, 800, 1200};

inline double Seconds(clockid_t clock, const std::function<void()>& work) {
  const auto now = [clock] {
    timespec time{};
    clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  };
  const double start = now();
  work();
  return now() - start;
}

inline double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// Times work(turn) against a memset of the first `map` that it writes.
/// Args: share: the part of a turn that counts as one; items: cells, links, ... of that part.
inline void Run(benchmark::State& state, propagation::MapValues* map, int items, const std::function<void(int)>& work,
                double share = 1.0, int threads = 1) {
  const clockid_t clock = threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC;
  std::vector<double> work_s;
  std::vector<double> memset_s;
  int turn = 0;
  work(turn);
  for (auto _ : state) {
    work_s.push_back(Seconds(clock, [&] { work(turn); }) * share);
    ++turn;
    memset_s.push_back(Seconds(clock, [&] {
      std::memset(map->data(), turn, sizeof(float) * kGrid.rows * kGrid.cols);
      benchmark::ClobberMemory();
    }));
    state.SetIterationTime(work_s.back());
  }
  state.counters["median_us"] = Median(work_s) * 1e6;
  state.counters["ns_per_item"] = Median(work_s) * 1e9 / items;
  state.counters["memsets"] = Median(work_s) / Median(memset_s);
}

}  // namespace robotteamsim::bench

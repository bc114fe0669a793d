#include "robotteamsim/base/parallel.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace robotteamsim::base {
namespace {

TEST(Parallel, DoesEveryJobOnceWithAnyNumberOfThreads) {
  for (const int threads : {0, 1, 2, 7}) {
    std::vector<int> done(100, 0);
    ForEachInParallel(100, threads, [&](int i) { ++done[i]; });
    EXPECT_EQ(done, std::vector<int>(100, 1)) << threads;
  }
}

TEST(Parallel, PassesOnWhatAJobThrows) {
  for (const int threads : {1, 3}) {
    EXPECT_THROW(ForEachInParallel(20, threads,
                                   [](int i) {
                                     if (i == 7) throw std::out_of_range("7");
                                   }),
                 std::out_of_range);
  }
}

TEST(Parallel, HasNothingToDoWithoutJobs) {
  ForEachInParallel(0, 2, [](int) { FAIL(); });
}

TEST(Parallel, RefusesANegativeNumberOfThreads) {
  EXPECT_THROW(NumThreads(-1), std::invalid_argument);
  EXPECT_GE(NumThreads(0), 1);
  EXPECT_EQ(NumThreads(3), 3);
}

}  // namespace
}  // namespace robotteamsim::base

#include "robotteamsim/base/large_pages.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace robotteamsim::base {
namespace {

TEST(AskForLargePages, LeavesWhatIsInMemoryAsItIs) {
  constexpr std::size_t kBytes = (std::size_t{9} << 20) + 17;
  std::vector<unsigned char> memory(kBytes);
  for (std::size_t i = 0; i < kBytes; ++i) memory[i] = static_cast<unsigned char>(i % 251);
  AskForLargePages(memory.data(), kBytes);
  AskForLargePages(memory.data() + 1, kBytes - 1);
  AskForLargePages(memory.data() + 5000, 3);
  AskForLargePages(nullptr, 0);
  std::size_t num_changed = 0;
  for (std::size_t i = 0; i < kBytes; ++i) num_changed += memory[i] == i % 251 ? 0 : 1;
  EXPECT_EQ(num_changed, 0u);
}

}  // namespace
}  // namespace robotteamsim::base

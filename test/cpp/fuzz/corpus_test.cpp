// The inputs that fuzzing has kept, without a fuzzer: what was mended stays mended.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "../../fuzz/fuzz_network.hpp"
#include "../../fuzz/fuzz_propagation.hpp"

namespace robotteamsim::fuzz {
namespace {

const std::filesystem::path kCorpus = ROBOTTEAMSIM_FUZZ_CORPUS;

template <typename Target>
void RunCorpus(const char* name, Target target) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kCorpus / name)) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::vector<char> text((std::istreambuf_iterator<char>(file)), {});
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    EXPECT_NO_THROW(target(bytes.data(), bytes.size())) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 0);
}

TEST(FuzzCorpus, OfPropagationFindsNoDisagreement) { RunCorpus("propagation", FuzzPropagation); }

TEST(FuzzCorpus, OfTheNetworkFindsNoDisagreement) { RunCorpus("network", FuzzNetwork); }

TEST(FuzzCheck, ThrowsWhereAClaimDoesNotHold) {
  EXPECT_THROW(Check(false, "never"), Disagreement);
  EXPECT_NO_THROW(Check(true, "always"));
}

}  // namespace
}  // namespace robotteamsim::fuzz

// libFuzzer's way into FuzzNetwork.
#include "fuzz_network.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  robotteamsim::fuzz::FuzzNetwork(data, size);
  return 0;
}

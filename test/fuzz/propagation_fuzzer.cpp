// libFuzzer's way into FuzzPropagation.
#include "fuzz_propagation.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  robotteamsim::fuzz::FuzzPropagation(data, size);
  return 0;
}

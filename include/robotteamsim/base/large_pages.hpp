#pragma once

#include <cstddef>

namespace robotteamsim::base {

/// Asks the system to back fresh memory by large pages, where it has them: a matrix of many megabytes that is written
/// across is then found by few entries of the processor's page table cache. No value depends on it.
void AskForLargePages(void* memory, std::size_t bytes);

}  // namespace robotteamsim::base

#pragma once

#include <cstddef>

namespace robotteamsim::base {

/// Asks the system to back new memory by large pages where it has them: a matrix of many megabytes then needs few
/// entries of the processor's page table cache. No value depends on it.
void AskForLargePages(void* memory, std::size_t bytes);

}  // namespace robotteamsim::base

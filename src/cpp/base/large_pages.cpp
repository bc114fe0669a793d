#include "robotteamsim/base/large_pages.hpp"

#include <cstdint>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace robotteamsim::base {

void AskForLargePages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  constexpr std::uintptr_t kPage = 4096;
  constexpr std::size_t kLarge = std::size_t{4} << 20;
  if (bytes < kLarge) return;
  const auto start = reinterpret_cast<std::uintptr_t>(memory);
  const std::uintptr_t first_page = (start + kPage - 1) / kPage * kPage;
  // This is only advice: if the system refuses, nothing else changes.
  void* const pages = static_cast<char*>(memory) + (first_page - start);
  (void)madvise(pages, (start + bytes - first_page) / kPage * kPage, MADV_HUGEPAGE);
#endif
}

}  // namespace robotteamsim::base

// Memory of arrays, for this program only. They lie in pages of 2 MB. Freed memory is kept for the next array. In
// pages of 4 kB, page faults and translation of addresses took a sixth of some runs. docs/speed.md ("Pages of memory")
// has figures.
#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t huge_page = std::size_t{1} << 21;
constexpr std::size_t least_large = 2 * huge_page;

// The pages that lie wholly in [first, last). A system without huge pages refuses.
void ask_for_huge_pages(void* first, void* last) {
  const std::size_t before = (huge_page - reinterpret_cast<std::uintptr_t>(first) % huge_page) % huge_page;
  const auto bytes = static_cast<std::size_t>(static_cast<char*>(last) - static_cast<char*>(first));
  if (bytes < before + huge_page) return;
  madvise(static_cast<char*>(first) + before, (bytes - before) / huge_page * huge_page, MADV_HUGEPAGE);
}

void* allocate(std::size_t bytes) {
  if (bytes < least_large) return std::malloc(bytes > 0 ? bytes : 1);
  void* const memory = std::aligned_alloc(huge_page, bytes);
  if (memory != nullptr) ask_for_huge_pages(memory, static_cast<char*>(memory) + bytes);
  return memory;
}

bool address_space_is_limited() {
  rlimit limit{};
  return getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur != RLIM_INFINITY;
}

// Addresses for arrays below least_large. They take memory when arrays use them.
[[gnu::constructor]] void reserve_addresses() {
  if (address_space_is_limited()) return;
  constexpr int reserve = 512 << 20;
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 2 * (reserve - 1));
  mallopt(M_ARENA_MAX, 1);
  mallopt(M_TOP_PAD, reserve);
  void* const before = sbrk(0);
  void* volatile block = std::malloc(1 << 20);  // else the compiler leaves both calls out
  std::free(block);
  mallopt(M_TOP_PAD, 16 << 20);
  ask_for_huge_pages(before, sbrk(0));
}

}  // namespace

void* operator new(std::size_t bytes) {
  for (;;) {
    if (void* const memory = allocate(bytes)) return memory;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

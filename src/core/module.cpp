#include "cloudbow/core/module.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <pthread.h>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/sandbox.hpp"
#include "cloudbow/core/sanitizers.hpp"

namespace cloudbow {

namespace {

#if defined(RTLD_DEEPBIND)
constexpr int deep_binding = RTLD_DEEPBIND;
#else
constexpr int deep_binding = 0;  // not in other C libraries
#endif

void check_memory_to_load(const char* file, const ModuleNeeds& needs) {
  pthread_attr_t attributes{};
  std::size_t stack = 8'388'608;
  if (pthread_getattr_default_np(&attributes) == 0) {
    pthread_attr_getstacksize(&attributes, &stack);
    pthread_attr_destroy(&attributes);
  }
  const std::uint64_t left = memory_left_by_limits(), needed = needs.memory_bytes + needs.threads * stack;
  if (left >= needed) return;
  throw InputError(
      fmt::format("{}: too little memory to load {} (found {} MB that the limits of this process leave, allowed {} "
                  "MB and more) raise `ulimit -v` and `ulimit -d`",
                  file, needs.library, left / 1'000'000, needed / 1'000'000));
}

}  // namespace

const void* load_module(const char* file, const char* symbol, const ModuleNeeds& needs) {
  check_memory_to_load(file, needs);
  // The runtimes of sanitizers refuse this order.
  const bool own_first = needs.own_symbols_first && !has_address_sanitizer && !has_thread_sanitizer;
  void* const library = dlopen(file, RTLD_NOW | RTLD_LOCAL | (own_first ? deep_binding : 0));
  const void* const found = library != nullptr ? dlsym(library, symbol) : nullptr;
  if (found != nullptr) return found;
  throw InputError(
      fmt::format("{}: the part of cloudbow that {} cannot be loaded ({}) install cloudbow anew, or add the module's "
                  "folder to LD_LIBRARY_PATH",
                  file, needs.use, dlerror()));
}

}  // namespace cloudbow

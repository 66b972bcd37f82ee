#include "cloudbow/core/digest.hpp"

#include <xxhash.h>

#include <new>

namespace cloudbow {

/// The state of xxHash lies in memory that it aligns itself.
struct Digest::State {
  State() : xxh3(XXH3_createState()) {
    if (xxh3 == nullptr) throw std::bad_alloc();
    XXH3_64bits_reset(xxh3);
  }
  ~State() { XXH3_freeState(xxh3); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  XXH3_state_t* xxh3;
};

Digest::Digest() : state_(std::make_unique<State>()) {}

Digest::~Digest() = default;

void Digest::add_bytes(const void* bytes, std::size_t count) {
  if (count > 0) XXH3_64bits_update(state_->xxh3, bytes, count);  // no values: bytes may be null
}

std::uint64_t Digest::value() const { return XXH3_64bits_digest(state_->xxh3); }

}  // namespace cloudbow

#include "cloudbow/core/digest.hpp"

#include <cstring>

namespace cloudbow {

// As FNV-1a, but on words of eight bytes, which takes an eighth of the time. The shift lets high bits reach low ones,
// which a multiplication alone does not.
void Digest::add_bytes(const void* bytes, std::size_t count) {
  const char* at = static_cast<const char*>(bytes);
  const auto mix = [this](std::uint64_t word) {
    value_ = (value_ ^ word) * 1099511628211u;
    value_ ^= value_ >> 29;
  };
  for (; count >= sizeof(std::uint64_t); count -= sizeof(std::uint64_t), at += sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, at, sizeof word);
    mix(word);
  }
  std::uint64_t rest = 0;
  if (count > 0) std::memcpy(&rest, at, count);  // no values: at may be null
  mix(rest ^ (std::uint64_t{count} << 56));
}

}  // namespace cloudbow

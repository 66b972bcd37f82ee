// A number that stands for data: other data have another one, but for a chance of 2^-64. No defence against intent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace cloudbow {

class Digest {
 public:
  void add_bytes(const void* bytes, std::size_t count);

  template <class T>
  void add(std::span<const T> values) {
    static_assert(std::is_arithmetic_v<T>);  // other types may hold padding
    add(values.size());
    add_bytes(values.data(), values.size_bytes());
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void add(T value) { add_bytes(&value, sizeof value); }

  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037u;
};

}  // namespace cloudbow

// 64-bit non-cryptographic hash (XXH3) of data that come piece by piece.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>

namespace cloudbow {

/// Two different inputs have the same value with a probability of about 2^-64. The value depends on the bytes alone and
/// not on how many at a time are added. Files store values, so a change of the values raises the format numbers of
/// checkpoints and cached tables.
class Digest {
 public:
  Digest();
  ~Digest();
  Digest(const Digest&) = delete;
  Digest& operator=(const Digest&) = delete;

  void add_bytes(const void* bytes, std::size_t count);

  /// The number of values, then the values, so that the ends of arrays count.
  template <class T>
  void add(std::span<const T> values) {
    static_assert(std::is_arithmetic_v<T>);  // other types may hold padding
    add(values.size());
    add_bytes(values.data(), values.size_bytes());
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void add(T value) { add_bytes(&value, sizeof value); }

  /// Hash of everything added so far. More may be added afterwards.
  std::uint64_t value() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cloudbow

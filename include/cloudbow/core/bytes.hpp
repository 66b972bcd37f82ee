// Values as bytes of this machine's memory, for another process of the same program.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "cloudbow/core/error.hpp"

namespace cloudbow {

/// Types whose bytes are their value, without padding: numbers, enumerations, and arrays of them.
template <class Value>
inline constexpr bool is_plain = std::is_arithmetic_v<Value> || std::is_enum_v<Value>;
template <class Value, std::size_t count>
inline constexpr bool is_plain<std::array<Value, count>> = is_plain<Value>;

/// Writes values one after the other. Structures call the archive with all their members, by a function
/// `visit_members(archive, structure)` beside them; the same function reads them.
class ByteWriter {
 public:
  template <class... Values>
  void operator()(const Values&... values) {
    (add(values), ...);
  }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  template <class Value>
  void add(const Value& value) {
    if constexpr (is_plain<Value>) {
      add_bytes(&value, sizeof value);
    } else {
      // Members are only read: const is added again by the archive's own parameters.
      visit_members(*this, const_cast<Value&>(value));
    }
  }
  void add(const std::string& text) {
    add(text.size());
    add_bytes(text.data(), text.size());
  }
  template <class Value>
  void add(const std::optional<Value>& value) {
    add(value.has_value());
    if (value) add(*value);
  }
  template <class Value>
  void add(const std::vector<Value>& values) {
    add(values.size());
    if constexpr (is_plain<Value>) {
      add_bytes(values.data(), values.size() * sizeof(Value));
    } else {
      for (const Value& value : values) add(value);
    }
  }
  void add_bytes(const void* from, std::size_t count) {
    const auto* const first = static_cast<const std::byte*>(from);
    bytes_.insert(bytes_.end(), first, first + count);
  }

  std::vector<std::byte> bytes_;
};

/// Reads what a ByteWriter has written, in the same order. @throws InputError if the bytes end too early, or if a truth
/// value is neither 0 nor 1.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : left_(bytes) {}

  template <class... Values>
  void operator()(Values&... values) {
    (get(values), ...);
  }

 private:
  template <class Value>
  void get(Value& value) {
    if constexpr (is_plain<Value>) {
      get_bytes(&value, sizeof value);
    } else {
      visit_members(*this, value);
    }
  }
  /// Another byte than 0 and 1 in a bool is undefined behaviour.
  void get(bool& value) {
    std::uint8_t byte = 0;
    get_bytes(&byte, sizeof byte);
    if (byte > 1) throw InputError("its bytes are damaged");
    value = byte != 0;
  }
  void get(std::string& text) {
    text.resize(count(1));
    get_bytes(text.data(), text.size());
  }
  template <class Value>
  void get(std::optional<Value>& value) {
    bool has_value = false;
    get(has_value);
    value.reset();
    if (has_value) get(value.emplace());
  }
  template <class Value>
  void get(std::vector<Value>& values) {
    values.resize(count(is_plain<Value> ? sizeof(Value) : 1));
    if constexpr (is_plain<Value>) {
      get_bytes(values.data(), values.size() * sizeof(Value));
    } else {
      for (Value& value : values) get(value);
    }
  }
  /// A number of values that the bytes left can hold.
  std::size_t count(std::size_t bytes_of_each) {
    std::size_t found = 0;
    get(found);
    if (found > left_.size() / bytes_of_each) throw InputError("it ends too early");
    return found;
  }
  void get_bytes(void* to, std::size_t count) {
    if (count > left_.size()) throw InputError("it ends too early");
    if (count > 0) std::memcpy(to, left_.data(), count);
    left_ = left_.subspan(count);
  }

  std::span<const std::byte> left_;
};

/// A direction or position: Eigen's types are not trivially copyable.
template <class Archive, class Vector>
requires requires(Vector& v) { v.x(), v.y(), v.z(); }
void visit_members(Archive& archive, Vector& vector) { archive(vector.x(), vector.y(), vector.z()); }

}  // namespace cloudbow

// Values of the nodes of a VDB grid: whole or only the active ones, compressed or not, of 32 or 16 bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_plain_bytes.hpp"

namespace cloudbow {

/// How the values of a grid are stored.
struct PlainCoding {
  enum class Method { none, zip, blosc };
  Method method = Method::none;
  bool only_active = false;  ///< inactive values are left out if a node has at most two of them
  bool half = false;

  /// @throws NotPlain for flags that are not known
  static PlainCoding of_flags(std::uint32_t flags, bool half);
};

/// Reads the values of nodes one after the other.
class PlainNodeValues {
 public:
  PlainNodeValues(PlainBytes& bytes, const PlainCoding& coding) : bytes_(bytes), coding_(coding) {}

  /// Reads a node of 64 * active.size() values. @param active mask of its active values
  void read(std::span<const std::uint64_t> active, float background);

  /// No inactive value differs from the background.
  bool only_background() const { return only_background_; }
  /// Only active values are stored, in their order.
  const std::vector<float>& stored() const { return stored_; }
  bool stores_all() const { return stores_all_; }
  /// An inactive value; its bit must not be active.
  float inactive(std::size_t bit) const {
    if (stores_all_) return stored_[bit];
    const bool second = !selection_.empty() && ((selection_[bit / 64] >> (bit % 64)) & 1U) != 0;
    return inactive_[second ? 1 : 0];
  }

 private:
  void read_stored(std::size_t count);
  /// The bytes of values, without their compression.
  void read_block(std::span<std::byte> target);

  PlainBytes& bytes_;
  PlainCoding coding_;
  std::array<float, 2> inactive_{};
  std::vector<std::uint64_t> selection_{};  ///< bits of inactive values that are the second one; empty: none
  std::vector<float> stored_{};
  std::vector<std::uint16_t> halves_{};
  std::vector<std::byte> compressed_{};
  bool stores_all_ = false;
  bool only_background_ = false;
};

/// The number that has these 16 bits.
float float_of_half(std::uint16_t bits);

}  // namespace cloudbow

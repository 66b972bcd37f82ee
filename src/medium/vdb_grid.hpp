// A float grid of a VDB file without types of OpenVDB. Both readers of files fill it, and the rules of clouds use it.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace cloudbow {

using VdbIndex = std::array<std::int32_t, 3>;

/// Metadata that should be a vector.
struct VdbVector {
  std::string wrong_type{};  ///< the type that was found, if it is none of a vector; else empty
  std::array<double, 3> value{};
};

/// Transform and metadata of a grid, as far as clouds use them.
struct VdbGridHeader {
  std::string map_type{};  ///< OpenVDB's name of the transform
  bool is_linear = true;
  bool is_singular = false;                       ///< the matrix is then not set
  std::array<std::array<double, 4>, 4> matrix{};  ///< rows belong to indices, the last one to the translation
  std::string quantity{};                         ///< empty if there is none
  std::string units{};                            ///< empty if there is none
  bool is_level_set = false;
  std::optional<std::int64_t> voxel_count{};  ///< of the active voxels, by the metadata
  std::optional<VdbIndex> first_voxel{};      ///< lower corner of the active voxels, by the metadata
  std::optional<VdbIndex> last_voxel{};       ///< upper corner, included
  std::optional<VdbVector> domain_min_m{};
  std::optional<VdbVector> domain_max_m{};
};

/// A cube of voxels of one value, which the tree stores once.
struct VdbTile {
  VdbIndex origin;
  std::int32_t edge;  ///< voxels along each axis
  float value;

  std::uint64_t voxels() const {
    const auto n = static_cast<std::uint64_t>(edge);
    return n * n * n;
  }
};

/// A leaf of the tree: 8 x 8 x 8 voxels and their values. Bit 64 x + 8 y + z of a mask belongs to voxel (x, y, z).
struct VdbLeaf {
  static constexpr int edge = 8;
  static constexpr int voxels = 512;
  using Mask = std::array<std::uint64_t, voxels / 64>;

  VdbIndex origin{};
  Mask active{};
  Mask differs{};         ///< inactive voxels with other values than the background
  std::size_t first = 0;  ///< place of the first active voxel among VdbGrid::values

  VdbIndex index(int bit) const { return {origin[0] + bit / 64, origin[1] + bit / 8 % 8, origin[2] + bit % 8}; }
  static bool is_on(const Mask& mask, int bit) { return (mask[static_cast<std::size_t>(bit) / 64] >> (bit % 64)) & 1U; }
  static void set_on(Mask& mask, int bit) {
    mask[static_cast<std::size_t>(bit) / 64] |= std::uint64_t{1} << (bit % 64);
  }
};

/// Calls function(bit) for each bit that is set, in ascending order.
template <class Words, class Function>
void for_each_bit(const Words& words, Function function) {
  int begin = 0;
  for (std::uint64_t word : words) {
    for (; word != 0; word &= word - 1) function(begin + std::countr_zero(word));
    begin += 64;
  }
}

template <class Words>
std::size_t count_bits(const Words& words) {
  std::size_t bits = 0;
  for (const std::uint64_t word : words) bits += static_cast<std::size_t>(std::popcount(word));
  return bits;
}

/// Values that a file stores for voxels that are not active, if they differ from the background.
struct VdbInactiveValues {
  std::uint64_t voxels = 0;
  float example = 0;  ///< the first one in the order of the tree

  static bool differs(float value, float background) {
    return !(value == background || (std::isnan(value) && std::isnan(background)));
  }
  void add(float value, std::uint64_t with_this_value) {
    if (voxels == 0) example = value;
    voxels += with_this_value;
  }
};

/// Leaves and tiles are in the order of the tree. No voxel belongs to two of them.
struct VdbGrid {
  VdbGridHeader header{};
  float background = 0;
  std::vector<VdbLeaf> leaves{};
  std::vector<float> values{};  ///< of the active voxels of the leaves, by leaf, then by bit
  std::vector<VdbTile> active_tiles{};
  std::vector<VdbTile> differing_tiles{};  ///< inactive, of other values than the background
  VdbInactiveValues inactive{};            ///< of leaves and tiles

  std::uint64_t active_voxels() const;
};

/// Corners of the active voxels, both included; empty if there are none.
std::optional<std::array<VdbIndex, 2>> active_box(const VdbGrid& grid);

/// Calls function(index, value) for each active voxel: those of leaves, then those of tiles.
template <class Function>
void for_each_active_voxel(const VdbGrid& grid, Function function) {
  for (const VdbLeaf& leaf : grid.leaves) {
    std::size_t at = leaf.first;
    for_each_bit(leaf.active, [&](int bit) { function(leaf.index(bit), grid.values[at++]); });
  }
  for (const VdbTile& tile : grid.active_tiles) {
    const auto [x, y, z] = tile.origin;
    for (std::int32_t i = 0; i < tile.edge; ++i) {
      for (std::int32_t j = 0; j < tile.edge; ++j) {
        for (std::int32_t k = 0; k < tile.edge; ++k) function(VdbIndex{x + i, y + j, z + k}, tile.value);
      }
    }
  }
}

/// Finds the voxels of a grid by their indices. Neighbours are found fast. The grid must outlive it.
class VdbLookup {
 public:
  explicit VdbLookup(const VdbGrid& grid);

  struct Found {
    bool is_active;
    bool is_background;  ///< not active, with the background as its value
    float value;         ///< if active
  };
  Found at(const VdbIndex& index);

 private:
  struct Hash {
    std::size_t operator()(const VdbIndex& index) const;
  };
  using Places = std::unordered_map<VdbIndex, std::size_t, Hash>;

  /// Tiles of one size.
  struct Tiles {
    std::int32_t edge;
    bool are_active;
    std::unordered_map<VdbIndex, float, Hash> value;
  };

  const VdbGrid& grid_;
  Places leaf_of_;
  std::vector<Tiles> tiles_;
  const VdbLeaf* last_leaf_ = nullptr;
};

}  // namespace cloudbow

// The tree of a float grid of an ordinary VDB file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_grid.hpp"
#include "vdb_plain_bytes.hpp"
#include "vdb_plain_values.hpp"

namespace cloudbow {

/// Reads the tree from the present position. It has a root, nodes of 32^3 and of 16^3 children, and leaves of 8^3
/// voxels.
class PlainTree {
 public:
  /// @param memory_bytes that the grid may take as a cloud
  PlainTree(PlainBytes& bytes, const PlainCoding& coding, std::uint64_t memory_bytes, VdbGrid& grid)
      : bytes_(bytes), values_(bytes, coding), memory_bytes_(memory_bytes), grid_(grid) {}

  /// The first part: tiles, and masks of leaves. @throws NotPlain
  void read_topology();
  /// The second part: values of leaves. @throws NotPlain
  void read_leaves();

 private:
  struct RootTile {
    VdbTile tile;
    bool is_active;
  };
  /// A tile that is not active, and the number of leaves before it.
  struct InactiveTile {
    VdbTile tile;
    std::size_t leaves;
  };

  std::vector<RootTile> read_root_tiles(std::uint32_t count);
  void add_tile(const VdbTile& tile, bool is_active);
  /// @tparam Log2 of the children along an axis. @tparam ChildLog2 of the voxels of a child along an axis
  template <int Log2, int ChildLog2>
  void read_node(const VdbIndex& origin);
  void read_leaf(VdbLeaf& leaf);
  /// Counts the inactive tiles that come before the leaf of this number.
  void count_inactive_tiles(std::size_t leaves);
  void check_memory() const;

  PlainBytes& bytes_;
  PlainNodeValues values_;
  std::uint64_t memory_bytes_;
  VdbGrid& grid_;
  std::vector<InactiveTile> inactive_tiles_{};
  std::size_t counted_tiles_ = 0;
  double active_voxels_ = 0;
};

}  // namespace cloudbow

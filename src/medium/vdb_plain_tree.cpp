#include "vdb_plain_tree.hpp"

#include <array>

namespace cloudbow {

namespace {

constexpr int root_child_log2 = 12;  // of the voxels of a child of the root along an axis

/// In a file, indices of the root are those of the first voxel.
VdbIndex read_root_index(PlainBytes& bytes) {
  VdbIndex index{};
  for (std::int32_t& i : index) {
    i = bytes.number<std::int32_t>();
    require_plain((i & ((1 << root_child_log2) - 1)) == 0);
  }
  return index;
}

}  // namespace

void PlainTree::check_memory() const {
  // As a cloud, a voxel takes 40 bytes.
  const std::size_t leaves = sizeof(VdbLeaf) * grid_.leaves.size();
  const std::size_t tiles = sizeof(VdbTile) * (grid_.active_tiles.size() + 3 * inactive_tiles_.size());
  require_plain(40 * active_voxels_ + static_cast<double>(leaves + tiles) <= static_cast<double>(memory_bytes_));
}

void PlainTree::add_tile(const VdbTile& tile, bool is_active) {
  if (is_active) {
    active_voxels_ += static_cast<double>(tile.voxels());
    grid_.active_tiles.push_back(tile);
  } else if (VdbInactiveValues::differs(tile.value, grid_.background)) {
    inactive_tiles_.push_back({tile, grid_.leaves.size()});
  }
}

std::vector<PlainTree::RootTile> PlainTree::read_root_tiles(std::uint32_t count) {
  constexpr std::uint64_t bytes_per_tile = 17;
  require_plain(count <= bytes_.left() / bytes_per_tile);
  std::vector<RootTile> tiles;
  for (std::uint32_t n = 0; n < count; ++n) {
    const VdbIndex origin = read_root_index(bytes_);
    require_plain(tiles.empty() || tiles.back().tile.origin < origin);
    const auto value = bytes_.number<float>();
    tiles.push_back({{origin, 1 << root_child_log2, value}, bytes_.flag()});
  }
  return tiles;
}

void PlainTree::read_topology() {
  require_plain(bytes_.number<std::int32_t>() == 1);  // buffers per leaf
  grid_.background = bytes_.number<float>();
  const auto tile_count = bytes_.number<std::uint32_t>();
  const auto children = bytes_.number<std::uint32_t>();
  const std::vector<RootTile> tiles = read_root_tiles(tile_count);
  auto tile = tiles.begin();
  VdbIndex last{};
  for (std::uint32_t child = 0; child < children; ++child) {
    const VdbIndex origin = read_root_index(bytes_);
    require_plain(child == 0 || last < origin);
    last = origin;
    for (; tile != tiles.end() && tile->tile.origin < origin; ++tile) add_tile(tile->tile, tile->is_active);
    require_plain(tile == tiles.end() || tile->tile.origin != origin);
    read_node<5, 7>(origin);
  }
  for (; tile != tiles.end(); ++tile) add_tile(tile->tile, tile->is_active);
  check_memory();
}

template <int Log2, int ChildLog2>
void PlainTree::read_node(const VdbIndex& origin) {
  constexpr int entries = 1 << (3 * Log2);
  std::array<std::uint64_t, entries / 64> children{};
  std::array<std::uint64_t, entries / 64> active{};
  bytes_.read(std::as_writable_bytes(std::span(children)));
  bytes_.read(std::as_writable_bytes(std::span(active)));
  for (std::size_t word = 0; word < children.size(); ++word) require_plain((children[word] & active[word]) == 0);
  values_.read(active, grid_.background);

  // The next child overwrites the values, so the tiles are taken from them first.
  std::array<std::uint64_t, entries / 64> used = children;
  const bool has_differing = !values_.only_background();
  std::vector<float> tile_values;
  std::size_t next_active = 0;
  for (int entry = 0; entry < entries; ++entry) {
    const auto word = static_cast<std::size_t>(entry) / 64;
    const std::uint64_t bit = std::uint64_t{1} << (entry % 64);
    if ((children[word] & bit) != 0) continue;
    const bool is_active = (active[word] & bit) != 0;
    if (!is_active && !has_differing) continue;
    float value = 0;
    if (!is_active) {
      value = values_.inactive(static_cast<std::size_t>(entry));
      if (!VdbInactiveValues::differs(value, grid_.background)) continue;
    } else {
      value = values_.stored()[values_.stores_all() ? static_cast<std::size_t>(entry) : next_active++];
    }
    used[word] |= bit;
    tile_values.push_back(value);
  }

  std::size_t next_tile = 0;
  for_each_bit(used, [&](int entry) {
    constexpr int mask = (1 << Log2) - 1;
    const VdbIndex place{origin[0] + ((entry >> (2 * Log2)) << ChildLog2),
                         origin[1] + (((entry >> Log2) & mask) << ChildLog2),
                         origin[2] + ((entry & mask) << ChildLog2)};
    const auto word = static_cast<std::size_t>(entry) / 64;
    if (((children[word] >> (entry % 64)) & 1U) == 0) {
      add_tile({place, 1 << ChildLog2, tile_values[next_tile++]}, ((active[word] >> (entry % 64)) & 1U) != 0);
    } else if constexpr (ChildLog2 == 3) {
      VdbLeaf& leaf = grid_.leaves.emplace_back();
      leaf.origin = place;
      bytes_.read(std::as_writable_bytes(std::span(leaf.active)));
      active_voxels_ += static_cast<double>(count_bits(leaf.active));
    } else {
      read_node<4, 3>(place);
    }
  });
  check_memory();
}

void PlainTree::count_inactive_tiles(std::size_t leaves) {
  for (; counted_tiles_ < inactive_tiles_.size() && inactive_tiles_[counted_tiles_].leaves <= leaves;
       ++counted_tiles_) {
    const VdbTile& tile = inactive_tiles_[counted_tiles_].tile;
    grid_.inactive.add(tile.value, tile.voxels());
    grid_.differing_tiles.push_back(tile);
  }
}

void PlainTree::read_leaf(VdbLeaf& leaf) {
  VdbLeaf::Mask again{};
  bytes_.read(std::as_writable_bytes(std::span(again)));
  require_plain(again == leaf.active);
  values_.read(leaf.active, grid_.background);
  leaf.first = grid_.values.size();
  const std::vector<float>& stored = values_.stored();
  if (values_.stores_all()) {
    for_each_bit(leaf.active, [&](int bit) { grid_.values.push_back(stored[static_cast<std::size_t>(bit)]); });
  } else {
    grid_.values.insert(grid_.values.end(), stored.begin(), stored.end());
  }
  if (values_.only_background()) return;
  for (int bit = 0; bit < VdbLeaf::voxels; ++bit) {
    if (VdbLeaf::is_on(leaf.active, bit)) continue;
    const float value = values_.inactive(static_cast<std::size_t>(bit));
    if (!VdbInactiveValues::differs(value, grid_.background)) continue;
    VdbLeaf::set_on(leaf.differs, bit);
    grid_.inactive.add(value, 1);
  }
}

void PlainTree::read_leaves() {
  std::size_t voxels = 0;
  for (const VdbLeaf& leaf : grid_.leaves) voxels += count_bits(leaf.active);
  grid_.values.reserve(voxels);
  for (std::size_t n = 0; n < grid_.leaves.size(); ++n) {
    count_inactive_tiles(n);
    read_leaf(grid_.leaves[n]);
  }
  count_inactive_tiles(grid_.leaves.size());
}

}  // namespace cloudbow

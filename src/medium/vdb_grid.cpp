#include "vdb_grid.hpp"

#include <algorithm>

namespace cloudbow {

namespace {

/// Origin of the cube of this edge, a power of 2, that has the voxel.
VdbIndex origin_of(const VdbIndex& index, std::int32_t edge) {
  VdbIndex origin = index;
  for (std::int32_t& i : origin) i &= ~(edge - 1);
  return origin;
}

}  // namespace

std::uint64_t VdbGrid::active_voxels() const {
  std::uint64_t voxels = values.size();
  for (const VdbTile& tile : active_tiles) voxels += tile.voxels();
  return voxels;
}

std::optional<std::array<VdbIndex, 2>> active_box(const VdbGrid& grid) {
  std::optional<std::array<VdbIndex, 2>> box;
  const auto add = [&box](const VdbIndex& low, const VdbIndex& high) {
    if (!box) box = {low, high};
    for (std::size_t a = 0; a < 3; ++a) {
      (*box)[0][a] = std::min((*box)[0][a], low[a]);
      (*box)[1][a] = std::max((*box)[1][a], high[a]);
    }
  };
  for (const VdbLeaf& leaf : grid.leaves) {
    for_each_bit(leaf.active, [&](int bit) { add(leaf.index(bit), leaf.index(bit)); });
  }
  for (const VdbTile& tile : grid.active_tiles) {
    const std::int32_t last = tile.edge - 1;
    add(tile.origin, {tile.origin[0] + last, tile.origin[1] + last, tile.origin[2] + last});
  }
  return box;
}

std::size_t VdbLookup::Hash::operator()(const VdbIndex& index) const {
  std::uint64_t hash = 0;
  for (const std::int32_t i : index) {
    hash = (hash ^ static_cast<std::uint32_t>(i)) * 0x9e3779b97f4a7c15U;
    hash ^= hash >> 32U;
  }
  return hash;
}

VdbLookup::VdbLookup(const VdbGrid& grid) : grid_(grid) {
  leaf_of_.reserve(grid.leaves.size());
  for (std::size_t n = 0; n < grid.leaves.size(); ++n) leaf_of_.emplace(grid.leaves[n].origin, n);
  for (const bool are_active : {true, false}) {
    for (const VdbTile& tile : are_active ? grid.active_tiles : grid.differing_tiles) {
      auto same = std::find_if(tiles_.begin(), tiles_.end(), [&](const Tiles& tiles) {
        return tiles.edge == tile.edge && tiles.are_active == are_active;
      });
      if (same == tiles_.end()) same = tiles_.insert(same, {tile.edge, are_active, {}});
      same->value.emplace(tile.origin, tile.value);
    }
  }
}

VdbLookup::Found VdbLookup::at(const VdbIndex& index) {
  const VdbIndex origin = origin_of(index, VdbLeaf::edge);
  if (last_leaf_ == nullptr || last_leaf_->origin != origin) {
    const auto found = leaf_of_.find(origin);
    last_leaf_ = found == leaf_of_.end() ? nullptr : &grid_.leaves[found->second];
  }
  if (last_leaf_ != nullptr) {
    const int bit = 64 * (index[0] - origin[0]) + 8 * (index[1] - origin[1]) + (index[2] - origin[2]);
    if (!VdbLeaf::is_on(last_leaf_->active, bit)) return {false, !VdbLeaf::is_on(last_leaf_->differs, bit), 0};
    std::size_t at = last_leaf_->first;
    for (int word = 0; word < bit / 64; ++word) {
      at += static_cast<std::size_t>(std::popcount(last_leaf_->active[static_cast<std::size_t>(word)]));
    }
    const std::uint64_t below = (std::uint64_t{1} << (bit % 64)) - 1;
    at += static_cast<std::size_t>(std::popcount(last_leaf_->active[static_cast<std::size_t>(bit) / 64] & below));
    return {true, false, grid_.values[at]};
  }
  for (const Tiles& tiles : tiles_) {
    const auto found = tiles.value.find(origin_of(index, tiles.edge));
    if (found != tiles.value.end()) return {tiles.are_active, false, found->second};
  }
  return {false, true, 0};
}

}  // namespace cloudbow

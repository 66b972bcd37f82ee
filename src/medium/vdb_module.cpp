#include "vdb_module.hpp"

#include <oneapi/tbb/global_control.h>
#include <openvdb/openvdb.h>

#include <system_error>
#include <utility>

#include "cloudbow/core/sandbox.hpp"
#include "vdb_input.hpp"
#include "vdb_write.hpp"

namespace cloudbow {

namespace {

std::string text_metadata(const openvdb::GridBase& grid, const char* name) {
  const auto item = grid.getMetadata<openvdb::StringMetadata>(name);
  return item ? item->value() : "";
}

std::optional<VdbVector> vector_metadata(const openvdb::GridBase& grid, const char* name) {
  const auto item = grid[name];
  if (!item) return std::nullopt;
  openvdb::Vec3d value;
  if (const auto* d = dynamic_cast<const openvdb::Vec3DMetadata*>(item.get())) {
    value = d->value();
  } else if (const auto* s = dynamic_cast<const openvdb::Vec3SMetadata*>(item.get())) {
    value = openvdb::Vec3d(s->value());
  } else if (const auto* i = dynamic_cast<const openvdb::Vec3IMetadata*>(item.get())) {
    value = openvdb::Vec3d(i->value());
  } else {
    return VdbVector{.wrong_type = item->typeName()};
  }
  return VdbVector{.value = {value[0], value[1], value[2]}};
}

VdbIndex index_of(const openvdb::Vec3i& index) { return {index[0], index[1], index[2]}; }

std::optional<VdbIndex> index_metadata(const openvdb::GridBase& grid, const char* name) {
  const auto item = grid.getMetadata<openvdb::Vec3IMetadata>(name);
  if (!item) return std::nullopt;
  return index_of(item->value());
}

VdbGridHeader header_of(const openvdb::GridBase& grid) {
  VdbGridHeader header;
  const openvdb::math::Transform& transform = grid.transform();
  header.map_type = transform.mapType();
  header.is_linear = transform.isLinear();
  if (header.is_linear) {
    try {
      const openvdb::Mat4d matrix = transform.baseMap()->getAffineMap()->getMat4();
      for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) header.matrix[row][column] = matrix(row, column);
      }
    } catch (const openvdb::ArithmeticError&) {
      header.is_singular = true;
    }
  }
  header.quantity = text_metadata(grid, "quantity");
  header.units = text_metadata(grid, "units");
  header.is_level_set = grid.getGridClass() == openvdb::GRID_LEVEL_SET;
  if (const auto count = grid.getMetadata<openvdb::Int64Metadata>(openvdb::GridBase::META_FILE_VOXEL_COUNT)) {
    header.voxel_count = count->value();
  }
  header.first_voxel = index_metadata(grid, openvdb::GridBase::META_FILE_BBOX_MIN);
  header.last_voxel = index_metadata(grid, openvdb::GridBase::META_FILE_BBOX_MAX);
  header.domain_min_m = vector_metadata(grid, "domain_min_m");
  header.domain_max_m = vector_metadata(grid, "domain_max_m");
  return header;
}

void copy_leaf(const openvdb::FloatTree::LeafNodeType& from, VdbGrid& grid) {
  VdbLeaf& leaf = grid.leaves.emplace_back();
  leaf.origin = index_of(from.origin().asVec3i());
  leaf.first = grid.values.size();
  for (auto voxel = from.cbeginValueOn(); voxel; ++voxel) {
    VdbLeaf::set_on(leaf.active, static_cast<int>(voxel.pos()));
    grid.values.push_back(*voxel);
  }
  for (auto voxel = from.cbeginValueOff(); voxel; ++voxel) {
    if (VdbInactiveValues::differs(*voxel, grid.background)) {
      VdbLeaf::set_on(leaf.differs, static_cast<int>(voxel.pos()));
    }
  }
}

template <class Tile>
VdbTile tile_of(const Tile& tile) {
  const openvdb::CoordBBox box = tile.getBoundingBox();
  return {index_of(box.min().asVec3i()), box.dim()[0], *tile};
}

void copy_tree(const openvdb::FloatTree& tree, VdbGrid& grid) {
  constexpr int deepest_tile = openvdb::FloatTree::ValueOnCIter::LEAF_DEPTH - 1;
  grid.background = tree.background();
  grid.leaves.reserve(tree.leafCount());
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) copy_leaf(*leaf, grid);
  auto active = tree.cbeginValueOn();
  active.setMaxDepth(deepest_tile);
  for (; active; ++active) grid.active_tiles.push_back(tile_of(active));
  for (auto value = tree.cbeginValueOff(); value; ++value) {
    if (!VdbInactiveValues::differs(*value, grid.background)) continue;
    grid.inactive.add(*value, value.getVoxelCount());
    if (static_cast<int>(value.getDepth()) <= deepest_tile) grid.differing_tiles.push_back(tile_of(value));
  }
}

/// Some damaged files make OpenVDB overflow its heap, loop endlessly or request all memory: the file is first parsed in
/// a child process. OpenVDB uses one thread in both processes: a child inherits no others, and would wait for them.
template <class Parse, class Read>
auto after_parsing(const std::filesystem::path& path, Parse parse, Read read) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);
  // A grid of constant leaves takes 30 MB for each megabyte of the file; then something to spare.
  read_in_sandbox(path, {.library = "OpenVDB", .memory_bytes = 64 * (error ? 0 : bytes) + 512000000}, parse);
  return read();
}

VdbGrid read_whole_grid(const std::filesystem::path& path, const std::string& name, const VdbGridChecks& checks) {
  const auto parse = [&] {
    VdbInput input(path, name);
    input.load(input.find(name));
  };
  const auto read = [&] {
    VdbInput input(path, name);
    const auto& entry = input.find(name);
    VdbGrid grid;
    grid.header = header_of(*entry.grid);
    checks.header(grid.header);
    const auto loaded = input.load(entry);
    checks.voxels(static_cast<double>(loaded->activeVoxelCount()));
    copy_tree(loaded->tree(), grid);
    return grid;
  };
  return after_parsing(path, parse, read);
}

std::vector<VdbGridInfo> grids_of(const VdbInput& input) {
  std::vector<VdbGridInfo> grids;
  for (const auto& entry : input.entries()) {
    VdbGridInfo grid;
    grid.name = entry.name;
    grid.type = entry.type;
    grid.quantity = text_metadata(*entry.grid, "quantity");
    grid.units = text_metadata(*entry.grid, "units");
    grids.push_back(std::move(grid));
  }
  return grids;
}

std::vector<VdbGridInfo> list_grids(const std::filesystem::path& path) {
  const auto list = [&] { return grids_of(VdbInput(path, "")); };
  return after_parsing(path, list, list);
}

}  // namespace

}  // namespace cloudbow

const cloudbow::VdbModule cloudbow_vdb_module = {cloudbow::read_whole_grid, cloudbow::list_grids,
                                                 cloudbow::vdb::write_cloud, cloudbow::vdb::write_fields};

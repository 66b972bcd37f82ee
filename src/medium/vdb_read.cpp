#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "cloudbow/core/available_memory.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/rehearsal.hpp"
#include "row_spans.hpp"
#include "vdb_input.hpp"
#include "vdb_module.hpp"
#include "vdb_write.hpp"

namespace cloudbow {

namespace {

using Vector = std::array<double, 3>;

constexpr double face_tolerance =
    1e-3;  // of a voxel: far below what matters, far above the rounding of 32-bit metadata

struct Place {
  const std::filesystem::path& path;
  const std::string& grid;

  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    throw InputError(
        fmt::format("{}: grid \"{}\": {}", path.string(), grid, fmt::format(text, std::forward<Args>(args)...)));
  }
};

/// Voxel indices of the file to cells of the scene. Along axis a of the scene, the voxel of index n = sign[a] *
/// index[axis[a]] is centred at centre[a] + n * size[a].
struct Placement {
  std::array<int, 3> axis;
  std::array<int, 3> sign;
  std::array<double, 3> size;
  std::array<double, 3> centre;
  std::array<double, 3> stretch;  ///< scene metres per metre of the file

  std::array<std::int64_t, 3> cell(const openvdb::Coord& index) const {
    return {std::int64_t{sign[0]} * index[axis[0]], std::int64_t{sign[1]} * index[axis[1]],
            std::int64_t{sign[2]} * index[axis[2]]};
  }
  openvdb::Coord index(const std::array<std::int64_t, 3>& cell) const {
    openvdb::Coord result;
    for (int a = 0; a < 3; ++a) result[axis[a]] = static_cast<openvdb::Int32>(sign[a] * cell[a]);
    return result;
  }
  double lower_face(int a, std::int64_t n) const { return centre[a] + (static_cast<double>(n) - 0.5) * size[a]; }
  /// Distance of a height, breadth or width from the lower face of voxel 0, in voxels.
  double faces(int a, double position) const { return (position - lower_face(a, 0)) / size[a]; }
};

struct Voxel {
  std::array<std::int32_t, 3> cell;
  float value;
};

std::uint64_t memory_limit(const VdbReadOptions& options) {
  if (options.memory_limit_bytes > 0) return options.memory_limit_bytes;
  return available_memory_bytes() / 2;
}

void check_options(const VdbReadOptions& options) {
  if (!(options.scale > 0) || !std::isfinite(options.scale)) {
    throw InputError(fmt::format("scale: out of range ({} found, a finite number > 0 is allowed)", options.scale));
  }
  for (const double size : options.voxel_size_m.value_or(Vector{1, 1, 1})) {
    if (!(size > 0) || !std::isfinite(size)) {
      throw InputError(fmt::format("voxel_size_m: out of range ({} found, finite numbers > 0 are allowed)", size));
    }
  }
  if (options.up_axis != "x" && options.up_axis != "y" && options.up_axis != "z") {
    throw InputError(
        fmt::format("up_axis: unknown axis (\"{}\" found, \"x\", \"y\" and \"z\" are allowed)", options.up_axis));
  }
}

Placement place(const openvdb::math::Transform& transform, const VdbReadOptions& options, const Place& where) {
  if (!transform.isLinear()) {
    where.fail(
        "the transform is not linear ({} found, a positive scale along the axes with a translation is allowed) "
        "resample the grid "
        "to boxes along the axes",
        transform.mapType());
  }
  openvdb::Mat4d matrix;
  try {
    matrix = transform.baseMap()->getAffineMap()->getMat4();
  } catch (const openvdb::ArithmeticError&) {
    where.fail("the transform is singular (a positive scale along the axes with a translation is allowed)");
  }
  double largest = 0;
  for (int a = 0; a < 3; ++a) largest = std::max(largest, std::abs(matrix(a, a)));
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      // Over a thousand voxels a slope of 1e-6 moves a voxel by face_tolerance.
      if (row != column && !(std::abs(matrix(row, column)) <= 1e-6 * largest)) {
        where.fail(
            "the transform rotates or shears (its matrix has {:.6g} beside the diagonal {:.6g}, {:.6g}, {:.6g}; a "
            "positive scale "
            "along the axes with a translation is allowed) resample the grid along the axes, or use up_axis if the "
            "file has y or x up",
            matrix(row, column), matrix(0, 0), matrix(1, 1), matrix(2, 2));
      }
    }
  }
  for (int a = 0; a < 3; ++a) {
    if (!(matrix(a, a) > 0) || !std::isfinite(matrix(a, a)) || !std::isfinite(matrix(3, a))) {
      where.fail(
          "the transform mirrors or degenerates the grid (scale {:.6g}, {:.6g}, {:.6g}; positive scales are allowed) "
          "resample the grid "
          "with positive voxel sizes",
          matrix(0, 0), matrix(1, 1), matrix(2, 2));
    }
  }

  Placement result{.axis = {0, 1, 2}, .sign = {1, 1, 1}, .size = {}, .centre = {}, .stretch = {1, 1, 1}};
  if (options.up_axis == "y") {
    result.axis = {0, 2, 1};
    result.sign = {1, -1, 1};
  } else if (options.up_axis == "x") {
    result.axis = {1, 2, 0};
  }
  for (int a = 0; a < 3; ++a) {
    result.size[a] = matrix(result.axis[a], result.axis[a]);
    if (options.voxel_size_m) {
      result.stretch[a] = (*options.voxel_size_m)[a] / result.size[a];
      result.size[a] = (*options.voxel_size_m)[a];
    }
    result.centre[a] = result.sign[a] * matrix(3, result.axis[a]) * result.stretch[a];
  }
  return result;
}

std::optional<openvdb::Vec3d> vector_metadata(const openvdb::GridBase& grid, const char* name, const Place& where) {
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
    where.fail("metadata {} has the wrong type ({} found, vec3d, vec3s and vec3i are allowed)", name, item->typeName());
  }
  if (!value.isFinite()) where.fail("metadata {} is not finite ({}, {}, {})", name, value[0], value[1], value[2]);
  return value;
}

struct Domain {
  Vector min_m;
  Vector max_m;
};

/// The domain of the metadata in the scene's axes.
std::optional<Domain> metadata_domain(const openvdb::GridBase& grid, const Placement& placement, const Place& where) {
  const auto low = vector_metadata(grid, "domain_min_m", where);
  const auto high = vector_metadata(grid, "domain_max_m", where);
  if (low.has_value() != high.has_value()) {
    where.fail("metadata {} is missing ({} is there; both or none are allowed)", low ? "domain_max_m" : "domain_min_m",
               low ? "domain_min_m" : "domain_max_m");
  }
  if (!low) return std::nullopt;
  Domain domain{};
  for (int a = 0; a < 3; ++a) {
    const int axis = placement.axis[a];
    const auto [first, last] =
        placement.sign[a] > 0 ? std::pair((*low)[axis], (*high)[axis]) : std::pair(-(*high)[axis], -(*low)[axis]);
    domain.min_m[a] = first * placement.stretch[a];
    domain.max_m[a] = last * placement.stretch[a];
  }
  return domain;
}

std::int64_t nearest_face(const Placement& placement, int a, double position, const Place& where) {
  const double faces = placement.faces(a, position);
  const double nearest = std::nearbyint(faces);
  if (!(std::abs(faces - nearest) <= face_tolerance)) {
    where.fail(
        "the domain of the metadata does not end on voxel faces ({} = {:.10g} m found, {:.10g} m is the nearest face)",
        "xyz"[a], position, placement.lower_face(a, 0) + nearest * placement.size[a]);
  }
  if (std::abs(nearest) > std::numeric_limits<std::int32_t>::max()) {
    where.fail("the domain of the metadata is too large ({} = {:.10g} m found)", "xyz"[a], position);
  }
  return static_cast<std::int64_t>(nearest);
}

void check_memory(double bytes, const VdbReadOptions& options, const Place& where, const std::string& found) {
  const auto limit = memory_limit(options);
  if (bytes > static_cast<double>(limit)) {
    where.fail("too large ({}: {:.3g} GB to read, {:.3g} GB are allowed) crop or coarsen the grid", found, bytes * 1e-9,
               static_cast<double>(limit) * 1e-9);
  }
}

// A voxel passes through the tree (4 bytes and its share of the leaf), the list of voxels (16), the rows (8) and the
// field (4).
void check_voxels(double voxels, const VdbReadOptions& options, const Place& where) {
  const std::string found = fmt::format("{:.0f} active voxels", voxels);
  check_memory(40.0 * voxels, options, where, found);
  if (voxels > std::numeric_limits<std::uint32_t>::max()) where.fail("too large ({}; 4294967295 are allowed)", found);
}

// Rows and columns are stored densely, here and in every result.
void check_box(const std::array<std::int64_t, 3>& cells, const VdbReadOptions& options, const Place& where) {
  const auto [nx, ny, nz] = cells;
  const double faces =
      static_cast<double>(nx) * static_cast<double>(ny) + static_cast<double>(ny) * static_cast<double>(nz);
  const std::string found = fmt::format("a box of {} x {} x {} cells", nx, ny, nz);
  check_memory(16.0 * faces, options, where, found);
  for (const auto n : cells) {
    if (n > std::numeric_limits<std::int32_t>::max())
      where.fail("too large ({}; 2147483647 along an axis are allowed)", found);
  }
}

void check_metadata(const openvdb::GridBase& grid, const Placement& placement, const VdbReadOptions& options,
                    const Place& where) {
  if (grid.getGridClass() == openvdb::GRID_LEVEL_SET) {
    where.fail("is a level set (distances to a surface; densities are allowed) convert it to a fog volume");
  }
  if (const auto count = grid.getMetadata<openvdb::Int64Metadata>(openvdb::GridBase::META_FILE_VOXEL_COUNT)) {
    check_voxels(static_cast<double>(count->value()), options, where);
  }
  const auto low = grid.getMetadata<openvdb::Vec3IMetadata>(openvdb::GridBase::META_FILE_BBOX_MIN);
  const auto high = grid.getMetadata<openvdb::Vec3IMetadata>(openvdb::GridBase::META_FILE_BBOX_MAX);
  if (low && high) {
    std::array<std::int64_t, 3> cells{};
    for (int a = 0; a < 3; ++a) {
      const int axis = placement.axis[a];
      cells[a] = std::max<std::int64_t>(0, std::int64_t{high->value()[axis]} - low->value()[axis] + 1);
    }
    check_box(cells, options, where);
  }
}

/// Calls function(index, value) for every active voxel, tiles expanded.
template <class Function>
void for_each_active_voxel(const openvdb::FloatTree& tree, Function function) {
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) function(voxel.getCoord(), *voxel);
  }
  auto tile = tree.cbeginValueOn();
  tile.setMaxDepth(openvdb::FloatTree::ValueOnCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    const openvdb::CoordBBox box = tile.getBoundingBox();
    for (auto index = box.begin(); index; ++index) function(*index, *tile);
  }
}

std::vector<Voxel> collect(const openvdb::FloatGrid& grid, const Placement& placement, double scale,
                           const Place& where) {
  std::vector<Voxel> voxels;
  voxels.reserve(grid.activeVoxelCount());
  for_each_active_voxel(grid.tree(), [&](const openvdb::Coord& index, float stored) {
    const auto value = static_cast<float>(scale * static_cast<double>(stored));
    if (!std::isfinite(value) || value < 0) {
      where.fail("voxel ({}, {}, {}) has the value {}{} (finite numbers >= 0 are allowed)", index[0], index[1],
                 index[2], stored,
                 std::isfinite(stored) && stored >= 0 ? fmt::format(" times the scale {}", scale) : "");
    }
    if (value == 0) return;
    const auto cell = placement.cell(index);
    voxels.push_back(
        {{static_cast<std::int32_t>(cell[0]), static_cast<std::int32_t>(cell[1]), static_cast<std::int32_t>(cell[2])},
         value});
  });
  return voxels;
}

struct CellBox {
  std::array<std::int64_t, 3> first;
  std::array<std::int64_t, 3> end;  ///< one past the last

  std::array<std::int64_t, 3> cells() const { return {end[0] - first[0], end[1] - first[1], end[2] - first[2]}; }
};

CellBox bounding_box(const std::vector<Voxel>& voxels) {
  constexpr auto lowest = std::numeric_limits<std::int64_t>::min();
  constexpr auto highest = std::numeric_limits<std::int64_t>::max();
  CellBox box{{highest, highest, highest}, {lowest, lowest, lowest}};
  for (const auto& voxel : voxels) {
    for (int a = 0; a < 3; ++a) {
      box.first[a] = std::min<std::int64_t>(box.first[a], voxel.cell[a]);
      box.end[a] = std::max<std::int64_t>(box.end[a], voxel.cell[a] + std::int64_t{1});
    }
  }
  return box;
}

/// Counting sort by row, then each row by i: rows are short and come almost sorted.
void fill_rows(CloudField& field, const std::vector<Voxel>& voxels, const CellBox& box) {
  const auto ny = static_cast<std::size_t>(field.cells[1]);
  const auto row_of = [&](const Voxel& voxel) {
    return static_cast<std::size_t>(voxel.cell[2] - box.first[2]) * ny +
           static_cast<std::size_t>(voxel.cell[1] - box.first[1]);
  };
  std::vector<std::size_t> begin(ny * static_cast<std::size_t>(field.cells[2]) + 1, 0);
  for (const auto& voxel : voxels) ++begin[row_of(voxel) + 1];
  for (std::size_t row = 1; row < begin.size(); ++row) begin[row] += begin[row - 1];

  std::vector<std::pair<std::int32_t, float>> sorted(voxels.size());
  auto next = begin;
  for (const auto& voxel : voxels)
    sorted[next[row_of(voxel)]++] = {static_cast<std::int32_t>(voxel.cell[0] - box.first[0]), voxel.value};

  RowSpanWriter rows(field);
  for (std::size_t row = 0; row + 1 < begin.size(); ++row) {
    const auto first = sorted.begin() + static_cast<std::ptrdiff_t>(begin[row]);
    const auto last = sorted.begin() + static_cast<std::ptrdiff_t>(begin[row + 1]);
    std::sort(first, last, [](const auto& a, const auto& b) { return a.first < b.first; });
    for (auto voxel = first; voxel != last; ++voxel) rows.add(voxel->first, voxel->second);
    rows.end_row();
  }
}

std::string text_metadata(const openvdb::GridBase& grid, const char* name) {
  const auto item = grid.getMetadata<openvdb::StringMetadata>(name);
  return item ? item->value() : "";
}

CloudField read_cloud(const std::filesystem::path& path, const VdbReadOptions& options) {
  const Place where{path, options.grid};
  VdbInput input(path, options.grid);
  const auto& entry = input.find(options.grid);
  const Placement placement = place(entry.grid->transform(), options, where);
  check_metadata(*entry.grid, placement, options, where);
  const auto domain = metadata_domain(*entry.grid, placement, where);

  auto grid = input.load(entry);
  check_voxels(static_cast<double>(grid->activeVoxelCount()), options, where);
  const auto voxels = collect(*grid, placement, options.scale, where);
  grid.reset();
  if (voxels.empty()) where.fail("is empty (no active voxel has a value > 0)");

  CellBox box = bounding_box(voxels);
  if (domain) {
    const CellBox cloud = box;
    for (int a = 0; a < 3; ++a) {
      box.first[a] = nearest_face(placement, a, domain->min_m[a], where);
      box.end[a] = nearest_face(placement, a, domain->max_m[a], where);
      if (box.first[a] > cloud.first[a] || box.end[a] < cloud.end[a]) {
        where.fail(
            "the domain of the metadata does not contain the cloud (along {} the cloud reaches from {:.10g} to {:.10g} "
            "m, the domain "
            "from {:.10g} to {:.10g} m)",
            "xyz"[a], placement.lower_face(a, cloud.first[a]), placement.lower_face(a, cloud.end[a]), domain->min_m[a],
            domain->max_m[a]);
      }
    }
  }
  const auto cells = box.cells();
  check_box(cells, options, where);

  CloudField field;
  for (int a = 0; a < 3; ++a) {
    field.cells[a] = static_cast<int>(cells[a]);
    field.cell_size_m[a] = placement.size[a];
    field.min_m[a] = domain ? domain->min_m[a] : placement.lower_face(a, box.first[a]);
  }
  field.quantity = text_metadata(*entry.grid, "quantity");
  fill_rows(field, voxels, box);
  return field;
}

std::vector<float> read_companion(const std::filesystem::path& path, const CloudField& cloud,
                                  const VdbReadOptions& options, double lowest, double highest) {
  const Place where{path, options.grid};
  VdbInput input(path, options.grid);
  const auto& entry = input.find(options.grid);
  const Placement placement = place(entry.grid->transform(), options, where);
  std::array<std::int64_t, 3> first{};
  for (int a = 0; a < 3; ++a) {
    const double faces = placement.faces(a, cloud.min_m[a]);
    // Over all cells of the axis the sizes may drift apart by face_tolerance.
    const double drift = std::abs(placement.size[a] / cloud.cell_size_m[a] - 1) * cloud.cells[a];
    if (!(drift <= face_tolerance) || !(std::abs(faces - std::nearbyint(faces)) <= face_tolerance) ||
        !(std::abs(faces) < 2e9)) {
      where.fail(
          "its voxels are not those of the cloud (along {} size {:.10g} m, a face at {:.10g} m; the cloud has {:.10g} "
          "and {:.10g} m)",
          "xyz"[a], placement.size[a], placement.lower_face(a, 0), cloud.cell_size_m[a], cloud.min_m[a]);
    }
    first[a] = static_cast<std::int64_t>(std::nearbyint(faces));
  }

  const auto grid = input.load(entry);
  const auto accessor = grid->getConstAccessor();
  const bool background_counts = grid->background() != 0;
  std::vector<float> values;
  values.reserve(cloud.active_voxels());
  const std::int64_t ny = cloud.cells[1];
  for (std::int64_t row = 0; row < ny * cloud.cells[2]; ++row) {
    for (auto s = cloud.row_begin[row]; s < cloud.row_begin[row + 1]; ++s) {
      const auto& span = cloud.spans[s];
      for (std::int32_t i = span.i; i < span.i + span.n; ++i) {
        const auto index = placement.index({first[0] + i, first[1] + row % ny, first[2] + row / ny});
        float stored = 0;
        const bool active = accessor.probeValue(index, stored);
        if (!active && !(background_counts && stored == grid->background())) {
          where.fail("voxel ({}, {}, {}) has no value (the cloud has one there, and the background is {})", index[0],
                     index[1], index[2], grid->background());
        }
        const double value = options.scale * static_cast<double>(stored);
        if (!(value >= lowest && value <= highest)) {
          where.fail("voxel ({}, {}, {}) has the value {} ({} to {} are allowed)", index[0], index[1], index[2], value,
                     lowest, highest);
        }
        values.push_back(static_cast<float>(value));
      }
    }
  }
  return values;
}

/// Some damaged files make OpenVDB overflow its heap, spin or ask for all memory: the file is first parsed in a child
/// process. OpenVDB works on one thread here and there: a child inherits no others, and would wait for them.
template <class Parse, class Read>
auto after_parsing(const std::filesystem::path& path, Parse parse, Read read) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);
  // A grid of constant leaves takes 30 MB for each megabyte of the file; then something to spare.
  rehearse(path, {.library = "OpenVDB", .memory_bytes = 64 * (error ? 0 : bytes) + 512000000}, parse);
  return read();
}

template <class Read>
auto after_parsing_grid(const std::filesystem::path& path, const std::string& grid, Read read) {
  const auto parse = [&] {
    VdbInput input(path, grid);
    input.load(input.find(grid));
  };
  return after_parsing(path, parse, read);
}

std::vector<VdbGridInfo> grids_of(const VdbInput& input) {
  std::vector<VdbGridInfo> grids;
  for (const auto& entry : input.entries()) {
    grids.push_back({.name = entry.name,
                     .type = entry.type,
                     .quantity = text_metadata(*entry.grid, "quantity"),
                     .units = text_metadata(*entry.grid, "units"),
                     .cloud = std::nullopt,
                     .reason = {}});
  }
  return grids;
}

CloudField read_cloud_safely(const std::filesystem::path& path, const VdbReadOptions& options) {
  check_options(options);
  return after_parsing_grid(path, options.grid, [&] { return read_cloud(path, options); });
}

std::vector<float> read_companion_safely(const std::filesystem::path& path, const CloudField& cloud,
                                         const VdbReadOptions& options, double lowest, double highest) {
  check_options(options);
  return after_parsing_grid(path, options.grid, [&] { return read_companion(path, cloud, options, lowest, highest); });
}

std::vector<VdbGridInfo> list_grids_safely(const std::filesystem::path& path) {
  const auto list = [&] { return grids_of(VdbInput(path, "")); };
  return after_parsing(path, list, list);
}

}  // namespace

}  // namespace cloudbow

const cloudbow::VdbModule cloudbow_vdb_module = {cloudbow::read_cloud_safely, cloudbow::read_companion_safely,
                                                 cloudbow::list_grids_safely, cloudbow::vdb::write_cloud,
                                                 cloudbow::vdb::write_fields};

#include "vdb_read.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "cloudbow/core/available_memory.hpp"
#include "cloudbow/core/error.hpp"
#include "row_spans.hpp"
#include "vdb_placement.hpp"

namespace cloudbow {

namespace {

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
  for (const double size : options.voxel_size_m.value_or(std::array<double, 3>{1, 1, 1})) {
    if (!(size > 0) || !std::isfinite(size)) {
      throw InputError(fmt::format("voxel_size_m: out of range ({} found, finite numbers > 0 are allowed)", size));
    }
  }
  if (options.up_axis != "x" && options.up_axis != "y" && options.up_axis != "z") {
    throw InputError(
        fmt::format("up_axis: unknown axis (\"{}\" found, \"x\", \"y\" and \"z\" are allowed)", options.up_axis));
  }
}

void check_memory(double bytes, std::uint64_t limit, const Place& where, const std::string& found) {
  if (bytes > static_cast<double>(limit)) {
    where.fail(
        "too large ({}: {:.3g} GB to read, {:.3g} GB are allowed); clip or coarsen the grid (vdb_tool -clip, "
        "-resample); single voxels far away make a large box",
        found, bytes * 1e-9, static_cast<double>(limit) * 1e-9);
  }
}

// In the tree 4 and its share of the leaf, in the list of voxels 16, in the rows 8, in the field 4.
constexpr double bytes_per_voxel = 40;

void check_voxels(double voxels, std::uint64_t limit, const Place& where) {
  const std::string found = fmt::format("{:.0f} active voxels", voxels);
  check_memory(bytes_per_voxel * voxels, limit, where, found);
  if (voxels > std::numeric_limits<std::uint32_t>::max()) where.fail("too large ({}; 4294967295 are allowed)", found);
}

// Rows and columns are stored densely, here and in every result.
void check_box(const std::array<std::int64_t, 3>& cells, std::uint64_t limit, const Place& where) {
  const auto [nx, ny, nz] = cells;
  const double faces =
      static_cast<double>(nx) * static_cast<double>(ny) + static_cast<double>(ny) * static_cast<double>(nz);
  const std::string found = fmt::format("a box of {} x {} x {} cells", nx, ny, nz);
  check_memory(16.0 * faces, limit, where, found);
  for (const auto n : cells) {
    if (n > std::numeric_limits<std::int32_t>::max())
      where.fail("too large ({}; 2147483647 along an axis are allowed)", found);
  }
}

void check_metadata(const VdbGridHeader& grid, const Placement& placement, std::uint64_t limit, const Place& where) {
  if (grid.is_level_set) {
    where.fail(
        "is a level set (distances to a surface; densities are allowed); make a fog volume of it, 0 outside to 1 "
        "inside, with OpenVDB's tool (vdb_tool -read {} -ls2fog -write fog.vdb) and set cloud.scale",
        where.path.string());
  }
  if (grid.voxel_count) check_voxels(static_cast<double>(*grid.voxel_count), limit, where);
  if (grid.first_voxel && grid.last_voxel) {
    std::array<std::int64_t, 3> cells{};
    for (int a = 0; a < 3; ++a) {
      const int axis = placement.axis[a];
      cells[a] = std::max<std::int64_t>(0, std::int64_t{(*grid.last_voxel)[axis]} - (*grid.first_voxel)[axis] + 1);
    }
    check_box(cells, limit, where);
  }
}

/// Negative numbers of this share of the largest are rounding of whoever wrote the grid.
constexpr double largest_rounding = 1e-5;

/// The voxels that make the cloud, and what is said about those that do not.
class VoxelCollector {
 public:
  VoxelCollector(const Placement& placement, double scale, const Place& where)
      : placement_(placement), scale_(scale), where_(where) {}

  void reserve(std::size_t voxels) { voxels_.reserve(voxels); }

  void add(const VdbIndex& index, float stored) {
    const auto value = static_cast<float>(scale_ * static_cast<double>(stored));
    if (!std::isfinite(value)) {
      where_.fail("voxel ({}, {}, {}) has the value {}{} (finite numbers >= 0 are allowed)", index[0], index[1],
                  index[2], stored, std::isfinite(stored) ? fmt::format(" times the scale {}", scale_) : "");
    }
    largest_ = std::max(largest_, value);
    if (value < 0) {
      ++negative_;
      if (value < least_) least_ = value, least_at_ = index;
    }
    if (value > 0) {
      const auto cell = placement_.cell(index);
      voxels_.push_back(
          {{static_cast<std::int32_t>(cell[0]), static_cast<std::int32_t>(cell[1]), static_cast<std::int32_t>(cell[2])},
           value});
    }
  }

  /// @throws InputError if numbers are negative by more than rounding.
  void check_negative() const {
    if (-static_cast<double>(least_) > largest_rounding * static_cast<double>(largest_)) {
      where_.fail(
          "voxel ({}, {}, {}) has the value {:.6g} (finite numbers >= 0 are allowed, and down to -{:g} of the largest, "
          "{:.6g}, "
          "which counts as 0); set it to 0 if it should be clear; distances to a surface are no densities",
          least_at_[0], least_at_[1], least_at_[2], static_cast<double>(least_) / scale_, largest_rounding,
          static_cast<double>(largest_) / scale_);
    }
  }

  void note_negative(std::vector<std::string>& notes) const {
    if (negative_ == 0) return;
    notes.push_back(where_.text("{} negative value{} down to {:.3g} count{} as 0 (the largest is {:.3g})", negative_,
                                negative_ == 1 ? "" : "s", static_cast<double>(least_) / scale_,
                                negative_ == 1 ? "s" : "", static_cast<double>(largest_) / scale_));
  }

  const std::vector<Voxel>& voxels() const { return voxels_; }

 private:
  const Placement& placement_;
  double scale_;
  const Place& where_;
  std::vector<Voxel> voxels_;
  float largest_ = 0;
  std::size_t negative_ = 0;
  float least_ = 0;
  VdbIndex least_at_{};
};

struct CellBox {
  std::array<std::int64_t, 3> first;
  std::array<std::int64_t, 3> end;  ///< one past the last

  std::array<std::int64_t, 3> cells() const { return {end[0] - first[0], end[1] - first[1], end[2] - first[2]}; }
  double volume() const {
    double product = 1;
    for (const auto n : cells()) product *= static_cast<double>(n);
    return product;
  }
};

CellBox box_of(const VdbDomain& domain, const Placement& placement, const char* whose, const Place& where) {
  CellBox box{};
  for (int a = 0; a < 3; ++a) {
    box.first[a] = nearest_face(placement, a, domain.min_m[a], whose, where);
    box.end[a] = nearest_face(placement, a, domain.max_m[a], whose, where);
    if (box.first[a] >= box.end[a]) {
      where.fail(
          "the domain of the {} is empty (found {:.10g} to {:.10g} m along {}, allowed an upper corner above the "
          "lower one)",
          whose, domain.min_m[a], domain.max_m[a], "xyz"[a]);
    }
  }
  return box;
}

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

std::string numbers(const std::array<double, 3>& n) {
  return fmt::format("[{:.10g}, {:.10g}, {:.10g}]", n[0], n[1], n[2]);
}

/// Cells that hold the background: those of the grid's own domain, else of the scene's, that are not active. The
/// background has no bounds of its own.
void add_background(const VdbGrid& grid, const std::optional<VdbDomain>& domain, const VdbReadOptions& options,
                    const Placement& placement, std::uint64_t limit, const Place& where, VoxelCollector& voxels) {
  if (!std::isfinite(grid.background)) {
    where.fail("the background is {} (a finite number is allowed); give the grid the background 0", grid.background);
  }
  if (!domain && !options.domain_m) {
    std::string box;
    if (const auto active = active_box(grid)) {
      const auto low = placement.cell((*active)[0]), high = placement.cell((*active)[1]);
      VdbDomain of_active{};
      for (int a = 0; a < 3; ++a) {
        of_active.min_m[a] = placement.lower_face(a, std::min(low[a], high[a]));
        of_active.max_m[a] = placement.lower_face(a, std::max(low[a], high[a]) + 1);
      }
      box = fmt::format("; the active voxels lie in min_m = {}, max_m = {}", numbers(of_active.min_m),
                        numbers(of_active.max_m));
    }
    where.fail(
        "the background is {} and nothing says how far it reaches (found neither metadata domain_min_m, "
        "domain_max_m nor both corners in the scene's [domain], allowed a background of 0 or one of these); set "
        "[domain] min_m and max_m{}",
        grid.background, box);
  }
  const CellBox box = box_of(domain ? *domain : *options.domain_m, placement, domain ? "metadata" : "scene", where);
  check_voxels(box.volume(), limit, where);
  VdbLookup lookup(grid);
  for (auto k = box.first[2]; k < box.end[2]; ++k) {
    for (auto j = box.first[1]; j < box.end[1]; ++j) {
      for (auto i = box.first[0]; i < box.end[0]; ++i) {
        const VdbIndex index = placement.index({i, j, k});
        if (!lookup.at(index).is_active) voxels.add(index, grid.background);
      }
    }
  }
}

/// Values that are stored but not active count as the background: what renderers see there may be something else.
void note_inactive_values(const VdbGrid& grid, const Place& where, std::vector<std::string>& notes) {
  if (grid.inactive.voxels > 0) {
    notes.push_back(
        where.text("{} voxels that are not active hold other values than the background (such as {}); they "
                   "count as the background, {}",
                   grid.inactive.voxels, grid.inactive.example, grid.background));
  }
}

/// A single voxel far from all others makes a domain that is hardly intended.
void note_stray_voxels(const std::vector<Voxel>& voxels, const CellBox& box, const Placement& placement,
                       const Place& where, std::vector<std::string>& notes) {
  constexpr double sparse = 1e-3;       // cells of the box with a value
  constexpr double much_smaller = 0.1;  // the box without the stray voxels
  constexpr double few = 1e-3;          // of the sum of all values, on each side of each axis
  if (static_cast<double>(voxels.size()) > sparse * box.volume()) return;
  double sum = 0;
  for (const Voxel& voxel : voxels) sum += static_cast<double>(voxel.value);
  // The first plane before which, from either end, there is more than a trace.
  const auto first_with_more = [&](auto plane) {
    for (double before = 0; before + plane->second <= few * sum; ++plane) before += plane->second;
    return plane->first;
  };
  CellBox core = box;
  for (int a = 0; a < 3; ++a) {
    std::map<std::int32_t, double> of_plane;
    for (const Voxel& voxel : voxels) of_plane[voxel.cell[a]] += static_cast<double>(voxel.value);
    core.first[a] = first_with_more(of_plane.begin());
    core.end[a] = first_with_more(of_plane.rbegin()) + std::int64_t{1};
  }
  if (core.volume() > much_smaller * box.volume()) return;
  const auto stray = std::find_if(voxels.begin(), voxels.end(), [&](const Voxel& voxel) {
    for (int a = 0; a < 3; ++a) {
      if (voxel.cell[a] < core.first[a] || voxel.cell[a] >= core.end[a]) return true;
    }
    return false;
  });
  const auto index = placement.index({stray->cell[0], stray->cell[1], stray->cell[2]});
  const auto all = box.cells(), most = core.cells();
  notes.push_back(where.text(
      "nearly all of the cloud lies in {} x {} x {} cells; a few voxels far away, such as ({}, {}, {}) with the value "
      "{}, extend the domain to {} x {} x {}; clip the grid (vdb_tool -clip) if they are not meant",
      most[0], most[1], most[2], index[0], index[1], index[2], stray->value, all[0], all[1], all[2]));
}

}  // namespace

VdbCloud read_cloud(const VdbGridReader& reader, const std::filesystem::path& path, const VdbReadOptions& options) {
  check_options(options);
  const std::uint64_t limit = memory_limit(options);
  const Place where{path, options.grid};
  std::optional<Placement> placed;
  std::optional<VdbDomain> domain;
  VdbGridChecks checks;
  checks.header = [&](const VdbGridHeader& header) {
    placed = place(header, options, where);
    check_metadata(header, *placed, limit, where);
    domain = metadata_domain(header, *placed, where);
  };
  checks.voxels = [&](double active_voxels) { check_voxels(active_voxels, limit, where); };

  VdbGrid grid = reader(path, options.grid, limit, checks);
  const Placement placement = placed.value();
  VdbCloud field;
  VoxelCollector collector(placement, options.scale, where);
  collector.reserve(grid.active_voxels());
  for_each_active_voxel(grid, [&](const VdbIndex& index, float stored) { collector.add(index, stored); });
  collector.check_negative();
  const bool has_background = !(grid.background == 0) && !options.ignores_background;
  if (has_background) add_background(grid, domain, options, placement, limit, where, collector);
  collector.check_negative();
  collector.note_negative(field.notes);
  note_inactive_values(grid, where, field.notes);
  const VdbGridHeader header = std::move(grid.header);
  grid = {};
  const std::vector<Voxel>& voxels = collector.voxels();
  if (voxels.empty()) {
    where.fail("is empty (no {}voxel has a value > 0{})", has_background ? "" : "active ",
               options.scale == 1 ? "" : fmt::format(" after the scale {}", options.scale));
  }

  CellBox box = bounding_box(voxels);
  if (domain) {
    const CellBox cloud = box;
    box = box_of(*domain, placement, "metadata", where);
    for (int a = 0; a < 3; ++a) {
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
  check_box(cells, limit, where);
  if (!domain) note_stray_voxels(voxels, box, placement, where, field.notes);

  for (int a = 0; a < 3; ++a) {
    field.cells[a] = static_cast<int>(cells[a]);
    field.cell_size_m[a] = placement.size[a];
    field.min_m[a] = domain ? domain->min_m[a] : placement.lower_face(a, box.first[a]);
  }
  field.quantity = header.quantity;
  field.units = header.units;
  fill_rows(field, voxels, box);
  return field;
}

namespace {

/// Index of the cloud's first cell in the grid of this placement. @throws InputError unless their voxels coincide.
std::array<std::int64_t, 3> first_cell(const Placement& placement, const CloudField& cloud, const Place& where) {
  std::array<std::int64_t, 3> first{};
  for (int a = 0; a < 3; ++a) {
    const double faces = placement.faces(a, cloud.min_m[a]);
    // Over all cells of the axis the sizes may drift apart by face_tolerance.
    const double drift = std::abs(placement.size[a] / cloud.cell_size_m[a] - 1) * cloud.cells[a];
    if (!(drift <= face_tolerance) || !(std::abs(faces - std::nearbyint(faces)) <= face_tolerance) ||
        !(std::abs(faces) < 2e9)) {
      where.fail(
          "its voxels are not those of the cloud (along {} size {:.10g} m, a face at {:.10g} m; the cloud has {:.10g} "
          "and {:.10g} m) resample it to the voxels of the cloud (OpenVDB's tools::resampleToMatch with PointSampler, "
          "vdb_tool -resample), or give one value in the scene",
          "xyz"[a], placement.size[a], placement.lower_face(a, 0), cloud.cell_size_m[a], cloud.min_m[a]);
    }
    first[a] = static_cast<std::int64_t>(std::nearbyint(faces));
  }
  return first;
}

}  // namespace

std::vector<float> read_auxiliary(const VdbGridReader& reader, const std::filesystem::path& path,
                                  const CloudField& cloud, const VdbReadOptions& options, double lowest,
                                  double highest) {
  check_options(options);
  const Place where{path, options.grid};
  std::optional<Placement> placed;
  std::array<std::int64_t, 3> first{};
  VdbGridChecks checks;
  checks.header = [&](const VdbGridHeader& header) {
    if (!options.auxiliary_quantity.empty() && !header.quantity.empty() &&
        header.quantity != options.auxiliary_quantity) {
      where.fail(
          "holds something else by its metadata (found the quantity {}, allowed {}); name the grid that holds it",
          header.quantity, options.auxiliary_quantity);
    }
    placed = place(header, options, where);
    first = first_cell(*placed, cloud, where);
  };
  checks.voxels = [](double) {};

  const VdbGrid grid = reader(path, options.grid, memory_limit(options), checks);
  const Placement placement = placed.value();
  VdbLookup lookup(grid);
  const bool background_counts = grid.background != 0 && !std::isnan(grid.background);
  std::vector<float> values;
  values.reserve(cloud.active_voxels());
  const std::int64_t ny = cloud.cells[1];
  for (std::int64_t row = 0; row < ny * cloud.cells[2]; ++row) {
    for (auto s = cloud.row_begin[row]; s < cloud.row_begin[row + 1]; ++s) {
      const auto& span = cloud.spans[s];
      for (std::int32_t i = span.i; i < span.i + span.n; ++i) {
        const auto index = placement.index({first[0] + i, first[1] + row % ny, first[2] + row / ny});
        const auto found = lookup.at(index);
        if (!found.is_active && !(background_counts && found.is_background)) {
          where.fail(
              "voxel ({}, {}, {}) has no value (the cloud has one there, and the background is {}) give it one, or "
              "the grid a background that holds elsewhere",
              index[0], index[1], index[2], grid.background);
        }
        const float stored = found.is_active ? found.value : grid.background;
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

}  // namespace cloudbow

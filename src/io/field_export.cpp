#include "cloudbow/io/field_export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <span>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/output_files.hpp"
#include "cloudbow/core/sandbox.hpp"
#include "cloudbow/medium/vdb_file.hpp"
#include "io/result_input.hpp"

namespace cloudbow {

namespace {

constexpr double face_tolerance = 1e-3;  // of a voxel's height
constexpr std::uint32_t no_voxel = std::numeric_limits<std::uint32_t>::max();

bool even(const BoxGrid& box) {
  const double height = (box.z_edge_m.back() - box.z_edge_m.front()) / box.nz();
  for (int k = 0; k < box.nz(); ++k) {
    if (!(std::abs(box.z_edge_m[k] - (box.z_edge_m.front() + k * height)) <= face_tolerance * height)) return false;
  }
  return true;
}

/// All levels as planes of voxels if they are even, else those of the cloud.
VoxelPlanes exported_planes(const std::string& file, const BoxGrid& box) {
  if (even(box)) return {box.nz(), box.z_edge_m.front(), (box.z_edge_m.back() - box.z_edge_m.front()) / box.nz()};
  if (box.cloud.count > 0) return box.cloud;
  int thinnest = 0, thickest = 0;
  for (int k = 1; k < box.nz(); ++k) {
    if (box.thickness_m(k) < box.thickness_m(thinnest)) thinnest = k;
    if (box.thickness_m(k) > box.thickness_m(thickest)) thickest = k;
  }
  throw InputError(fmt::format(
      "{}: its levels are uneven and it has no cloud (found {:.4g} m at z = {:.6g} m, {:.4g} m at z = "
      "{:.6g} m, allowed levels of one height, as voxels have; domain.vertical_cells makes them "
      "so in a scene of one layer)",
      file, box.thickness_m(thinnest), box.z_edge_m[thinnest], box.thickness_m(thickest), box.z_edge_m[thickest]));
}

VdbBox voxel_box(const BoxGrid& box, const VoxelPlanes& planes) {
  return {{box.nx, box.ny, planes.count},
          {box.dx_m, box.dy_m, planes.height_m},
          {box.x_min_m, box.y_min_m, planes.bottom_m}};
}

/// The voxel plane that each level is part of; -1 outside.
std::vector<int> plane_of_level(const std::string& file, const BoxGrid& box, const VoxelPlanes& planes) {
  std::vector<int> plane;
  for (int k = 0; k < box.nz(); ++k) {
    const double low = (box.z_edge_m[k] - planes.bottom_m) / planes.height_m;
    const double high = (box.z_edge_m[k + 1] - planes.bottom_m) / planes.height_m;
    const double at = std::floor(0.5 * (low + high));
    if (!(at >= 0 && at < planes.count)) {
      plane.push_back(-1);
      continue;
    }
    if (low < at - face_tolerance || high > at + 1 + face_tolerance) {
      throw InputError(fmt::format("{}: z_edge does not fit the cloud's voxels (found a level from {} m to {} m)", file,
                                   box.z_edge_m[k], box.z_edge_m[k + 1]));
    }
    plane.push_back(static_cast<int>(at));
  }
  return plane;
}

/// Cells of a result as voxels of the box that is exported. A voxel has one cell, or several one above the other.
class Voxels {
 public:
  Voxels(std::span<const CellIndex> cells, const BoxGrid& box, const std::vector<int>& plane_of_level, int planes) {
    std::vector<std::uint32_t> voxel_at(box.columns() * static_cast<std::size_t>(planes), no_voxel);
    for (const auto& [i, j, k] : cells) {
      const int plane = plane_of_level[k];
      thickness_.push_back(plane < 0 ? 0 : box.thickness_m(k));
      voxel_of_cell_.push_back(no_voxel);
      if (plane < 0) continue;
      std::uint32_t& voxel = voxel_at[(static_cast<std::size_t>(plane) * box.ny + j) * box.nx + i];
      if (voxel == no_voxel) {
        voxel = static_cast<std::uint32_t>(index_.size());
        index_.push_back({i, j, plane});
        height_.push_back(0);
      }
      voxel_of_cell_.back() = voxel;
      height_[voxel] += thickness_.back();
    }
  }

  std::span<const CellIndex> index() const { return index_; }

  std::vector<float> means(std::span<const float> of_cells) const {
    std::vector<double> sum(index_.size(), 0);
    for (std::size_t c = 0; c < of_cells.size(); ++c) {
      if (voxel_of_cell_[c] != no_voxel) sum[voxel_of_cell_[c]] += thickness_[c] * static_cast<double>(of_cells[c]);
    }
    std::vector<float> mean(sum.size());
    for (std::size_t v = 0; v < sum.size(); ++v) mean[v] = static_cast<float>(sum[v] / height_[v]);
    return mean;
  }

 private:
  std::vector<CellIndex> index_;
  std::vector<double> height_;  // of the cells in each voxel
  std::vector<double> thickness_;
  std::vector<std::uint32_t> voxel_of_cell_;
};

/// The cells of a dense field that hold a value.
struct CellValues {
  std::vector<CellIndex> cell;
  std::vector<float> value;
};

CellValues values_of(const std::vector<float>& dense, const BoxGrid& box, bool zero_is_none) {
  CellValues values;
  for (std::size_t c = 0; c < dense.size(); ++c) {
    if (std::isnan(dense[c]) || (zero_is_none && dense[c] == 0)) continue;
    values.cell.push_back({static_cast<std::int32_t>(c % box.nx), static_cast<std::int32_t>(c / box.nx % box.ny),
                           static_cast<std::int32_t>(c / box.columns())});
    values.value.push_back(dense[c]);
  }
  return values;
}

std::array<double, 3> components(const Direction& d) { return {d.x(), d.y(), d.z()}; }

/// Grids to write, in order: each is made when its turn has come.
class Exporter {
 public:
  explicit Exporter(const FieldExportOptions& options)
      : options_(options),
        result_(options.result_file),
        planes_(exported_planes(options.result_file.string(), result_.box())),
        plane_of_level_(plane_of_level(options.result_file.string(), result_.box(), planes_)),
        box_(voxel_box(result_.box(), planes_)) {
    if (options.travel || options.all_directions) {
      radiance_.emplace(result_);
      voxels_.emplace(radiance_->cells(), result_.box(), plane_of_level_, planes_.count);
    }
    if (options.travel) {
      add("radiance", [this] { return radiance_along(options_.travel->stableNormalized()); });
    }
    if (options.all_directions) {
      for (std::size_t d = 0; d < radiance_->directions().size(); ++d) {
        add(fmt::format("radiance_{:03}", d), [this, d] { return radiance_at_point(d); });
      }
    }
    if (options.actinic) {
      add("actinic_flux", [this] { return cell_field("actinic", "actinic_flux", "W m-2", false); });
    }
    if (options.absorption) {
      const char* const name = result_.has("net_absorbed_power") ? "net_absorbed_power" : "absorbed_power";
      add(name, [this, name] { return cell_field("absorption", name, "W m-3", true); });
    }
    if (options.heating_rate) {
      add("heating_rate", [this] { return cell_field("heating_rate", "heating_rate", "K s-1", true); });
    }
  }

  /// Reads all that write() will, and writes nothing.
  void read() {
    for (const Grid& grid : grids_) grid.make();
  }

  FieldExportReport write() {
    write_fields_vdb(options_.vdb_file, box_, grids_.size(), [this](std::size_t n) {
      VdbField field = grids_[n].make();
      field.grid = grids_[n].name;
      return field;
    });
    FieldExportReport report;
    for (const Grid& grid : grids_) report.grids.push_back(grid.name);
    report.voxels = box_.cells;
    report.voxel_size_m = box_.cell_size_m;
    report.min_m = box_.min_m;
    for (int a = 0; a < 3; ++a) report.max_m[a] = box_.min_m[a] + box_.cells[a] * box_.cell_size_m[a];
    report.whole_domain = even(result_.box());
    return report;
  }

 private:
  struct Grid {
    std::string name;
    std::function<VdbField()> make;
  };

  void add(std::string name, std::function<VdbField()> make) { grids_.push_back({std::move(name), std::move(make)}); }

  VdbField radiance_field(std::span<const float> of_cells, const Direction& travel) const {
    VdbField field;
    field.quantity = "radiance";
    field.units = result_.units("radiance_field/radiance", "W m-2 sr-1");
    field.direction = components(travel);
    field.voxel = voxels_->index();
    field.value = voxels_->means(of_cells);
    return field;
  }

  VdbField radiance_along(const Direction& travel) const {
    return radiance_field(radiance_->radiance(radiance_->stencil(travel)), travel);
  }

  /// The file holds cell by cell all directions: it is read once for as many of them as may be in memory.
  VdbField radiance_at_point(std::size_t d) {
    const std::size_t cells = radiance_->cells().size();
    if (d >= batch_end_) {
      const std::size_t room = options_.batch_bytes / std::max<std::size_t>(1, cells * sizeof(float));
      const std::size_t count = std::clamp<std::size_t>(room, 1, radiance_->directions().size() - d);
      std::vector<float>().swap(batch_);  // so that never two batches are in memory
      batch_ = radiance_->radiances(d, count);
      batch_begin_ = d;
      batch_end_ = d + count;
    }
    return radiance_field(std::span(batch_).subspan((d - batch_begin_) * cells, cells), radiance_->directions()[d]);
  }

  VdbField cell_field(const char* output_field, const char* variable, const char* units, bool zero_is_none) {
    const CellValues values = values_of(result_.cell_field(variable, output_field), result_.box(), zero_is_none);
    voxels_.emplace(values.cell, result_.box(), plane_of_level_, planes_.count);
    VdbField field;
    field.quantity = variable;
    field.units = result_.units(variable, units);
    field.voxel = voxels_->index();
    field.value = voxels_->means(values.value);
    return field;
  }

  const FieldExportOptions& options_;
  ResultInput result_;
  VoxelPlanes planes_;
  std::vector<int> plane_of_level_;
  VdbBox box_;
  std::vector<Grid> grids_;
  std::optional<RadianceFieldInput> radiance_;
  std::optional<Voxels> voxels_;  // of the field whose turn it is
  std::vector<float> batch_;
  std::size_t batch_begin_ = 0;
  std::size_t batch_end_ = 0;
};

void check_options(const FieldExportOptions& options) {
  assert(options.travel || options.all_directions || options.actinic || options.absorption || options.heating_rate);
  if (options.travel && !(options.travel->allFinite() && options.travel->stableNorm() > 0)) {
    const Direction& d = *options.travel;
    throw InputError(
        fmt::format("export: the direction has no length (found {} {} {}, allowed: three finite numbers that are not "
                    "all 0)",
                    d.x(), d.y(), d.z()));
  }
  check_outputs({{options.vdb_file, "the grids", OutputKind::vdb}}, std::span(&options.result_file, 1));
}

}  // namespace

FieldExportReport export_fields(const FieldExportOptions& options) {
  check_options(options);
  const auto reading = [&options](const auto& action) {
    try {
      Exporter exporter(options);
      return action(exporter);
    } catch (const hdf5::Error& error) {
      throw InputError(fmt::format("{}: can't be read as a result file of cloudbow run ({})",
                                   options.result_file.string(), error.what()));
    }
  };
  read_in_sandbox(options.result_file, {.library = "HDF5"}, [&] { reading([](Exporter& all) { all.read(); }); });
  return reading([](Exporter& all) { return all.write(); });
}

}  // namespace cloudbow

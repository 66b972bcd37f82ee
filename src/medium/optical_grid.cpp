#include "cloudbow/medium/optical_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "cloudbow/core/error.hpp"
#include "row_cursor.hpp"

namespace cloudbow {
namespace {

constexpr double merge_fraction = 1e-9;
constexpr double largest_layer_extinction = 1e36;  // 1/m: a hundred layers, one upon another, fit into 32 bits

/// A height at which optics may change. If edges merge, the lower rank gives the number: the domain's own corners, then
/// voxel faces, then layer edges.
struct Edge {
  double z;
  int rank;
};

std::vector<double> merge_edges(std::vector<Edge> edges, double tolerance) {
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.z < b.z; });
  std::vector<Edge> kept;
  for (const Edge& edge : edges) {
    if (kept.empty() || edge.z - kept.back().z > tolerance) {
      kept.push_back(edge);
    } else if (edge.rank < kept.back().rank) {
      kept.back() = edge;
    }
  }
  std::vector<double> z(kept.size());
  std::transform(kept.begin(), kept.end(), z.begin(), [](const Edge& edge) { return edge.z; });
  return z;
}

int nearest_edge(const std::vector<double>& edges, double z) {
  const auto above = std::lower_bound(edges.begin(), edges.end(), z);
  if (above == edges.begin()) return 0;
  if (above == edges.end()) return static_cast<int>(edges.size()) - 1;
  const auto index = static_cast<int>(above - edges.begin());
  return z - edges[index - 1] < edges[index] - z ? index - 1 : index;
}

/// The planes of a cloud that contain active voxels: its voxel faces become levels there.
struct CloudPlanes {
  const CloudField* cloud = nullptr;
  int first = 0;
  int end = 0;  // first == end: no plane

  explicit CloudPlanes(const CloudField* field) : cloud(field) {
    if (cloud == nullptr) return;
    end = cloud->cells[2];
    while (first < end && spans_before(first + 1) == 0) ++first;
    while (end > first && spans_before(end - 1) == cloud->spans.size()) --end;
  }

  std::uint32_t spans_before(int k) const {
    return cloud->row_begin[static_cast<std::size_t>(k) * static_cast<std::size_t>(cloud->cells[1])];
  }
  std::size_t active_voxels(int k) const {
    std::size_t voxels = 0;
    for (std::uint32_t s = spans_before(k); s < spans_before(k + 1); ++s) {
      voxels += static_cast<std::size_t>(cloud->spans[s].n);
    }
    return voxels;
  }
  double face_m(int k) const { return cloud->min_m[2] + k * cloud->cell_size_m[2]; }
  /// Plane that holds the height, or -1.
  int plane(double z) const {
    if (first == end || z < face_m(first) || z > face_m(end)) return -1;
    return std::clamp(static_cast<int>((z - cloud->min_m[2]) / cloud->cell_size_m[2]), first, end - 1);
  }
};

/// Coefficients of the layers alone between neighbouring edges.
struct LayerProfile {
  std::vector<double> absorption;               // [nz]
  std::vector<std::vector<double>> scattering;  // [p][nz]

  double scaled_extinction(int k, const std::vector<double>& forward_fraction) const {
    double sum = absorption[k];
    for (std::size_t p = 0; p < scattering.size(); ++p) sum += (1 - forward_fraction[p]) * scattering[p][k];
    return sum;
  }

  bool empty(int k) const {
    return absorption[k] <= 0 &&
           std::all_of(scattering.begin(), scattering.end(), [k](const auto& of_phase) { return of_phase[k] <= 0; });
  }

  bool scatters(int k) const {
    return std::any_of(scattering.begin(), scattering.end(), [k](const auto& of_phase) { return of_phase[k] > 0; });
  }

  bool same_optics(int a, int b) const {
    const auto equal = [](double x, double y) { return std::abs(x - y) <= 1e-9 * std::max(x, y); };
    return equal(absorption[a], absorption[b]) &&
           std::all_of(scattering.begin(), scattering.end(),
                       [&](const auto& of_phase) { return equal(of_phase[a], of_phase[b]); });
  }
};

LayerProfile layer_profile(const std::vector<double>& edges, const std::vector<Layer>& layers, int phase_functions) {
  const std::size_t levels = edges.size() - 1;
  LayerProfile profile{std::vector<double>(levels, 0.0),
                       std::vector<std::vector<double>>(phase_functions, std::vector<double>(levels, 0.0))};
  for (const Layer& layer : layers) {
    const int first = nearest_edge(edges, layer.bottom_m);
    const int last = nearest_edge(edges, layer.top_m);
    if (layer.optical_depth <= 0) continue;
    if (last <= first) {
      throw InputError(fmt::format(
          "layer from {} m to {} m: too thin (found {} m, allowed at least {} m in this domain)", layer.bottom_m,
          layer.top_m, layer.top_m - layer.bottom_m, merge_fraction * (edges.back() - edges.front())));
    }
    // Over the merged edges, so that the layer keeps its optical depth.
    const double extinction = layer.optical_depth / (edges[last] - edges[first]);
    if (!(extinction <= largest_layer_extinction)) {
      throw InputError(
          fmt::format("layer from {} m to {} m: extinction too large (found {:.4g} 1/m, allowed up to {:g} 1/m) a "
                      "thicker layer, or "
                      "a smaller optical_depth",
                      layer.bottom_m, layer.top_m, extinction, largest_layer_extinction));
    }
    for (int k = first; k < last; ++k) {
      profile.absorption[k] += (1 - layer.single_scattering_albedo) * extinction;
      profile.scattering[layer.phase_function][k] += layer.single_scattering_albedo * extinction;
    }
  }
  return profile;
}

/// Counts graded levels through a stretch of uniform optics of total optical depth `depth`: count(s) grows by one per
/// level.
class Grading {
 public:
  Grading(const LevelOptions& options, double depth)
      : options_(options),
        depth_(depth),
        edge_end_((options.max_optical_depth - options.edge_optical_depth) / options.growth),
        deep_begin_(options.max_optical_depth / options.deep_growth),
        count_edge_(std::log1p(options.growth * edge_end_ / options.edge_optical_depth) / options.growth),
        count_middle_(count_edge_ + (deep_begin_ - edge_end_) / options.max_optical_depth),
        half_(from_edge(depth / 2)) {}

  double count(double s) const { return s <= depth_ / 2 ? from_edge(s) : 2 * half_ - from_edge(depth_ - s); }
  double position(double count) const {
    return count <= half_ ? distance(count) : depth_ - distance(2 * half_ - count);
  }

 private:
  /// Integral of dt / h(t) from an interface, and its inverse.
  double from_edge(double t) const {
    if (t <= edge_end_) return std::log1p(options_.growth * t / options_.edge_optical_depth) / options_.growth;
    if (t <= deep_begin_) return count_edge_ + (t - edge_end_) / options_.max_optical_depth;
    return count_middle_ + std::log(t / deep_begin_) / options_.deep_growth;
  }
  double distance(double count) const {
    if (count <= count_edge_)
      return options_.edge_optical_depth * std::expm1(options_.growth * count) / options_.growth;
    if (count <= count_middle_) return edge_end_ + (count - count_edge_) * options_.max_optical_depth;
    return deep_begin_ * std::exp(options_.deep_growth * (count - count_middle_));
  }

  LevelOptions options_;
  double depth_;
  double edge_end_;    // optical distance at which h has grown to max_optical_depth
  double deep_begin_;  // optical distance at which it grows again
  double count_edge_;
  double count_middle_;
  double half_;
};

/// No level thinner than what heights resolve.
/// @param depth optical, of as many metres as the stretch is far from height 0
LevelOptions resolved(LevelOptions options, double depth) {
  options.edge_optical_depth =
      std::max(options.edge_optical_depth, 64 * std::numeric_limits<double>::epsilon() * depth);
  options.max_optical_depth = std::max(options.max_optical_depth, options.edge_optical_depth);
  return options;
}

/// Edges inside (edges[k], edges[k+1]) for the levels k of one stretch [begin, end) of the same optics.
void cut_stretch(const std::vector<double>& edges, int begin, int end, double extinction, const LevelOptions& options,
                 std::vector<double>& out) {
  const double bottom = edges[begin];
  const double depth = extinction * (edges[end] - bottom);
  const Grading grading(resolved(options, extinction * std::max(std::abs(bottom), std::abs(edges[end]))), depth);
  const double total = grading.count(depth);
  const double refine = std::max(1.0, options.min_levels / total);
  // Thinner than one edge level: nothing to grade, equal levels.
  const bool uniform = depth <= options.edge_optical_depth;
  for (int k = begin; k < end; ++k) {
    out.push_back(edges[k]);
    const double thickness = edges[k + 1] - edges[k];
    if (options.layer_cells > 0 || uniform) {
      const double wanted =
          options.layer_cells > 0 ? options.layer_cells : options.min_levels * thickness / (edges[end] - bottom) - 1e-9;
      const int levels = std::max(1, static_cast<int>(std::ceil(wanted)));
      for (int level = 1; level < levels; ++level) out.push_back(edges[k] + thickness * level / levels);
      continue;
    }
    const double first = grading.count(extinction * (edges[k] - bottom));
    const double last = grading.count(extinction * (edges[k + 1] - bottom));
    const int levels = std::max(1, static_cast<int>(std::ceil(refine * (last - first) - 1e-9)));
    for (int level = 1; level < levels; ++level) {
      out.push_back(bottom + grading.position(first + (last - first) * level / levels) / extinction);
    }
  }
}

std::vector<double> make_levels(const CloudPlanes& cloud, const std::vector<Layer>& layers, double bottom, double top,
                                int phase_functions, const std::vector<double>& forward_fraction,
                                const LevelOptions& options) {
  if (!options.levels_m.empty()) return options.levels_m;
  const double tolerance = merge_fraction * (top - bottom);
  std::vector<Edge> edges{{bottom, 0}, {top, 0}};
  if (cloud.first < cloud.end) {
    for (int k = cloud.first; k <= cloud.end; ++k) edges.push_back({cloud.face_m(k), 1});
  }
  for (const double z : options.edges_m) edges.push_back({z, 2});
  for (const Layer& layer : layers) {
    if (layer.bottom_m < bottom - tolerance || layer.top_m > top + tolerance) {
      throw InputError(fmt::format("layer: reaches outside the domain (found {} m to {} m, allowed {} m to {} m)",
                                   layer.bottom_m, layer.top_m, bottom, top));
    }
    edges.push_back({layer.bottom_m, 2});
    edges.push_back({layer.top_m, 2});
  }
  const std::vector<double> merged = merge_edges(std::move(edges), tolerance);
  const LayerProfile profile = layer_profile(merged, layers, phase_functions);

  const auto in_cloud_box = [&](int k) { return cloud.plane((merged[k] + merged[k + 1]) / 2) >= 0; };
  std::vector<double> levels;
  const int count = static_cast<int>(merged.size()) - 1;
  for (int begin = 0; begin < count;) {
    int end = begin + 1;
    // Without scattering there is no source that changes with height. In columns of layers alone levels are output too.
    const bool has_source = profile.scatters(begin) || cloud.first == cloud.end;
    if (in_cloud_box(begin) || profile.empty(begin) || !has_source) {
      levels.push_back(merged[begin]);
    } else {
      while (end < count && !in_cloud_box(end) && profile.same_optics(begin, end)) ++end;
      cut_stretch(merged, begin, end, profile.scaled_extinction(begin, forward_fraction), options, levels);
    }
    begin = end;
  }
  levels.push_back(merged.back());
  return levels;
}

/// Throws if the grid would take more than the limit or its cells could not be counted.
void check_size(const BoxGrid& box, const LayerProfile& layers, const CloudPlanes& planes, int phase_functions,
                bool air_blocks, std::uint64_t limit_bytes) {
  double cells = 0;
  for (int k = 0; k < box.nz(); ++k) {
    const int plane = planes.plane((box.z_edge_m[k] + box.z_edge_m[k + 1]) / 2);
    const bool fills_rows = !layers.empty(k) && !air_blocks;
    cells += fills_rows   ? static_cast<double>(box.columns())
             : plane >= 0 ? static_cast<double>(planes.active_voxels(plane)) + 1
                          : 1.0;
  }
  // Blocks save coefficients. The solve looks up cells by voxel.
  const double places = air_blocks ? static_cast<double>(box.columns()) * box.nz() : 0;
  const double bytes = 4 * (cells * (1 + phase_functions) + places + static_cast<double>(box.nz()) * box.ny);
  if (bytes > static_cast<double>(limit_bytes)) {
    throw InputError(
        fmt::format("domain: does not fit into memory (found {} x {} columns, {} levels, {:.1f} GB for the "
                    "coefficients alone, allowed {:.1f} GB)",
                    box.nx, box.ny, box.nz(), bytes / 1e9, static_cast<double>(limit_bytes) / 1e9));
  }
  constexpr auto max_cells = static_cast<double>(std::numeric_limits<std::uint32_t>::max());
  if (cells > max_cells) {
    throw InputError(
        fmt::format("domain: too many cells with matter in them (found {:.4g}, allowed {:.4g})", cells, max_cells));
  }
}

constexpr int own_cells = -1;
constexpr int narrowest_block = 4;  // columns: blocks of 2 take as long as own cells

/// Of column fluxes, RMS over the columns / mean. Measured against own cells on four fields (docs/theory.md, "Layers in
/// blocks"): the pattern that a block loses is as wide, seen from the ground, as the block is.
double error_of_blocks(double depth, double distance_m, double width_m) {
  return depth * std::min(.1, .05 * width_m / distance_m);
}

/// Blocks of layers up to a height; own_cells columns: no blocks.
AirBlockWidth blocks_of_air(const LevelOptions& options, const BoxGrid& box, const LayerProfile& layers, double top_m,
                            const std::vector<double>& forward_fraction) {
  if (options.air == AirCells::of_voxels || box.columns() == 1) return {own_cells, 0};
  double depth = 0, height = 0;  // of the scattering, and its mean height
  bool any = false;
  for (int k = 0; k < box.nz(); ++k) {
    any = any || !layers.empty(k);
    const double thickness = std::clamp(top_m - box.z_edge_m[k], 0., box.thickness_m(k));
    for (std::size_t p = 0; p < layers.scattering.size(); ++p) {
      const double of_layer = (1 - forward_fraction[p]) * layers.scattering[p][k] * thickness;
      depth += of_layer;
      height += of_layer * (box.z_edge_m[k] + thickness / 2 - box.z_edge_m.front());
    }
  }
  if (!any) return {own_cells, 0};
  if (depth == 0) return {0, 0};
  height /= depth;
  const double distance_m = std::min(height, box.z_edge_m.back() - box.z_edge_m.front() - height);
  const double column_m = std::max(box.dx_m, box.dy_m);
  const AirBlockWidth width =
      air_block_width(depth, distance_m, column_m, std::max(box.nx, box.ny), options.largest_air_error);
  if (width.columns != 1) return width;
  if (options.air == AirCells::automatic) return {own_cells, 0};
  return {narrowest_block, error_of_blocks(depth, distance_m, narrowest_block * column_m)};
}

/// Fills one grid plane by plane, row by row.
class GridBuilder {
 public:
  GridBuilder(BoxGrid box, LayerProfile layers) {
    grid_.box = std::move(box);
    grid_.layer_absorption = std::move(layers.absorption);
    grid_.layer_scattering = std::move(layers.scattering);
    grid_.scattering.resize(grid_.layer_scattering.size());
    grid_.row_begin.push_back(0);
  }

  /// The row's cells take the layers' coefficients of level k.
  void add_span(int k, int i, int n) {
    const std::size_t offset = grid_.absorption.size();
    grid_.spans.push_back({i, n, static_cast<std::uint32_t>(offset)});
    take_layers(k, offset + n);
  }
  /// Set a coefficient of cell `index` to the sum of layers and cloud, added in double.
  void set_absorption(std::size_t index, int k, double cloud) {
    grid_.absorption[index] = checked_sum(grid_.layer_absorption[k], cloud);
  }
  void set_scattering(std::size_t index, int k, int phase, double cloud) {
    grid_.scattering[phase][index] = checked_sum(grid_.layer_scattering[phase][k], cloud);
  }
  void end_row() { grid_.row_begin.push_back(static_cast<std::uint32_t>(grid_.spans.size())); }
  /// After the last row of level k: its layers in blocks. @param filled whether any voxel is without cloud.
  /// @param columns width of a block; 0: one block
  void add_air(int k, bool filled, int columns) {
    AirBlocks air;
    if (filled) {
      const BoxGrid& box = grid_.box;
      const std::size_t offset = grid_.absorption.size();
      air.first_cell = static_cast<std::uint32_t>(offset);
      air.width_x = columns > 0 ? std::min(columns, box.nx) : box.nx;
      air.width_y = columns > 0 ? std::min(columns, box.ny) : box.ny;
      air.x = (box.nx + air.width_x - 1) / air.width_x;
      air.y = (box.ny + air.width_y - 1) / air.width_y;
      take_layers(k, offset + static_cast<std::size_t>(air.count()));
    }
    grid_.air.push_back(air);
  }

  OpticalGrid& grid() { return grid_; }

 private:
  void take_layers(int k, std::size_t cells) {
    grid_.absorption.resize(cells, static_cast<float>(grid_.layer_absorption[k]));
    for (std::size_t p = 0; p < grid_.scattering.size(); ++p)
      grid_.scattering[p].resize(cells, static_cast<float>(grid_.layer_scattering[p][k]));
  }
  static float checked_sum(double layers, double cloud) {
    const auto sum = static_cast<float>(layers + cloud);
    if (!std::isfinite(sum)) {
      throw InputError(fmt::format("cloud: extinction too large (found {} 1/m, allowed up to {} 1/m)", cloud,
                                   std::numeric_limits<float>::max()));
    }
    return sum;
  }

  OpticalGrid grid_;
};

/// Coefficients of single voxels: the sums over their constituents, voxel by voxel from left to right.
class VoxelMixer {
 public:
  VoxelMixer(const std::vector<CloudConstituent>& constituents, int phase_functions)
      : constituents_(constituents), rows_(constituents.size()), scattering_(phase_functions, 0.) {}

  void begin_row(int k, int j) {
    for (std::size_t c = 0; c < rows_.size(); ++c) rows_[c] = RowCursor(*constituents_[c].field, k, j);
  }
  /// Adds up what is in voxel i of the row.
  void mix(int i) {
    absorption_ = 0;
    for (const int phase : phases_) scattering_[phase] = 0;
    phases_.clear();
    for (std::size_t c = 0; c < rows_.size(); ++c) {
      if (const auto voxel = rows_[c].voxel(i)) add(*constituents_[c].field, *constituents_[c].optics, *voxel);
    }
  }
  double absorption() const { return absorption_; }
  /// The phase functions that scatter in the voxel; one may stand twice.
  const std::vector<int>& phases() const { return phases_; }
  double scattering(int phase) const { return scattering_[phase]; }

 private:
  void add(const CloudField& field, const CloudOptics& optics, std::size_t voxel) {
    const double extinction = field.value[voxel] * optics.extinction_per_value;
    const double ssa = optics.voxel_single_scattering_albedo.empty() ? optics.single_scattering_albedo
                                                                     : optics.voxel_single_scattering_albedo[voxel];
    const double scattering = ssa * extinction;
    absorption_ += (1 - ssa) * extinction;
    if (optics.voxel_phase_function.empty()) {
      add_scattering(optics.phase_function, scattering);
      return;
    }
    const int phase = optics.phase_function + optics.voxel_phase_function[voxel];
    const double next = optics.voxel_next_share[voxel] * scattering;
    add_scattering(phase, scattering - next);
    if (next > 0) add_scattering(phase + 1, next);
  }
  void add_scattering(int phase, double coefficient) {
    phases_.push_back(phase);
    scattering_[phase] += coefficient;
  }

  const std::vector<CloudConstituent>& constituents_;
  std::vector<RowCursor> rows_;     // [constituent]
  std::vector<double> scattering_;  // [p] 1/m
  std::vector<int> phases_;
  double absorption_ = 0;  // 1/m
};

}  // namespace

AirBlockWidth air_block_width(double depth, double distance_m, double column_m, int columns, double largest_error) {
  const double wanted = largest_error;
  const double whole = error_of_blocks(depth, distance_m, columns * column_m);
  if (whole <= wanted) return {0, whole};
  int width = narrowest_block;
  while (2 * width < columns && error_of_blocks(depth, distance_m, 2 * width * column_m) <= wanted) width *= 2;
  const double error = error_of_blocks(depth, distance_m, width * column_m);
  return error <= wanted ? AirBlockWidth{width, error} : AirBlockWidth{1, 0};
}

std::vector<double> finest_levels(const std::vector<std::vector<double>>& levels_m) {
  std::vector<double> common = levels_m.front();
  for (const auto& levels : levels_m) {
    std::erase_if(common, [&](double z) { return !std::binary_search(levels.begin(), levels.end(), z); });
  }
  std::vector<double> finest{common.front()};
  for (std::size_t n = 0; n + 1 < common.size(); ++n) {
    std::vector<double> chosen;
    for (const auto& levels : levels_m) {
      const auto first = std::upper_bound(levels.begin(), levels.end(), common[n]);
      const auto end = std::upper_bound(first, levels.end(), common[n + 1]);
      if (static_cast<std::size_t>(end - first) > chosen.size()) chosen.assign(first, end);
    }
    finest.insert(finest.end(), chosen.begin(), chosen.end());
  }
  return finest;
}

void mark_uniform_levels(OpticalGrid& grid) {
  grid.box.uniform.clear();
  const auto ny = static_cast<std::size_t>(grid.box.ny);
  for (std::size_t k = 0; k < static_cast<std::size_t>(grid.box.nz()); ++k) {
    const bool has_voxels = grid.row_begin[(k + 1) * ny] > grid.row_begin[k * ny];
    grid.box.uniform.push_back(!has_voxels && grid.air_of(static_cast<int>(k)).count() <= 1 ? 1 : 0);
  }
}

OpticalGrid layers_only(const OpticalGrid& grid) {
  BoxGrid box;
  box.z_edge_m = grid.box.z_edge_m;
  LayerProfile layers{grid.layer_absorption, grid.layer_scattering};
  GridBuilder builder(box, layers);
  for (int k = 0; k < box.nz(); ++k) {
    if (!layers.empty(k)) builder.add_span(k, 0, 1);
    builder.end_row();
  }
  OpticalGrid column = std::move(builder.grid());
  if (!grid.emits()) return column;
  column.layer_planck = grid.layer_planck;
  column.layer_planck_step = grid.layer_planck_step;
  column.for_each_place([&](int k, std::size_t, std::size_t) {
    column.planck.push_back(static_cast<float>(grid.layer_planck[k]));
    column.planck_step.push_back(static_cast<float>(grid.layer_planck_step[k]));
  });
  return column;
}

OpticalGrid make_optical_grid(const CloudField* cloud, const CloudOptics& cloud_optics,
                              const std::vector<Layer>& layers, const std::array<double, 3>& domain_min_m,
                              const std::array<double, 3>& domain_max_m, bool periodic, int phase_functions,
                              const std::vector<double>& delta_m_fraction, const LevelOptions& options) {
  CloudMatter clouds{cloud};
  if (cloud != nullptr) clouds.constituents = {{cloud, &cloud_optics}};
  return make_optical_grid(clouds, layers, domain_min_m, domain_max_m, periodic, phase_functions, delta_m_fraction,
                           options);
}

OpticalGrid make_optical_grid(const CloudMatter& clouds, const std::vector<Layer>& layers,
                              const std::array<double, 3>& domain_min_m, const std::array<double, 3>& domain_max_m,
                              bool periodic, int phase_functions, const std::vector<double>& delta_m_fraction,
                              const LevelOptions& options) {
  assert(static_cast<int>(delta_m_fraction.size()) == phase_functions);
  assert(domain_max_m[2] > domain_min_m[2]);

  const CloudField* const cloud = clouds.voxels;
  const CloudPlanes planes(cloud);
  BoxGrid box;
  box.periodic = periodic;
  int cloud_i = 0;
  int cloud_j = 0;
  if (cloud != nullptr) {
    const auto columns = [&](int axis) {
      return static_cast<int>(std::lround((domain_max_m[axis] - domain_min_m[axis]) / cloud->cell_size_m[axis]));
    };
    const auto offset = [&](int axis) {
      return static_cast<int>(std::lround((cloud->min_m[axis] - domain_min_m[axis]) / cloud->cell_size_m[axis]));
    };
    box.nx = columns(0);
    box.ny = columns(1);
    box.dx_m = cloud->cell_size_m[0];
    box.dy_m = cloud->cell_size_m[1];
    cloud_i = offset(0);
    cloud_j = offset(1);
    box.cloud = {planes.end - planes.first, planes.face_m(planes.first), cloud->cell_size_m[2]};
  }
  box.x_min_m = domain_min_m[0];
  box.y_min_m = domain_min_m[1];
  box.z_edge_m =
      make_levels(planes, layers, domain_min_m[2], domain_max_m[2], phase_functions, delta_m_fraction, options);

  const LayerProfile profile = layer_profile(box.z_edge_m, layers, phase_functions);
  // Further above the clouds than these are deep, their pattern hardly shows.
  const double patterned_to_m =
      planes.first < planes.end ? 2 * planes.face_m(planes.end) - planes.face_m(planes.first) : domain_min_m[2];
  const AirBlockWidth air = blocks_of_air(options, box, profile, patterned_to_m, delta_m_fraction);
  const bool air_blocks = air.columns != own_cells;
  check_size(box, profile, planes, phase_functions, air_blocks, options.memory_limit_bytes);
  GridBuilder builder(box, profile);
  OpticalGrid& grid = builder.grid();
  grid.air_error = air.error;
  VoxelMixer mixer(clouds.constituents, phase_functions);
  for (int k = 0; k < box.nz(); ++k) {
    const bool has_layers = !profile.empty(k);
    const bool fills_rows = has_layers && !air_blocks;
    const std::size_t level_start = grid.active_cells();
    const int cloud_k = planes.plane((box.z_edge_m[k] + box.z_edge_m[k + 1]) / 2);
    for (int j = 0; j < box.ny; ++j) {
      const std::size_t row_start = grid.active_cells();
      if (fills_rows) builder.add_span(k, 0, box.nx);
      if (cloud_k >= 0 && j >= cloud_j && j < cloud_j + cloud->cells[1]) {
        const std::size_t row = static_cast<std::size_t>(cloud_k) * cloud->cells[1] + (j - cloud_j);
        mixer.begin_row(cloud_k, j - cloud_j);
        for (std::uint32_t s = cloud->row_begin[row]; s < cloud->row_begin[row + 1]; ++s) {
          const RowSpan& span = cloud->spans[s];
          assert(span.i + cloud_i >= 0 && span.i + cloud_i + span.n <= box.nx);
          std::size_t cell = row_start + static_cast<std::size_t>(span.i + cloud_i);
          if (!fills_rows) {
            cell = grid.active_cells();
            builder.add_span(k, span.i + cloud_i, span.n);
          }
          for (int n = 0; n < span.n; ++n) {
            mixer.mix(span.i + n);
            builder.set_absorption(cell + n, k, mixer.absorption());
            for (const int phase : mixer.phases()) builder.set_scattering(cell + n, k, phase, mixer.scattering(phase));
          }
        }
      }
      builder.end_row();
    }
    if (air_blocks) {
      const bool filled = has_layers && grid.active_cells() - level_start < box.columns();
      builder.add_air(k, filled, box.z_edge_m[k] < patterned_to_m && profile.scatters(k) ? air.columns : 0);
    }
  }
  mark_uniform_levels(grid);
  return std::move(grid);
}

}  // namespace cloudbow

#include "cloudbow/app/assemble.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>

#include "app/assembly/gas_layers.hpp"
#include "app/assembly/open_clouds.hpp"
#include "app/assembly/thermal.hpp"
#include "app/process/cache_directory.hpp"
#include "app/scene/accuracy.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/albedo_map.hpp"
#include "cloudbow/optics/delta_m.hpp"
#include "cloudbow/sphere/travel.hpp"
#include "cloudbow/transport/solve_plan.hpp"
#include "cloudbow/transport/thick_cells.hpp"

namespace cloudbow {
namespace {

constexpr double max_columns_per_axis = 1e6;

struct Domain {
  std::array<double, 3> min_m{0, 0, 0};
  std::array<double, 3> max_m{1, 1, 1};
};

/// Corners given by the scene, moved onto the faces they are meant to lie on.
class DomainChecker {
 public:
  DomainChecker(const Scene& scene, const CloudField* field) : scene_(scene), field_(field) {
    if (field != nullptr) {
      summary_ = summarize(*field);
      for (int axis = 0; axis < 3; ++axis) {
        domain_.min_m[axis] = field->min_m[axis];
        domain_.max_m[axis] = field->max_m(axis);
      }
    } else {
      domain_.min_m[2] = scene.layers.front().bottom_m;
      domain_.max_m[2] = scene.layers.front().top_m;
    }
    for (const Layer& layer : scene.layers) {
      domain_.min_m[2] = std::min(domain_.min_m[2], layer.bottom_m);
      domain_.max_m[2] = std::max(domain_.max_m[2], layer.top_m);
    }
  }

  Domain check() {
    for (int axis = 0; axis < 3; ++axis) {
      if (field_ == nullptr && axis != 2) continue;  // a single column of any width
      if (scene_.domain.min_m) domain_.min_m[axis] = corner("domain.min_m", axis, (*scene_.domain.min_m)[axis]);
      if (scene_.domain.max_m) domain_.max_m[axis] = corner("domain.max_m", axis, (*scene_.domain.max_m)[axis]);
      check_order(axis);
      if (field_ != nullptr) check_contains_cloud(axis);
    }
    check_contains_layers();
    return domain_;
  }

 private:
  [[noreturn]] void fail(const std::string& key, int axis, const std::string& problem, double found,
                         const std::string& allowed) const {
    throw InputError(
        fmt::format("{}: {} in {} (found {} m, allowed {})", scene_.where(key), problem, "xyz"[axis], found, allowed));
  }

  double corner(const std::string& key, int axis, double value) const {
    if (field_ == nullptr) return value;
    const double origin = field_->min_m[axis];
    const double size = field_->cell_size_m[axis];
    const double faces = (value - origin) / size;
    if (lies_on_face(*field_, axis, value)) return onto_face(*field_, axis, value);
    if (axis == 2) {
      for (const Layer& layer : scene_.layers) {
        if (value == layer.bottom_m || value == layer.top_m) return value;
      }
    }
    fail(key, axis, axis == 2 ? "neither on a voxel face nor on a layer's edge" : "not on a voxel face", value,
         fmt::format("{} m or {} m, the nearest voxel faces", origin + std::floor(faces) * size,
                     origin + std::ceil(faces) * size));
  }

  void check_order(int axis) const {
    const double extent = domain_.max_m[axis] - domain_.min_m[axis];
    const std::string key = scene_.domain.max_m ? "domain.max_m" : "domain.min_m";
    if (extent <= 0) {
      const bool max_given = scene_.domain.max_m.has_value();
      fail(key, axis, max_given ? "not above the lower corner" : "not below the upper corner",
           max_given ? domain_.max_m[axis] : domain_.min_m[axis],
           max_given ? fmt::format("> {} m", domain_.min_m[axis]) : fmt::format("< {} m", domain_.max_m[axis]));
    }
    if (field_ != nullptr && axis != 2 && extent / field_->cell_size_m[axis] > max_columns_per_axis) {
      fail(key, axis, "too far away: more columns than any memory holds", domain_.max_m[axis],
           fmt::format("at most {} columns of {} m", max_columns_per_axis, field_->cell_size_m[axis]));
    }
  }

  void check_contains_cloud(int axis) const {
    const double slack = face_tolerance * field_->cell_size_m[axis];
    if (domain_.min_m[axis] > summary_.cloud_min_m[axis] + slack) {
      fail("domain.min_m", axis, "cuts the cloud", domain_.min_m[axis],
           fmt::format("at most {} m, the bottom of the cloud", summary_.cloud_min_m[axis]));
    }
    if (domain_.max_m[axis] < summary_.cloud_max_m[axis] - slack) {
      fail("domain.max_m", axis, "cuts the cloud", domain_.max_m[axis],
           fmt::format("at least {} m, the top of the cloud", summary_.cloud_max_m[axis]));
    }
  }

  void check_contains_layers() const {
    for (std::size_t n = 0; n < scene_.layers.size(); ++n) {
      const Layer& layer = scene_.layers[n];
      const auto outside = [&](const char* key, double found) {
        throw InputError(fmt::format("{}: outside the domain (found {} m, allowed {} m to {} m, as [domain] says)",
                                     scene_.where(fmt::format("layer.{}.{}", n, key)), found, domain_.min_m[2],
                                     domain_.max_m[2]));
      };
      if (layer.bottom_m < domain_.min_m[2]) outside("bottom_m", layer.bottom_m);
      if (layer.top_m > domain_.max_m[2]) outside("top_m", layer.top_m);
    }
  }

  const Scene& scene_;
  const CloudField* field_;
  CloudSummary summary_;
  Domain domain_;
};

/// Diffuse light by columns under a slanted beam is known without its azimuths only.
void check_asks_no_azimuths(const Scene& scene) {
  const std::string found = scene.output.radiance_field               ? "output.fields radiance_field"
                            : !scene.radiances.empty()                ? "[[radiance]]"
                            : !scene.cameras.empty()                  ? "[[camera]]"
                            : scene.output.circumsolar_half_angle > 0 ? "output.circumsolar_deg"
                            : scene.surface.brdf                      ? "a surface that does not reflect evenly"
                                                                      : "";
  if (found.empty()) return;
  throw InputError(
      fmt::format("{}: 'independent-diffuse' computes fluxes, absorption and actinic flux over Lambertian ground alone "
                  "(found {}, allowed with it 'auto', '3d', 'independent-columns')",
                  scene.where("solver.mode"), found));
}

SolverOptions solver_options(const Scene& scene, HorizontalExtent extent) {
  const SceneSolver& solver = scene.solver;
  const bool measured =
      std::any_of(scene.clouds.begin(), scene.clouds.end(),
                  [](const SceneCloud& cloud) { return cloud.droplets != nullptr || cloud.phase_set != nullptr; }) ||
      std::any_of(scene.phase_functions.begin(), scene.phase_functions.end(), [](const auto& p) { return p.measured; });
  SolverOptions options = accuracy_options(solver.accuracy, extent, measured);
  if (solver.delta_m_order) {
    options.fit.beam_delta_m_order += *solver.delta_m_order - options.fit.delta_m_order;
    options.fit.delta_m_order = *solver.delta_m_order;
  }
  options.control_points = solver.control_points.value_or(options.control_points);
  options.directions = solver.directions.value_or(options.directions);
  options.fit.method = solver.fit.value_or(options.fit.method);
  options.fit.cache_directory = cache_directory();
  options.gather_directions = solver.gather_directions.value_or(options.gather_directions);
  options.beam_rays = solver.beam_rays.value_or(options.beam_rays);
  options.max_level_optical_depth = solver.max_level_optical_depth.value_or(options.max_level_optical_depth);
  options.max_column_optical_depth = solver.max_column_optical_depth.value_or(options.max_column_optical_depth);
  options.max_column_parts = solver.max_column_parts.value_or(options.max_column_parts);
  options.tolerance = solver.tolerance.value_or(options.tolerance);
  options.max_sweeps = solver.max_sweeps;
  options.half_precision_radiance = solver.half_precision_radiance;
  options.column_streams = solver.column_streams.value_or(options.column_streams);
  options.beam_crosses_columns = solver.mode == SolveMode::independent_diffuse;
  if (options.beam_crosses_columns) check_asks_no_azimuths(scene);
  options.independent_columns = solver.mode == SolveMode::independent_columns || options.beam_crosses_columns;
  options.collapse_uniform_axes = solver.mode != SolveMode::three_dimensional;
  const OutputOptions& output = scene.output;
  static_cast<OutputOptions&>(options) = output;
  options.absorption = output.absorption || scene.output.heating_rate;
  for (const SceneRadiance& radiance : scene.radiances) {
    const Direction to_sensor = -travel_from(radiance.zenith_deg, radiance.azimuth_deg);
    options.views.push_back({radiance.name, to_sensor, radiance.width, radiance.height});
  }
  options.cameras = scene.cameras;
  return options;
}

// Layers alone are one column. Their fluxes are computed without iteration, more exactly and faster. Settings that only
// the iteration has request the iteration. Uniform voxels must agree with slightly varying ones, so they are solved in
// the same way.
void solve_layers_without_iteration(const Scene& scene, const Problem& problem, SolverOptions& options) {
  const SceneSolver& solver = scene.solver;
  if (!scene.clouds.empty() || solver.mode != SolveMode::automatic || problem.grid.box.columns() > 1 ||
      solver.control_points || solver.directions || solver.delta_m_order || solver.fit)
    return;
  SolverOptions columns = options;
  columns.independent_columns = true;
  if (solved_by_polar_streams(problem, columns)) options = columns;
}

int nearest_edge(const std::vector<double>& edges, double z) {
  const auto nearest = std::min_element(edges.begin(), edges.end(),
                                        [z](double a, double b) { return std::abs(a - z) < std::abs(b - z); });
  return static_cast<int>(nearest - edges.begin());
}

void check_cameras(const Scene& scene, double ground_m) {
  for (std::size_t n = 0; n < scene.cameras.size(); ++n) {
    const double height = scene.cameras[n].position_m.z();
    if (height < ground_m) {
      throw InputError(fmt::format("{}: below the ground (found z = {} m, allowed at least {} m)",
                                   scene.where(fmt::format("camera.{}.position_m", n)), height, ground_m));
    }
  }
}

std::vector<float> albedo_of_columns(const Scene& scene, const BoxGrid& box, const Domain& domain) {
  try {
    const GroundMap map = read_albedo_map(scene.albedo_map);
    check_covers(map, scene.albedo_map, {domain.max_m[0] - domain.min_m[0], domain.max_m[1] - domain.min_m[1]});
    return area_means(map, box.nx, box.ny);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", scene.where("surface.albedo_map"), error.what()));
  }
}

/// By the columns of the domain. @param field null: layers alone.
HorizontalExtent horizontal_extent(const Domain& domain, const CloudField* field) {
  if (field == nullptr) return HorizontalExtent::column;
  const auto has_one = [&](int axis) {
    return std::lround((domain.max_m[axis] - domain.min_m[axis]) / field->cell_size_m[axis]) == 1;
  };
  if (has_one(0) && has_one(1)) return HorizontalExtent::column;
  return has_one(0) || has_one(1) ? HorizontalExtent::slice : HorizontalExtent::field;
}

/// Optical depths of the box's columns, which have faces in common with those of the constituents: 0 beside the clouds.
std::vector<float> optical_depth_of_columns(const OpenedClouds& clouds, const BoxGrid& box) {
  std::vector<double> sum(box.columns(), 0.);
  for (const OpenedCloud& cloud : clouds.constituents) {
    const ColumnDepths& depths = cloud.column_optical_depth;
    const auto [nx, ny] = depths.columns;
    const auto first_i = std::lround((depths.min_m[0] - box.x_min_m) / box.dx_m);
    const auto first_j = std::lround((depths.min_m[1] - box.y_min_m) / box.dy_m);
    for (long j = std::max(0L, first_j); j < std::min<long>(box.ny, first_j + ny); ++j) {
      for (long i = std::max(0L, first_i); i < std::min<long>(box.nx, first_i + nx); ++i)
        sum[static_cast<std::size_t>(j * box.nx + i)] +=
            depths.value[static_cast<std::size_t>((j - first_j) * nx + i - first_i)];
    }
  }
  return {sum.begin(), sum.end()};
}

/// Extinction of the box's cells, whose levels may be parts of planes of voxels: 0 beside the clouds.
std::vector<float> extinction_of_cells(const OpenedClouds& clouds, const BoxGrid& box) {
  std::vector<float> sum(box.columns() * static_cast<std::size_t>(box.nz()), 0.F);
  for (const OpenedCloud& cloud : clouds.constituents) {
    const CloudField& field = cloud.field;
    const auto first_i = std::lround((field.min_m[0] - box.x_min_m) / box.dx_m);
    const auto first_j = std::lround((field.min_m[1] - box.y_min_m) / box.dy_m);
    for (int level = 0; level < box.nz(); ++level) {
      const double middle = (box.z_edge_m[level] + box.z_edge_m[level + 1]) / 2;
      const double plane = std::floor((middle - field.min_m[2]) / field.cell_size_m[2]);
      if (plane < 0 || plane >= field.cells[2]) continue;
      for (long j = std::max(0L, first_j); j < std::min<long>(box.ny, first_j + field.cells[1]); ++j) {
        const auto row = static_cast<std::size_t>(plane) * field.cells[1] + static_cast<std::size_t>(j - first_j);
        float* const to = sum.data() + box.columns() * level + static_cast<std::size_t>(j) * box.nx;
        for (std::uint32_t s = field.row_begin[row]; s < field.row_begin[row + 1]; ++s) {
          const RowSpan& span = field.spans[s];
          for (int n = 0; n < span.n; ++n) {
            const long i = first_i + span.i + n;
            if (i >= 0 && i < box.nx) to[i] += cloud.extinction[span.offset + n];
          }
        }
      }
    }
  }
  return sum;
}

}  // namespace

AssembledScene assemble(const Scene& scene, std::uint64_t memory_limit_bytes) {
  CloudFiles files(false);
  return assemble(scene, memory_limit_bytes, files, {});
}

AssembledScene assemble(const Scene& given, std::uint64_t memory_limit_bytes, CloudFiles& files,
                        const std::vector<double>& levels_m) {
  const OpenedClouds clouds = open_clouds(given, files);
  const CloudField* const field = clouds.field();
  std::optional<Scene> with_gas;
  if (given.broadband) {
    with_gas = given;
    add_gas_layers(field, *with_gas);
  }
  const Scene& scene = with_gas ? *with_gas : given;
  const Domain domain = DomainChecker(scene, field).check();
  for (const double height : scene.output.heights_m) {
    if (height < domain.min_m[2] || height > domain.max_m[2]) {
      throw InputError(fmt::format("{}: outside the domain (found {} m, allowed {} m to {} m)",
                                   scene.where("output.flux_levels"), height, domain.min_m[2], domain.max_m[2]));
    }
  }

  check_cameras(scene, domain.min_m[2]);

  AssembledScene assembled;
  Problem& problem = assembled.problem;
  for (const ScenePhaseFunction& phase : scene.phase_functions) problem.phase.push_back(phase.function);
  for (const OpenedCloud& cloud : clouds.constituents) {
    problem.phase.insert(problem.phase.end(), cloud.varying_phase.begin(), cloud.varying_phase.end());
    assembled.clouds.push_back(cloud.figures);
  }
  assembled.phase_classes = clouds.phase_classes;
  if (scene.sun)
    problem.sun = Sun{travel_from(scene.sun->zenith_deg, scene.sun->azimuth_deg), scene.sun->irradiance_w_m2};
  problem.sky_radiance = scene.sky_radiance;
  problem.surface = scene.surface;

  const HorizontalExtent extent = horizontal_extent(domain, field);
  assembled.options = solver_options(scene, extent);
  assembled.one_column = extent == HorizontalExtent::column;

  std::vector<double> forward_fraction;
  for (const PhaseFunction& phase : problem.phase) {
    forward_fraction.push_back(delta_m(phase, assembled.options.fit.delta_m_order).forward_fraction);
  }
  LevelOptions levels = field == nullptr ? LevelOptions::layers_only() : LevelOptions{};
  levels.layer_cells = scene.domain.vertical_cells;
  levels.air = scene.solver.air;
  if (scene.broadband) levels.largest_air_error = scene.broadband->largest_air_error;
  if (scene.broadband) {
    // The layers of air are thin, and their levels the same at all g-points, whatever the optics.
    constexpr double any_depth = 1e30;
    levels.edge_optical_depth = levels.max_optical_depth = any_depth;
    levels.min_levels = 1;
    // Narrow blocks rather than cells: g-points of short waves, whose air scatters much, have a small share of the
    // light.
    if (levels.air == AirCells::automatic) levels.air = AirCells::in_blocks;
  }
  levels.edges_m = scene.output.heights_m;
  const std::array<double, 2> z_m{domain.min_m[2], domain.max_m[2]};
  const std::vector<double> of_emission = emission_levels(scene, field, z_m);
  levels.edges_m.insert(levels.edges_m.end(), of_emission.begin(), of_emission.end());
  if (scene.atmosphere && (scene.thermal || scene.output.heating_rate)) {
    if (const auto doubt = doubt_atmosphere(scene, z_m)) files.note(*doubt);
  }
  levels.levels_m = levels_m;
  levels.memory_limit_bytes = memory_limit_bytes;
  // Layers without a cloud are the same everywhere: they have no sides.
  const bool periodic = scene.domain.periodic || field == nullptr;
  try {
    problem.grid = make_optical_grid(clouds.matter(), scene.layers, domain.min_m, domain.max_m, periodic,
                                     static_cast<int>(problem.phase.size()), forward_fraction, levels);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", scene.path.string(), error.what()));
  }
  if (scene.output.optical_depth) assembled.cloud_optical_depth = optical_depth_of_columns(clouds, problem.grid.box);
  if (scene.output.extinction) assembled.cloud_extinction = extinction_of_cells(clouds, problem.grid.box);
  if (!scene.albedo_map.empty()) {
    problem.surface.albedo_map = albedo_of_columns(scene, problem.grid.box, domain);
  }
  if (scene.thermal) {
    add_emission(scene, clouds, {domain.max_m[0] - domain.min_m[0], domain.max_m[1] - domain.min_m[1]}, problem);
  }
  for (const double height : scene.output.heights_m) {
    const int level = nearest_edge(problem.grid.box.z_edge_m, height);
    auto& listed = assembled.options.listed_levels;
    if (listed.empty() || listed.back() != level) listed.push_back(level);
  }
  solve_layers_without_iteration(scene, problem, assembled.options);
  if (!solved_by_polar_streams(problem, assembled.options)) {
    try {
      check_cell_thickness(problem);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", scene.path.string(), error.what()));
    }
  }
  return assembled;
}

}  // namespace cloudbow

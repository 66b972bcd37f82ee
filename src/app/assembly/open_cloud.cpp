#include "app/assembly/open_cloud.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "app/scene/accuracy.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/cloud_amounts.hpp"
#include "cloudbow/medium/joined_fields.hpp"
#include "cloudbow/medium/plausibility.hpp"
#include "cloudbow/optics/phase_family.hpp"

namespace cloudbow {
namespace {

/// Replaces the phase functions of the voxels by few, weighted by the scattering of each voxel.
void take_classes(const PhaseFamily& family, double tolerance, OpenedCloud& cloud) {
  const std::vector<double>& albedo = cloud.optics.voxel_single_scattering_albedo;
  std::vector<double> scattering;
  scattering.reserve(family.voxel.size());
  for (std::size_t n = 0; n < family.voxel.size(); ++n)
    scattering.push_back(cloud.field.value[n] * (albedo.empty() ? cloud.optics.single_scattering_albedo : albedo[n]));
  VoxelClasses classes = classes_of_voxels(family, scattering, tolerance);
  cloud.phase_classes =
      PhaseClassReport{classes.functions, static_cast<int>(classes.function.size()), classes.estimated_error};
  cloud.varying_phase = std::move(classes.function);
  cloud.optics.voxel_phase_function = std::move(classes.lower);
  cloud.optics.voxel_next_share = std::move(classes.next_share);
}

void take_droplets(const DropletTable& table, const std::vector<float>& radius_um, bool field_is_water,
                   double tolerance, OpenedCloud& cloud) {
  VoxelDroplets droplets = droplets_of_voxels(table, radius_um);
  if (field_is_water) water_to_extinction(cloud.field, droplets.extinction_m2_per_g);
  cloud.optics.voxel_single_scattering_albedo = std::move(droplets.single_scattering_albedo);
  take_classes(droplets.phase, tolerance, cloud);
}

/// Extinction of liquid water at SceneCloud::visible_um.
CloudField visible_extinction(const SceneCloud& cloud, const CloudField& water, const std::vector<float>& radius_um) {
  std::vector<double> extinction_m2_per_g;
  extinction_m2_per_g.reserve(radius_um.size());
  for (const float radius : radius_um) {
    const auto [lower, share] = mixture_for(*cloud.droplets, radius);
    const double at_lower = cloud.visible_m2_per_g[lower];
    extinction_m2_per_g.push_back(share > 0 ? at_lower + share * (cloud.visible_m2_per_g[lower + 1] - at_lower)
                                            : at_lower);
  }
  CloudField visible = water;
  water_to_extinction(visible, extinction_m2_per_g);
  return visible;
}

/// @param number of its phase function for each voxel, from 1
/// @param place begins the message about any other number
void take_phase_set(const ScenePhaseSet& set, const std::vector<float>& number, double tolerance,
                    const std::string& place, OpenedCloud& cloud) {
  std::vector<std::size_t> index;
  index.reserve(number.size());
  for (const float found : number) {
    const double whole = std::round(found);
    if (std::abs(found - whole) > 1e-3) {
      throw InputError(
          fmt::format("{}: not a number of a phase function (found {}, allowed whole numbers from 1 to {})", place,
                      found, set.function.size()));
    }
    index.push_back(static_cast<std::size_t>(whole) - 1);
  }
  take_classes(family_of_set(set.function, index), tolerance, cloud);
}

/// Beginning of a message about a grid.
std::string grid_place(const SceneCloud& cloud, const std::string& grid) {
  return fmt::format("{}: grid \"{}\"", cloud.file.string(), grid);
}

/// The grid of a constituent, or the sum of its grids.
VdbCloud read_field(const Scene& scene, const SceneCloud& cloud, VdbReadOptions options, CloudFiles& files) {
  VdbCloud field = files.field(cloud.file, options);
  if (cloud.more_grids.empty()) return field;
  std::vector<VdbCloud> more;
  for (const std::string& grid : cloud.more_grids) {
    options.grid = grid;
    more.push_back(files.field(cloud.file, options));
    const auto fail = [&](const std::string& found, const std::string& allowed) {
      throw InputError(
          fmt::format("{}: cannot be added to the grid \"{}\" (found {}, allowed {}); make a [[cloud]] of "
                      "each",
                      grid_place(cloud, grid), cloud.read.grid, found, allowed));
    };
    const auto described = [](const VdbCloud& of) {
      return fmt::format("{}{}", of.quantity.empty() ? "no quantity" : of.quantity,
                         of.units.empty() ? "" : fmt::format(" in {}", of.units));
    };
    if (described(more.back()) != described(field)) fail(described(more.back()), described(field));
    if (const auto difference = difference_of_voxels(more.back(), field)) fail(*difference, "the same voxels");
  }
  std::vector<CloudField*> fields{&field};
  for (VdbCloud& other : more) fields.push_back(&other);
  try {
    share_box(fields);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", scene.where(cloud.key + ".file"), error.what()));
  }
  const std::vector<const CloudField*> parts(fields.begin(), fields.end());
  static_cast<CloudField&>(field) = sum_of(parts);
  return field;
}

std::vector<float> read_effective_radius(const SceneCloud& cloud, CloudFiles& files, const CloudField& field,
                                         VdbReadOptions options) {
  options.grid = cloud.effective_radius_grid;
  options.auxiliary_quantity = "effective_radius";
  constexpr double rounding = 1e-6;  // of grids of floats
  if (cloud.droplets != nullptr) {
    return files.auxiliary(cloud.file, field, options, cloud.droplets->effective_radius_um.front() * (1 - rounding),
                           cloud.droplets->effective_radius_um.back() * (1 + rounding));
  }
  std::vector<float> radius =
      files.auxiliary(cloud.file, field, options, 0, static_cast<double>(std::numeric_limits<float>::max()));
  const auto [least, largest] = std::minmax_element(radius.begin(), radius.end());
  if (const auto doubt = doubt_effective_radius(*least, *largest))
    throw InputError(fmt::format("{}: {}", grid_place(cloud, options.grid), *doubt));
  return radius;
}

VoxelTemperatures read_temperature(const Scene& scene, const SceneCloud& cloud, CloudFiles& files,
                                   const CloudField& field, VdbReadOptions options) {
  options.grid = cloud.temperature_grid;
  options.auxiliary_quantity = "temperature";
  try {
    return files.auxiliary(cloud.file, field, options, coldest_cloud_k, warmest_cloud_k);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", scene.where(cloud.key + ".temperature_grid"), error.what()));
  }
}

/// Quantity of the grid's numbers, after the scale. A scale can convert liquid water to extinction: it is then the
/// extinction of 1 g/m3, which the radius of droplets bounds.
std::string quantity_of(const Scene& scene, const SceneCloud& cloud, const VdbCloud& field) {
  const std::string& stored = field.quantity;
  const std::string quantity = cloud.quantity.empty() ? stored : cloud.quantity;
  const std::string place = grid_place(cloud, cloud.read.grid);
  if (quantity != "extinction" && !density_of_water(quantity)) {
    throw InputError(fmt::format(
        "{}: the quantity of grid '{}' of {} is not given (found {}, allowed extinction, {})",
        scene.where(cloud.key + ".quantity"), cloud.read.grid, cloud.file.string(),
        quantity.empty() ? "neither this key nor metadata 'quantity'" : fmt::format("metadata '{}'", quantity),
        fmt::join(water_contents(), ", ")));
  }
  if (stored == quantity || stored.empty()) {
    const auto scale = scale_of_units(quantity, field.units);
    if (cloud.read.scale == 1 && scale.value_or(1) != 1) {
      throw InputError(fmt::format("{}: not in the units of {} (found \"{}\", allowed {}); set {}.scale = {:g}", place,
                                   quantity, field.units, quantity == "extinction" ? "1/m" : "g/m3", cloud.key,
                                   *scale));
    }
    return quantity;
  }
  const bool water_to_extinction = stored == "liquid_water_content" && quantity == "extinction";
  const bool by_scale = cloud.read.scale <= extinction_per_liquid_water(smallest_effective_radius_um) &&
                        cloud.read.scale >= extinction_per_liquid_water(largest_effective_radius_um);
  if (water_to_extinction && cloud.read.scale != 1 && by_scale) return quantity;
  throw InputError(fmt::format(
      "{}: contradicts the grid \"{}\" of {} (found {}, the grid's metadata say {}); leave the key out, or "
      "name the grid "
      "that holds {}{}",
      scene.where(cloud.key + ".quantity"), cloud.read.grid, cloud.file.string(), quantity, stored, quantity,
      water_to_extinction ? fmt::format("; {}.effective_radius_um makes extinction of liquid water", cloud.key) : ""));
}

/// The corners of the scene's domain, if it has both.
std::optional<VdbDomain> given_domain(const SceneDomain& domain) {
  if (!domain.min_m || !domain.max_m) return std::nullopt;
  return VdbDomain{*domain.min_m, *domain.max_m};
}

double faces_from_corner(const CloudField& field, int axis, double value_m) {
  return (value_m - field.min_m[axis]) / field.cell_size_m[axis];
}

}  // namespace

bool lies_on_face(const CloudField& field, int axis, double value_m) {
  const double faces = faces_from_corner(field, axis, value_m);
  return std::abs(faces - std::round(faces)) <= face_tolerance;
}

double onto_face(const CloudField& field, int axis, double value_m) {
  if (!lies_on_face(field, axis, value_m)) return value_m;
  return field.min_m[axis] + std::round(faces_from_corner(field, axis, value_m)) * field.cell_size_m[axis];
}

OpenedCloud open_cloud(const Scene& scene, const SceneCloud& cloud, std::size_t first_varying, CloudFiles& files) {
  VdbReadOptions read = cloud.read;
  read.domain_m = given_domain(scene.domain);
  OpenedCloud opened{read_field(scene, cloud, read, files), {}, {}, {}, {}, {}, {}, {}};
  opened.figures.name = cloud.name;
  VdbCloud& field = opened.field;
  VdbReadOptions auxiliary = read;
  auxiliary.scale = 1;
  const double class_error = scene.solver.class_tolerance.value_or(class_tolerance(scene.solver.accuracy));
  const std::string quantity = quantity_of(scene, cloud, field);
  const bool is_water = quantity != "extinction";
  const auto doubt = [&](const std::optional<std::string>& sentence) {
    if (sentence) files.note(fmt::format("warning: {}: {}", grid_place(cloud, cloud.read.grid), *sentence));
  };
  if (is_water) {
    opened.figures.water_path_g_m2 = column_figures(field, 1);
    opened.figures.largest_water_content_g_m3 = largest_value(field);
    doubt(doubt_water_content(largest_value(field), quantity));
  }

  std::vector<float> radius;
  const bool has_radius_grid = !cloud.effective_radius_grid.empty();
  if (!is_water && cloud.droplets == nullptr && !cloud.extinction_m2_per_g) {
    if (has_radius_grid || cloud.effective_radius_um) {
      files.note(
          fmt::format("note: {}: not used: the grid \"{}\" holds extinction, and phase_function is no Mie table",
                      scene.where(cloud.key + (has_radius_grid ? ".effective_radius_grid" : ".effective_radius_um")),
                      cloud.read.grid));
    }
  } else if (has_radius_grid) {
    radius = read_effective_radius(cloud, files, field, auxiliary);
    const auto [least, largest] = std::minmax_element(radius.begin(), radius.end());
    opened.figures.effective_radius_um = {*least, *largest};
  } else if (cloud.effective_radius_um) {
    opened.figures.effective_radius_um = {*cloud.effective_radius_um, *cloud.effective_radius_um};
  }
  std::optional<CloudField> visible;  // if it is not the field times a number
  if (scene.broadband && !is_water && cloud.droplets != nullptr) {
    throw InputError(fmt::format(
        "{}: extinction has no spectrum (found radii by voxel beside it, allowed a water content, or one radius)",
        scene.where(cloud.key + ".quantity")));
  }
  if (!is_water && cloud.relative_extinction) {
    files.note(fmt::format("{}: the extinction is taken to be that at {} um", scene.where(cloud.key + ".file"),
                           SceneCloud::visible_um));
    opened.optics.extinction_per_value = *cloud.relative_extinction;
  } else if (cloud.droplets != nullptr) {
    if (!cloud.visible_m2_per_g.empty()) visible = visible_extinction(cloud, field, radius);
    take_droplets(*cloud.droplets, radius, is_water, class_error, opened);
  } else if (is_water && cloud.extinction_m2_per_g) {
    opened.optics.extinction_per_value = *cloud.extinction_m2_per_g;
  } else if (is_water && cloud.effective_radius_um) {
    opened.optics.extinction_per_value =
        extinction_per_liquid_water(*cloud.effective_radius_um) / density_of_water(quantity).value();
  } else if (is_water && !radius.empty()) {
    water_to_extinction_by_radius(field, radius);
    opened.optics.extinction_per_value = 1 / density_of_water(quantity).value();
  } else if (is_water) {
    throw InputError(
        fmt::format("{}: missing (found quantity {}, allowed with effective_radius_um or effective_radius_grid)",
                    scene.where(cloud.key + ".effective_radius_um"), quantity));
  }
  const double per_value = opened.optics.extinction_per_value;
  ColumnDepths& depths = opened.column_optical_depth;
  if (cloud.relative_extinction || visible) opened.figures.optical_depth_um = SceneCloud::visible_um;
  depths.min_m = {field.min_m[0], field.min_m[1]};
  depths.columns = {field.cells[0], field.cells[1]};
  const CloudField& shown = visible ? *visible : field;
  const double shown_per_value = visible ? 1 : per_value / cloud.relative_extinction.value_or(1);
  depths.value = column_integrals(shown);
  for (double& depth : depths.value) depth *= shown_per_value;
  for (const double depth : depths.value) {
    opened.figures.optical_depth.sum += depth;
    opened.figures.optical_depth.largest = std::max(opened.figures.optical_depth.largest, depth);
  }
  if (!scene.output.optical_depth) depths.value.clear();
  if (scene.output.extinction) {
    opened.extinction.reserve(shown.value.size());
    for (const float value : shown.value) opened.extinction.push_back(static_cast<float>(value * shown_per_value));
  }
  doubt(doubt_optical_depth(largest_value(field) * per_value * field.cell_size_m[2]));

  opened.optics.phase_function =
      cloud.droplets == nullptr && cloud.phase_set == nullptr ? cloud.phase_function : static_cast<int>(first_varying);
  if (!cloud.single_scattering_albedo_grid.empty()) {
    auxiliary.grid = cloud.single_scattering_albedo_grid;
    auxiliary.auxiliary_quantity = "single_scattering_albedo";
    const std::vector<float> albedo = files.auxiliary(cloud.file, field, auxiliary, 0, 1);
    opened.optics.voxel_single_scattering_albedo.assign(albedo.begin(), albedo.end());
  } else if (cloud.single_scattering_albedo) {
    opened.optics.single_scattering_albedo = *cloud.single_scattering_albedo;
    opened.optics.voxel_single_scattering_albedo.clear();
  }
  if (cloud.phase_set != nullptr) {
    auxiliary.grid = cloud.phase_set->index_grid;
    auxiliary.auxiliary_quantity = "phase_index";
    const std::vector<float> number =
        files.auxiliary(cloud.file, field, auxiliary, 1, static_cast<double>(cloud.phase_set->function.size()));
    take_phase_set(*cloud.phase_set, number, class_error, grid_place(cloud, auxiliary.grid), opened);
  }
  if (!cloud.temperature_grid.empty()) {
    opened.temperature_k = read_temperature(scene, cloud, files, field, auxiliary);
    const auto [least, largest] = std::minmax_element(opened.temperature_k.begin(), opened.temperature_k.end());
    opened.figures.temperature_k = {*least, *largest};
  }
  return opened;
}

}  // namespace cloudbow

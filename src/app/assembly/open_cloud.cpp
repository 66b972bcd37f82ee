#include "app/assembly/open_cloud.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "app/scene/accuracy.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/plausibility.hpp"
#include "cloudbow/optics/phase_classes.hpp"

namespace cloudbow {
namespace {

/// The phase function of a voxel: a member of a family or, with a share of the scattering, the next one.
struct FamilyMember {
  std::size_t member;
  double next_share;
};

/// Few phase functions for a family of them.
void apply_classes(const std::vector<PhaseFunction>& family, const std::vector<FamilyMember>& voxel, double tolerance,
                   OpenedCloud& cloud) {
  std::vector<double> weight(family.size(), 0);
  for (std::size_t n = 0; n < voxel.size(); ++n) {
    const std::vector<double>& albedo = cloud.optics.voxel_single_scattering_albedo;
    const double scattering =
        cloud.field.value[n] * (albedo.empty() ? cloud.optics.single_scattering_albedo : albedo[n]);
    weight[voxel[n].member] += (1 - voxel[n].next_share) * scattering;
    if (voxel[n].next_share > 0) weight[voxel[n].member + 1] += voxel[n].next_share * scattering;
  }
  const PhaseClasses classes(family, weight, tolerance);
  for (const std::size_t member : classes.members()) cloud.varying_phase.push_back(family[member]);
  const bool all_black = std::all_of(weight.begin(), weight.end(), [](double w) { return w == 0; });
  for (const FamilyMember& of_voxel : voxel) {
    const bool is_black = !all_black && weight[of_voxel.member] == 0 && of_voxel.next_share == 0;
    const ClassMixture mixture = is_black ? ClassMixture{0, 0} : classes.mixture(of_voxel.member, of_voxel.next_share);
    cloud.optics.voxel_phase_function.push_back(static_cast<std::uint16_t>(mixture.lower));
    cloud.optics.voxel_next_share.push_back(static_cast<float>(mixture.next_share));
  }
  const auto used = std::count_if(weight.begin(), weight.end(), [](double w) { return w > 0; });
  cloud.phase_classes =
      PhaseClassReport{static_cast<int>(used), static_cast<int>(classes.members().size()), classes.estimated_error()};
}

/// Droplets of the voxels' own effective radius: each voxel a mixture of two neighbouring rows of the table.
void apply_droplets(const DropletTable& table, const std::vector<float>& radius_um, bool field_is_water,
                    double tolerance, OpenedCloud& cloud) {
  std::vector<DropletMixture> mixture;
  std::size_t first = table.size(), last = 0;
  for (const float radius : radius_um) {
    mixture.push_back(mixture_for(table, radius));
    first = std::min(first, mixture.back().lower);
    last = std::max(last, std::min(mixture.back().lower + 1, table.size() - 1));
  }
  std::vector<PhaseFunction> family;
  for (std::size_t row = first; row <= last; ++row) {
    family.push_back(droplet_optics(table, table.effective_radius_um[row]).phase_function);
  }
  std::vector<FamilyMember> voxel;
  for (std::size_t n = 0; n < mixture.size(); ++n) {
    const std::size_t lower = mixture[n].lower, upper = std::min(lower + 1, table.size() - 1);
    const double share = mixture[n].upper_share;
    const double lower_extinction = (1 - share) * table.extinction_m2_per_g[lower];
    const double upper_extinction = share * table.extinction_m2_per_g[upper];
    const double upper_scattering = upper_extinction * table.single_scattering_albedo[upper];
    const double scattering = lower_extinction * table.single_scattering_albedo[lower] + upper_scattering;
    const double extinction = lower_extinction + upper_extinction;
    if (field_is_water) cloud.field.value[n] = static_cast<float>(cloud.field.value[n] * extinction);
    cloud.optics.voxel_single_scattering_albedo.push_back(scattering / extinction);
    voxel.push_back({lower - first, scattering > 0 ? upper_scattering / scattering : 0});
  }
  apply_classes(family, voxel, tolerance, cloud);
}

/// Voxels that choose from a set by number. Ordered by asymmetry, neighbours in a set differ little.
void apply_phase_set(const ScenePhaseSet& set, const std::vector<float>& number, double tolerance,
                     const std::string& where, OpenedCloud& cloud) {
  std::vector<std::size_t> order(set.function.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return set.function[a].asymmetry_parameter() < set.function[b].asymmetry_parameter();
  });
  std::vector<std::size_t> place(order.size());
  std::vector<PhaseFunction> family;
  for (std::size_t n = 0; n < order.size(); ++n) {
    place[order[n]] = n;
    family.push_back(set.function[order[n]]);
  }
  std::vector<FamilyMember> voxel;
  for (const float found : number) {
    const double whole = std::round(found);
    if (std::abs(found - whole) > 1e-3) {
      throw InputError(
          fmt::format("{}: not a number of a phase function (found {}, allowed whole numbers from 1 to {})", where,
                      found, order.size()));
    }
    voxel.push_back({place[static_cast<std::size_t>(whole) - 1], 0});
  }
  apply_classes(family, voxel, tolerance, cloud);
}

/// Where the message about a grid begins.
std::string grid_place(const SceneCloud& cloud, const std::string& grid) {
  return fmt::format("{}: grid \"{}\"", cloud.file.string(), grid);
}

std::vector<float> read_effective_radius(const Scene& scene, CloudFiles& files, const CloudField& field,
                                         VdbReadOptions options) {
  const SceneCloud& cloud = *scene.cloud;
  options.grid = cloud.effective_radius_grid;
  options.companion_quantity = "effective_radius";
  constexpr double rounding = 1e-6;  // of grids of floats
  if (cloud.droplets != nullptr) {
    return files.companion(cloud.file, field, options, cloud.droplets->effective_radius_um.front() * (1 - rounding),
                           cloud.droplets->effective_radius_um.back() * (1 + rounding));
  }
  std::vector<float> radius =
      files.companion(cloud.file, field, options, 0, static_cast<double>(std::numeric_limits<float>::max()));
  const auto [least, largest] = std::minmax_element(radius.begin(), radius.end());
  if (const auto doubt = doubt_effective_radius(*least, *largest))
    throw InputError(fmt::format("{}: {}", grid_place(cloud, options.grid), *doubt));
  return radius;
}

/// What the grid's numbers are, after the scale. A scale makes extinction of liquid water: it is then the extinction of
/// 1 g/m3, which the radius of droplets bounds.
std::string quantity_of(const Scene& scene, const VdbCloud& field) {
  const SceneCloud& cloud = *scene.cloud;
  const std::string& stored = field.quantity;
  const std::string quantity = cloud.quantity.empty() ? stored : cloud.quantity;
  const std::string place = grid_place(cloud, cloud.read.grid);
  if (quantity != "liquid_water_content" && quantity != "extinction") {
    throw InputError(fmt::format(
        "{}: what the grid '{}' of {} holds is not said (found {}, allowed extinction, liquid_water_content)",
        scene.where("cloud.quantity"), cloud.read.grid, cloud.file.string(),
        quantity.empty() ? "neither this key nor metadata 'quantity'" : fmt::format("metadata '{}'", quantity)));
  }
  if (stored == quantity || stored.empty()) {
    const auto scale = scale_of_units(quantity, field.units);
    if (cloud.read.scale == 1 && scale.value_or(1) != 1) {
      throw InputError(fmt::format("{}: not in the units of {} (found \"{}\", allowed {}) set cloud.scale = {:g}",
                                   place, quantity, field.units, quantity == "extinction" ? "1/m" : "g/m3", *scale));
    }
    return quantity;
  }
  const bool water_to_extinction = stored == "liquid_water_content" && quantity == "extinction";
  const bool by_scale = cloud.read.scale <= extinction_per_liquid_water(smallest_effective_radius_um) &&
                        cloud.read.scale >= extinction_per_liquid_water(largest_effective_radius_um);
  if (water_to_extinction && cloud.read.scale != 1 && by_scale) return quantity;
  throw InputError(
      fmt::format("{}: contradicts the grid \"{}\" of {} (found {}, the grid's metadata say {}) leave the key out, or "
                  "name the grid "
                  "that holds {}{}",
                  scene.where("cloud.quantity"), cloud.read.grid, cloud.file.string(), quantity, stored, quantity,
                  water_to_extinction ? "; cloud.effective_radius_um makes extinction of liquid water" : ""));
}

/// Means and largest values over columns, while `field` holds water or extinction.
ColumnFigures column_figures(const CloudField& field, double factor) {
  ColumnFigures figures;
  for (const double column : column_integrals(field)) {
    figures.sum += column * factor;
    figures.largest = std::max(figures.largest, column * factor);
  }
  return figures;
}

double largest_value(const CloudField& field) {
  return static_cast<double>(*std::max_element(field.value.begin(), field.value.end()));
}

/// The corners of the scene's domain, where it has both.
std::optional<VdbDomain> given_domain(const SceneDomain& domain) {
  if (!domain.min_m || !domain.max_m) return std::nullopt;
  return VdbDomain{*domain.min_m, *domain.max_m};
}

}  // namespace

OpenedCloud open_cloud(const Scene& scene, CloudFiles& files) {
  const SceneCloud& cloud = *scene.cloud;
  VdbReadOptions read = cloud.read;
  read.domain_m = given_domain(scene.domain);
  OpenedCloud opened{files.field(cloud.file, read), {}, {}, {}, {}};
  VdbCloud& field = opened.field;
  VdbReadOptions companion = read;
  companion.scale = 1;
  const double class_error = scene.solver.class_tolerance.value_or(class_tolerance(scene.solver.accuracy));
  const bool is_water = quantity_of(scene, field) == "liquid_water_content";
  const auto doubt = [&](const std::optional<std::string>& sentence) {
    if (sentence) files.note(fmt::format("warning: {}: {}", grid_place(cloud, cloud.read.grid), *sentence));
  };
  if (is_water) {
    opened.figures.water_path_g_m2 = column_figures(field, 1);
    opened.figures.largest_water_content_g_m3 = largest_value(field);
    doubt(doubt_water_content(largest_value(field)));
  }

  std::vector<float> radius;
  const bool has_radius_grid = !cloud.effective_radius_grid.empty();
  if (!is_water && cloud.droplets == nullptr && !cloud.extinction_m2_per_g) {
    if (has_radius_grid || cloud.effective_radius_um) {
      files.note(fmt::format("note: {}: not used: the grid \"{}\" holds extinction, and phase_function is no Mie table",
                             scene.where(has_radius_grid ? "cloud.effective_radius_grid" : "cloud.effective_radius_um"),
                             cloud.read.grid));
    }
  } else if (has_radius_grid) {
    radius = read_effective_radius(scene, files, field, companion);
    const auto [least, largest] = std::minmax_element(radius.begin(), radius.end());
    opened.figures.effective_radius_um = {*least, *largest};
  } else if (cloud.effective_radius_um) {
    opened.figures.effective_radius_um = {*cloud.effective_radius_um, *cloud.effective_radius_um};
  }
  if (cloud.droplets != nullptr) {
    apply_droplets(*cloud.droplets, radius, is_water, class_error, opened);
  } else if (is_water && cloud.extinction_m2_per_g) {
    opened.optics.extinction_per_value = *cloud.extinction_m2_per_g;
  } else if (is_water && cloud.effective_radius_um) {
    opened.optics.extinction_per_value = extinction_per_liquid_water(*cloud.effective_radius_um);
  } else if (is_water && !radius.empty()) {
    for (std::size_t n = 0; n < radius.size(); ++n) {
      field.value[n] = static_cast<float>(field.value[n] * extinction_per_liquid_water(radius[n]));
    }
  } else if (is_water) {
    throw InputError(
        fmt::format("{}: missing (found quantity liquid_water_content, allowed with effective_radius_um "
                    "or effective_radius_grid)",
                    scene.where("cloud.effective_radius_um")));
  }
  const double per_value = opened.optics.extinction_per_value;
  opened.figures.optical_depth = column_figures(field, per_value);
  doubt(doubt_optical_depth(largest_value(field) * per_value * field.cell_size_m[2]));

  opened.optics.phase_function = cloud.droplets == nullptr && cloud.phase_set == nullptr
                                     ? cloud.phase_function
                                     : static_cast<int>(scene.phase_functions.size());
  if (!cloud.single_scattering_albedo_grid.empty()) {
    companion.grid = cloud.single_scattering_albedo_grid;
    companion.companion_quantity = "single_scattering_albedo";
    const std::vector<float> albedo = files.companion(cloud.file, field, companion, 0, 1);
    opened.optics.voxel_single_scattering_albedo.assign(albedo.begin(), albedo.end());
  } else if (cloud.single_scattering_albedo) {
    opened.optics.single_scattering_albedo = *cloud.single_scattering_albedo;
    opened.optics.voxel_single_scattering_albedo.clear();
  }
  if (cloud.phase_set != nullptr) {
    companion.grid = cloud.phase_set->index_grid;
    companion.companion_quantity = "phase_index";
    const std::vector<float> number =
        files.companion(cloud.file, field, companion, 1, static_cast<double>(cloud.phase_set->function.size()));
    apply_phase_set(*cloud.phase_set, number, class_error, grid_place(cloud, companion.grid), opened);
  }
  return opened;
}

}  // namespace cloudbow

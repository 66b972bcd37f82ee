#include "app/assembly/thermal.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/albedo_map.hpp"

namespace cloudbow {
namespace {

constexpr double linearity = 1e-3;  // of Planck radiance in a level of layers, of the layer's largest

/// The largest Planck radiance of the ground.
double surface_radiance(const Surface& surface) {
  if (surface.planck_map.empty()) return surface.planck;
  return static_cast<double>(*std::max_element(surface.planck_map.begin(), surface.planck_map.end()));
}

/// Bottom of the lowest voxel with matter and top of the highest.
std::array<double, 2> heights_of_voxels(const CloudField& field) {
  const auto is_empty = [&](int k) {
    const auto row = static_cast<std::size_t>(k) * static_cast<std::size_t>(field.cells[1]);
    return field.row_begin[row] == field.row_begin[row + static_cast<std::size_t>(field.cells[1])];
  };
  int low = 0, high = field.cells[2];
  while (low < high && is_empty(low)) ++low;
  while (high > low && is_empty(high - 1)) --high;
  return {field.min_m[2] + low * field.cell_size_m[2], field.min_m[2] + high * field.cell_size_m[2]};
}

std::vector<float> planck_of_columns(const Scene& scene, const BoxGrid& box, const std::array<double, 2>& extent_m) {
  try {
    GroundMap map = read_temperature_map(scene.temperature_map);
    check_covers(map, scene.temperature_map, extent_m);
    // Means of radiance, not of temperature: the ground's emission is kept.
    for (float& value : map.value) value = static_cast<float>(scene.thermal->planck(static_cast<double>(value)));
    return area_means(map, box.nx, box.ny);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", scene.where("surface.temperature_map"), error.what()));
  }
}

}  // namespace

std::vector<double> emission_levels(const Scene& scene, const CloudField* clouds, const std::array<double, 2>& z_m) {
  std::vector<double> levels;
  if (!scene.thermal || scene.domain.vertical_cells > 0) return levels;
  const Atmosphere& air = scene.atmosphere->air;
  for (const Layer& layer : scene.layers) {
    if (layer.optical_depth * (1 - layer.single_scattering_albedo) <= 0) continue;
    const std::vector<double> of_layer = heights_where_planck_is_linear(
        air, scene.thermal->planck, std::max(layer.bottom_m, z_m[0]), std::min(layer.top_m, z_m[1]), linearity);
    levels.insert(levels.end(), of_layer.begin(), of_layer.end());
  }
  if (clouds != nullptr) {
    const std::array<double, 2> voxels = heights_of_voxels(*clouds);
    std::erase_if(levels, [&voxels](double z) { return z > voxels[0] && z < voxels[1]; });
  }
  return levels;
}

void add_emission(const Scene& scene, const OpenedClouds& clouds, const std::array<double, 2>& extent_m,
                  Problem& problem) {
  const Atmosphere& air = scene.atmosphere->air;
  const auto& planck = scene.thermal->planck;
  set_emission(
      problem.grid, [&air](double z) { return air.temperature_at(z); }, planck, clouds.field(),
      clouds.temperature_k.empty() ? nullptr : &clouds.temperature_k);
  if (!scene.temperature_map.empty()) problem.surface.planck_map = planck_of_columns(scene, problem.grid.box, extent_m);
  const std::vector<float>& of_cells = problem.grid.planck;
  const double of_matter =
      of_cells.empty() ? 0 : static_cast<double>(*std::max_element(of_cells.begin(), of_cells.end()));
  const double largest = std::max(surface_radiance(problem.surface), of_matter);
  if (largest < least_light) {
    throw InputError(fmt::format(
        "{}: thermal: nothing emits in this spectral interval (found {:.3g} {} sr-1, allowed at least {}); longer "
        "wavelengths, or no [thermal]",
        scene.path.string(), largest, scene.thermal->flux_units(), least_light));
  }
}

std::optional<std::string> doubt_atmosphere(const Scene& scene, const std::array<double, 2>& z_m) {
  const std::vector<double>& height = scene.atmosphere->air.height_m;
  if (z_m[0] >= height.front() && z_m[1] <= height.back()) return std::nullopt;
  return fmt::format(
      "warning: {}: atmosphere: does not cover the domain (found {:g} to {:g} m, the domain is {:g} to {:g} m): its "
      "nearest temperature holds beyond",
      scene.path.string(), height.front(), height.back(), z_m[0], z_m[1]);
}

}  // namespace cloudbow

#include "app/assembly/open_clouds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/joined_fields.hpp"

namespace cloudbow {
namespace {

// Half precision rounds temperatures to .25 K.
constexpr double same_temperature_k = 0.5;

void check_voxels(const Scene& scene, const std::vector<OpenedCloud>& constituents) {
  for (std::size_t n = 1; n < constituents.size(); ++n) {
    const auto difference = difference_of_voxels(constituents[n].field, constituents[0].field);
    if (!difference) continue;
    throw InputError(fmt::format(
        "{}: \"{}\" has other voxels than \"{}\" (found {}, allowed the same voxels); resample its grid to those of "
        "the other (OpenVDB's tools::resampleToMatch, vdb_tool -resample)",
        scene.where(scene.clouds[n].key + ".file"), scene.clouds[n].name, scene.clouds[0].name, *difference));
  }
}

/// Gives all fields one box, and returns the voxels that they have together.
CloudField join(const Scene& scene, std::vector<OpenedCloud>& constituents) {
  check_voxels(scene, constituents);
  std::vector<CloudField*> fields;
  for (OpenedCloud& constituent : constituents) fields.push_back(&constituent.field);
  try {
    share_box(fields);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", scene.where(scene.clouds.back().key + ".file"), error.what()));
  }
  const std::vector<const CloudField*> parts(fields.begin(), fields.end());
  return sum_of(parts);
}

/// Temperatures of the joined voxels: those of the constituents that have some, else that of the air.
VoxelTemperatures join_temperatures(const Scene& scene, const OpenedClouds& clouds) {
  constexpr float none = 0;
  VoxelTemperatures joined;
  for (std::size_t n = 0; n < clouds.constituents.size(); ++n) {
    const VoxelTemperatures& own = clouds.constituents[n].temperature_k;
    if (own.empty()) continue;
    joined.resize(clouds.joined.active_voxels(), none);
    const std::vector<std::size_t> places = places_in(clouds.joined, clouds.constituents[n].field);
    for (std::size_t voxel = 0; voxel < own.size(); ++voxel) {
      float& here = joined[places[voxel]];
      if (here == none) here = own[voxel];
      if (std::abs(here - own[voxel]) > same_temperature_k) {
        throw InputError(fmt::format(
            "{}: another temperature than a constituent before it has in the same voxel (found {:.5g} K beside "
            "{:.5g} K, allowed {} K apart); name the same temperatures, or leave the key out of one of them",
            scene.where(scene.clouds[n].key + ".temperature_grid"), own[voxel], here, same_temperature_k));
      }
    }
  }
  if (joined.empty()) return joined;
  const CloudField& field = clouds.joined;
  const auto rows = static_cast<std::size_t>(field.cells[1]);
  for (int k = 0; k < field.cells[2]; ++k) {
    const double height_m = field.min_m[2] + (k + .5) * field.cell_size_m[2];
    const auto of_air = static_cast<float>(scene.atmosphere->air.temperature_at(height_m));
    const std::size_t row = static_cast<std::size_t>(k) * rows;
    for (std::uint32_t s = field.row_begin[row]; s < field.row_begin[row + rows]; ++s) {
      for (std::int32_t n = 0; n < field.spans[s].n; ++n) {
        float& here = joined[field.spans[s].offset + static_cast<std::size_t>(n)];
        if (here == none) here = of_air;
      }
    }
  }
  return joined;
}

/// Sum over the voxels of a constituent: its weight among several.
double scattering_of(const OpenedCloud& cloud) {
  const std::vector<double>& albedo = cloud.optics.voxel_single_scattering_albedo;
  double sum = 0;
  for (std::size_t n = 0; n < cloud.field.value.size(); ++n)
    sum += cloud.field.value[n] * (albedo.empty() ? cloud.optics.single_scattering_albedo : albedo[n]);
  return sum * cloud.optics.extinction_per_value;
}

/// Classes of all constituents. Errors are means over the scattering of all clouds.
std::optional<PhaseClassReport> join_reports(const std::vector<OpenedCloud>& constituents) {
  std::optional<PhaseClassReport> joined;
  double all = 0;
  for (const OpenedCloud& cloud : constituents) all += scattering_of(cloud);
  for (const OpenedCloud& cloud : constituents) {
    if (!cloud.phase_classes) continue;
    if (!joined) joined = PhaseClassReport();
    joined->functions += cloud.phase_classes->functions;
    joined->classes += cloud.phase_classes->classes;
    if (all > 0) joined->estimated_error += cloud.phase_classes->estimated_error * scattering_of(cloud) / all;
  }
  return joined;
}

}  // namespace

const CloudField* OpenedClouds::field() const {
  if (constituents.empty()) return nullptr;
  return constituents.size() == 1 ? &constituents.front().field : &joined;
}

CloudMatter OpenedClouds::matter() const {
  CloudMatter matter{field()};
  for (const OpenedCloud& cloud : constituents) matter.constituents.push_back({&cloud.field, &cloud.optics});
  return matter;
}

OpenedClouds open_clouds(const Scene& scene, CloudFiles& files) {
  OpenedClouds clouds;
  std::size_t phase_functions = scene.phase_functions.size();
  for (const SceneCloud& cloud : scene.clouds) {
    clouds.constituents.push_back(open_cloud(scene, cloud, phase_functions, files));
    phase_functions += clouds.constituents.back().varying_phase.size();
  }
  if (clouds.constituents.size() == 1) {
    clouds.temperature_k = std::move(clouds.constituents.front().temperature_k);
    clouds.phase_classes = clouds.constituents.front().phase_classes;
  } else if (clouds.constituents.size() > 1) {
    clouds.joined = join(scene, clouds.constituents);
    clouds.temperature_k = join_temperatures(scene, clouds);
    clouds.phase_classes = join_reports(clouds.constituents);
  }
  return clouds;
}

}  // namespace cloudbow

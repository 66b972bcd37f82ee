#include "cloudbow/optics/phase_family.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "phase_classes.hpp"

namespace cloudbow {

VoxelDroplets droplets_of_voxels(const DropletTable& table, std::span<const float> effective_radius_um) {
  std::vector<DropletMixture> mixture;
  std::size_t first = table.size(), last = 0;
  for (const float radius : effective_radius_um) {
    mixture.push_back(mixture_for(table, radius));
    first = std::min(first, mixture.back().lower);
    last = std::max(last, std::min(mixture.back().lower + 1, table.size() - 1));
  }
  VoxelDroplets droplets;
  for (std::size_t row = first; row <= last; ++row) {
    droplets.phase.function.push_back(droplet_optics(table, table.effective_radius_um[row]).phase_function);
  }
  for (const DropletMixture& of_voxel : mixture) {
    const MixedDroplets mixed = mix(table, of_voxel);
    droplets.extinction_m2_per_g.push_back(mixed.extinction_m2_per_g);
    droplets.single_scattering_albedo.push_back(mixed.single_scattering_albedo());
    droplets.phase.voxel.push_back({of_voxel.lower - first, mixed.upper_share_of_scattering(0)});
  }
  return droplets;
}

PhaseFamily family_of_set(std::span<const PhaseFunction> set, std::span<const std::size_t> number) {
  std::vector<std::size_t> order(set.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return set[a].asymmetry_parameter() < set[b].asymmetry_parameter();
  });
  PhaseFamily family;
  std::vector<std::size_t> member(order.size());
  for (std::size_t n = 0; n < order.size(); ++n) {
    member[order[n]] = n;
    family.function.push_back(set[order[n]]);
  }
  for (const std::size_t of_voxel : number) family.voxel.push_back({member[of_voxel], 0});
  return family;
}

VoxelClasses classes_of_voxels(const PhaseFamily& family, std::span<const double> scattering, double tolerance) {
  assert(scattering.size() == family.voxel.size());
  std::vector<double> weight(family.function.size(), 0);
  for (std::size_t n = 0; n < family.voxel.size(); ++n) {
    const auto [member, next_share] = family.voxel[n];
    weight[member] += (1 - next_share) * scattering[n];
    if (next_share > 0) weight[member + 1] += next_share * scattering[n];
  }
  const PhaseClasses classes(family.function, weight, tolerance);
  VoxelClasses result;
  for (const std::size_t member : classes.members()) result.function.push_back(family.function[member]);
  const bool all_black = std::all_of(weight.begin(), weight.end(), [](double w) { return w == 0; });
  for (const auto [member, next_share] : family.voxel) {
    const bool is_black = !all_black && weight[member] == 0 && next_share == 0;
    const ClassMixture mixture = is_black ? ClassMixture{0, 0} : classes.mixture(member, next_share);
    result.lower.push_back(static_cast<std::uint16_t>(mixture.lower));
    result.next_share.push_back(static_cast<float>(mixture.next_share));
  }
  result.functions = static_cast<int>(std::count_if(weight.begin(), weight.end(), [](double w) { return w > 0; }));
  result.estimated_error = classes.estimated_error();
  return result;
}

}  // namespace cloudbow

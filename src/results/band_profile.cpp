#include "cloudbow/results/band_profile.hpp"

#include <cassert>
#include <cstddef>
#include <numeric>

namespace cloudbow {
namespace {

void add(const std::vector<double>& of, std::vector<double>& sum) {
  sum.resize(of.size(), 0);
  for (std::size_t n = 0; n < of.size(); ++n) sum[n] += of[n];
}

std::vector<double> means_of_levels(const std::vector<float>& cell, std::size_t columns) {
  std::vector<double> mean;
  for (auto first = cell.begin(); first != cell.end(); first += static_cast<std::ptrdiff_t>(columns))
    mean.push_back(std::accumulate(first, first + static_cast<std::ptrdiff_t>(columns), 0.0) /
                   static_cast<double>(columns));
  return mean;
}

}  // namespace

std::vector<BandProfile> band_profiles(const GasModel& model) {
  const GasModel::Bands bands = model.bands();
  std::vector<BandProfile> profiles(bands.lower.size());
  for (std::size_t b = 0; b < profiles.size(); ++b) profiles[b].wavenumber_cm1 = {bands.lower[b], bands.upper[b]};
  return profiles;
}

void add_to_band(const Solution& solution, BandProfile& band) {
  add(solution.profile_upwelling_flux, band.upwelling_flux);
  add(solution.profile_downwelling_diffuse_flux, band.downwelling_diffuse_flux);
  add(solution.profile_direct_flux, band.direct_flux);
  add(means_of_levels(solution.absorbed_power, solution.box.columns()), band.absorbed_power);
}

}  // namespace cloudbow

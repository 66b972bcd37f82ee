#include "cloudbow/optics/droplet_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/legendre_series.hpp"

namespace cloudbow {
namespace {

std::string check_moments(const std::vector<double>& moments, const std::string& row) {
  constexpr double rounding = 1e-4;  // of tables with five decimals
  const auto fail = [&row](const std::string& problem) {
    throw InputError(fmt::format("phase function at {}: {}", row, problem));
  };
  if (moments.size() < 2) fail(fmt::format("too few moments (found {}, allowed at least 2)", moments.size()));
  if (!(std::abs(moments[0] - 1) <= rounding)) {
    fail(fmt::format("wrong norm (found moment 0 = {}, allowed 1)", moments[0]));
  }
  for (std::size_t l = 0; l < moments.size(); ++l) {
    if (!(std::abs(moments[l]) <= 1 + rounding)) {
      fail(fmt::format("moment {} out of range (found {}, allowed -1 to 1, without the factor 2l+1)", l, moments[l]));
    }
  }
  // A series that is cut while its terms are large rings all over the sphere.
  const SeriesTerms terms = terms_of(moments);
  if (terms.last > fallen * terms.largest) {
    fail(
        fmt::format("too few moments (found {}, of which the last times 2l+1 is {:.3g}, allowed a series that has "
                    "fallen to {} of its largest, {:.3g})",
                    moments.size(), terms.last, fallen, terms.largest));
  }
  try {
    const std::string note = check_not_negative(moments);
    return note.empty() ? note : fmt::format("{}: {}", row, note);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", row, error.what()));
  }
}

}  // namespace

void check_tabulated_radius(double radius_um) {
  if (radius_um >= smallest_tabulated_radius_um && radius_um <= largest_tabulated_radius_um) return;
  throw InputError(fmt::format("effective radius: out of range (found {} um, allowed {} to {} um)", radius_um,
                               smallest_tabulated_radius_um, largest_tabulated_radius_um));
}

std::string check_droplet_row(const DropletTable& table, std::size_t row, const std::string& name) {
  // The smallest tabulated drop has 750000 m2/g if it stops a thousand times the light that falls on it. Numbers that
  // were never written are far above: 1e37 in netCDF.
  constexpr double largest_extinction_m2_per_g = 1e6;
  const double extinction = table.extinction_m2_per_g[row], albedo = table.single_scattering_albedo[row];
  if (!(extinction > 0 && extinction <= largest_extinction_m2_per_g)) {
    throw InputError(fmt::format("extinction at {} out of range (found {} m2/g, allowed > 0, up to {} m2/g)", name,
                                 extinction, largest_extinction_m2_per_g));
  }
  if (!(albedo >= 0 && albedo <= 1)) {
    throw InputError(
        fmt::format("single-scattering albedo at {} out of range (found {}, allowed 0 to 1)", name, albedo));
  }
  return check_moments(table.moments[row], name);
}

std::string check_droplet_table(const DropletTable& table) {
  std::string first_note;
  const std::size_t rows = table.size();
  if (rows == 0) throw InputError("no effective radius (allowed at least one)");
  if (!(table.wavelength_um >= 0 && std::isfinite(table.wavelength_um))) {
    throw InputError(
        fmt::format("wavelength out of range (found {} um, allowed > 0, 0 if not known)", table.wavelength_um));
  }
  if (table.extinction_m2_per_g.size() != rows || table.single_scattering_albedo.size() != rows ||
      table.moments.size() != rows) {
    throw InputError(fmt::format(
        "{} effective radii with {} extinctions, {} albedos, {} phase functions (allowed as "
        "many of each)",
        rows, table.extinction_m2_per_g.size(), table.single_scattering_albedo.size(), table.moments.size()));
  }
  for (std::size_t n = 0; n < rows; ++n) {
    const double radius = table.effective_radius_um[n];
    check_tabulated_radius(radius);
    if (n > 0 && !(radius > table.effective_radius_um[n - 1])) {
      throw InputError(fmt::format("effective radii do not ascend (found {} um after {} um)", radius,
                                   table.effective_radius_um[n - 1]));
    }
    std::string note = check_droplet_row(table, n, fmt::format("effective radius {} um", radius));
    if (first_note.empty()) first_note = std::move(note);
  }
  return first_note;
}

DropletMixture mixture_for(const DropletTable& table, double effective_radius_um) {
  const std::vector<double>& radius = table.effective_radius_um;
  constexpr double rounding = 1e-6;  // radii stored as floats
  if (!(effective_radius_um >= radius.front() * (1 - rounding) &&
        effective_radius_um <= radius.back() * (1 + rounding))) {
    throw InputError(fmt::format("effective radius outside the table (found {:.6g} um, allowed {:.6g} to {:.6g} um)",
                                 effective_radius_um, radius.front(), radius.back()));
  }
  if (radius.size() == 1) return {0, 0};
  const auto above = std::upper_bound(radius.begin() + 1, radius.end() - 1, effective_radius_um);
  const double low = *(above - 1), high = *above;
  const double r = std::clamp(effective_radius_um, low, high);
  return {static_cast<std::size_t>(above - radius.begin()) - 1, (1 / low - 1 / r) / (1 / low - 1 / high)};
}

MixedDroplets mix(const DropletTable& table, const DropletMixture& mixture) {
  const auto [lower, share] = mixture;
  const std::size_t upper = std::min(lower + 1, table.size() - 1);
  const double lower_extinction = (1 - share) * table.extinction_m2_per_g[lower];
  const double upper_extinction = share * table.extinction_m2_per_g[upper];
  const double lower_scattering = lower_extinction * table.single_scattering_albedo[lower];
  const double upper_scattering = upper_extinction * table.single_scattering_albedo[upper];
  return {lower_extinction + upper_extinction, lower_scattering + upper_scattering, upper_scattering};
}

DropletOptics droplet_optics(const DropletTable& table, double effective_radius_um) {
  const DropletMixture mixture = mixture_for(table, effective_radius_um);
  const MixedDroplets water = mix(table, mixture);
  const std::vector<double>& a = table.moments[mixture.lower];
  const std::vector<double>& b = table.moments[std::min(mixture.lower + 1, table.size() - 1)];
  const double weight = water.upper_share_of_scattering(mixture.upper_share);
  std::vector<double> moments(weight > 0 ? std::max(a.size(), b.size()) : a.size(), 0.0);
  for (std::size_t l = 0; l < moments.size(); ++l) {
    const double mixed = (l < a.size() ? (1 - weight) * a[l] : 0) + (l < b.size() ? weight * b[l] : 0);
    moments[l] = std::clamp(mixed, -1.0, 1.0);
  }
  moments[0] = 1;
  return {water.extinction_m2_per_g, water.single_scattering_albedo(), PhaseFunction::legendre(std::move(moments))};
}

}  // namespace cloudbow

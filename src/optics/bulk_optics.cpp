#include "cloudbow/optics/bulk_optics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/droplet_table.hpp"
#include "cloudbow/optics/spectral_mean.hpp"

namespace cloudbow {
namespace {

std::string name_of(const BulkTable& table) { return table.name.empty() ? "bulk table" : table.name; }

/// Quantities per mass that add up in mixtures and averages.
struct Sums {
  double extinction = 0;
  double scattering = 0;
  double forward = 0;  // k ssa g

  void add(double share, const BulkOptics& optics) {
    const double scattered = share * optics.extinction_m2_per_g * optics.single_scattering_albedo;
    extinction += share * optics.extinction_m2_per_g;
    scattering += scattered;
    forward += scattered * optics.asymmetry;
  }

  BulkOptics optics() const {
    BulkOptics result;
    result.extinction_m2_per_g = extinction;
    // Rounding can bring the ratios above 1.
    if (extinction > 0) result.single_scattering_albedo = std::min(1.0, scattering / extinction);
    if (scattering > 0)
      result.asymmetry = std::round(std::clamp(forward / scattering, -1.0, 1.0) / asymmetry_step) * asymmetry_step;
    return result;
  }
};

void check_ascending(const std::vector<double>& value, const char* what, const char* unit, const std::string& name) {
  if (value.empty()) throw InputError(fmt::format("{}: no {} (found 0, allowed at least one)", name, what));
  for (std::size_t n = 0; n < value.size(); ++n) {
    if (!(value[n] > 0 && std::isfinite(value[n])))
      throw InputError(fmt::format("{}: {} out of range (found {} {}, allowed > 0)", name, what, value[n], unit));
    if (n > 0 && !(value[n] > value[n - 1])) {
      throw InputError(fmt::format("{}: {} does not ascend (found {} after {} {}, allowed each once, in order)", name,
                                   what, value[n], value[n - 1], unit));
    }
  }
}

}  // namespace

void check_bulk_table(const BulkTable& table) {
  const std::string name = name_of(table);
  check_ascending(table.wavenumber_cm1, "wavenumber", "cm-1", name);
  check_ascending(table.effective_radius_um, "effective radius", "um", name);
  for (const double radius : {table.effective_radius_um.front(), table.effective_radius_um.back()}) {
    if (!(radius >= smallest_tabulated_radius_um && radius <= largest_tabulated_radius_um)) {
      throw InputError(
          fmt::format("{}: effective radius out of range (found {:.6g} um, allowed {} to {} um); look at "
                      "its units",
                      name, radius, smallest_tabulated_radius_um, largest_tabulated_radius_um));
    }
  }
  if (table.value.size() != table.wavenumber_cm1.size()) {
    throw InputError(fmt::format("{}: rows of another number than wavenumbers (found {}, allowed {})", name,
                                 table.value.size(), table.wavenumber_cm1.size()));
  }
  for (std::size_t n = 0; n < table.value.size(); ++n) {
    if (table.value[n].size() != table.effective_radius_um.size()) {
      throw InputError(fmt::format("{}: a row of another length than the radii (found {}, allowed {})", name,
                                   table.value[n].size(), table.effective_radius_um.size()));
    }
    for (std::size_t r = 0; r < table.value[n].size(); ++r) {
      const BulkOptics& optics = table.value[n][r];
      const auto reject = [&](const char* what, double found, const char* allowed) {
        throw InputError(fmt::format("{}: {} out of range (found {:.6g} at {:.6g} cm-1 and {:.6g} um, allowed {})",
                                     name, what, found, table.wavenumber_cm1[n], table.effective_radius_um[r],
                                     allowed));
      };
      const double k = optics.extinction_m2_per_g, ssa = optics.single_scattering_albedo, g = optics.asymmetry;
      if (!(k > 0 && std::isfinite(k))) reject("mass extinction", k, "> 0 m2/g");
      if (!(ssa >= 0 && ssa <= 1)) reject("single-scattering albedo", ssa, "0 to 1");
      if (!(g >= -1 && g <= 1)) reject("asymmetry parameter", g, "-1 to 1");
    }
  }
}

std::vector<BulkOptics> average_over(const BulkTable& table, std::span<const double> wavenumber_cm1,
                                     std::span<const double> weight) {
  const NodeShares nodes = node_shares(table.wavenumber_cm1, wavenumber_cm1, weight, name_of(table));
  if (nodes.below + nodes.above > largest_extended_share) {
    const auto [first, last] = std::minmax_element(wavenumber_cm1.begin(), wavenumber_cm1.end());
    throw InputError(fmt::format(
        "{}: too short for {:.6g} to {:.6g} cm-1 (found {:.6g} to {:.6g}, {:.0f} % beyond, allowed {:.0f}); "
        "take another table",
        name_of(table), *first, *last, table.wavenumber_cm1.front(), table.wavenumber_cm1.back(),
        100 * (nodes.below + nodes.above), 100 * largest_extended_share));
  }
  std::vector<Sums> sums(table.effective_radius_um.size());
  for (std::size_t n = 0; n < nodes.share.size(); ++n) {
    if (nodes.share[n] == 0) continue;
    for (std::size_t r = 0; r < sums.size(); ++r) sums[r].add(nodes.share[n], table.value[n][r]);
  }
  std::vector<BulkOptics> result;
  for (const Sums& sum : sums) result.push_back(sum.optics());
  return result;
}

BulkOptics at_radius(const BulkTable& table, std::span<const BulkOptics> averaged, double effective_radius_um) {
  const std::vector<double>& radius = table.effective_radius_um;
  assert(averaged.size() == radius.size() && !radius.empty());
  if (!(effective_radius_um >= radius.front() && effective_radius_um <= radius.back())) {
    throw InputError(
        fmt::format("{}: effective radius outside the table (found {:.6g} um, allowed {:.6g} to {:.6g} um)",
                    name_of(table), effective_radius_um, radius.front(), radius.back()));
  }
  const auto above = std::upper_bound(radius.begin(), radius.end(), effective_radius_um);
  const auto upper = std::min<std::size_t>(static_cast<std::size_t>(above - radius.begin()), radius.size() - 1);
  const std::size_t lower = upper == 0 ? 0 : upper - 1;
  const double share =
      upper == lower ? 0 : (1 / radius[lower] - 1 / effective_radius_um) / (1 / radius[lower] - 1 / radius[upper]);
  Sums sums;
  sums.add(1 - share, averaged[lower]);
  sums.add(share, averaged[upper]);
  return sums.optics();
}

}  // namespace cloudbow

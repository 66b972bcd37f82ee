#include "air_profile.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "cloudbow/core/sandbox.hpp"
#include "cloudbow/core/text_case.hpp"
#include "les_vocabulary.hpp"
#include "netcdf_input.hpp"
#include "text_tokens.hpp"

namespace cloudbow {
namespace {

constexpr const char* allowed_kinds = "a profile of the air as text columns or netCDF";

void order_and_check(AirProfile& profile) {
  std::vector<double>&z = profile.height_m, &density = profile.density_kg_m3;
  if (z.size() > 1 && z.front() > z.back()) {
    std::reverse(z.begin(), z.end());
    std::reverse(density.begin(), density.end());
  }
  if (z.size() < 2) fail_import(profile.file, "too few heights (found {}, allowed 2 and more)", z.size());
  for (std::size_t n = 0; n < z.size(); ++n) {
    if (n > 0 && !(z[n] > z[n - 1]))
      fail_import(profile.file, "heights are not monotonic (found {:.6g} m next to {:.6g} m)", z[n], z[n - 1]);
    if (density[n] >= 0.01 && density[n] <= 2) continue;
    fail_import(profile.file,
                "the density at {:.6g} m is {:.6g} kg/m3 (allowed 0.01 to 2 kg/m3); correct it, or its unit", z[n],
                density[n]);
  }
}

// -- text -------------------------------------------------------------------------------------------------------------

struct HeadingColumn {
  std::size_t index;
  double factor;
};

/// A comment that names columns, as "# z(m) rho(kg/m3)".
struct DensityHeading {
  std::size_t count = 0;
  std::optional<HeadingColumn> height, density;
};

DensityHeading heading_in(const TextLines& lines, std::string line) {
  std::replace(line.begin(), line.end(), '#', ' ');
  DensityHeading heading;
  for (const std::string_view word : split_words(line)) {
    const auto bracket = std::min(word.find_first_of("(["), word.size());
    const std::string name = lower_case(std::string(word.substr(0, bracket)));
    std::string unit(word.substr(bracket));
    std::erase_if(unit, [](char c) { return std::string_view("()[]").find(c) != std::string_view::npos; });
    const bool is_height = name == "z" || name == "height" || name == "altitude";
    const bool is_density =
        name == "rho" || name == "density" || name == "air_density" || name == "rhobf" || name == "rhoref";
    if ((is_height || is_density) && !unit.empty()) {
      const UnitTable& table = is_height ? length_units : density_units;
      const auto factor = factor_of(table, unit);
      if (!factor) {
        lines.fail("column {}: unit not known (found \"{}\", allowed {}); write it as in \"# z(m) rho(kg/m3)\"", name,
                   unit, table.allowed);
      }
      (is_height ? heading.height : heading.density) = HeadingColumn{heading.count, *factor};
    }
    ++heading.count;
  }
  return heading;
}

/// Nothing if no comment names heights and densities.
std::optional<AirProfile> density_of_text(const std::filesystem::path& file) {
  TextLines lines(file);
  AirProfile profile{file, {}, {}};
  std::optional<DensityHeading> heading;
  for (std::string line; lines.next(line);) {
    if (is_comment(line)) {
      if (heading) continue;
      const DensityHeading found = heading_in(lines, line);
      if (found.height && found.density) heading = found;
      continue;
    }
    if (!heading && split_words(line).size() == 2) {
      lines.fail("two columns without names (found no comment, allowed \"# z(m) rho(kg/m3)\" before the numbers)");
    }
    if (!heading) return std::nullopt;
    const std::vector<double> number = lines.numbers(line, heading->count, "a profile");
    profile.height_m.push_back(number[heading->height->index] * heading->height->factor);
    profile.density_kg_m3.push_back(number[heading->density->index] * heading->density->factor);
  }
  if (!heading) return std::nullopt;
  order_and_check(profile);
  return profile;
}

// -- netCDF -----------------------------------------------------------------------------------------------------------

const Names density_names{"rho",  "RHO",     "rhobf", "rhof",    "rhoref",      "rho0", "RHO0",    "dn0",    "DN0",
                          "rhon", "rho_air", "rhoh",  "density", "air_density", "RHOD", "RHODREF", "rho_ref"};
const Names height_names{"z", "zt", "zu", "zn", "height", "altitude", "alt", "Z", "zc", "level"};

/// The one profile of a variable: of several times the last.
std::vector<double> last_profile(const NetcdfInput& input, const NetcdfVariable& variable) {
  std::vector<std::size_t> start(variable.length.size(), 0), count = variable.length;
  for (std::size_t n = 0; n < count.size(); ++n) {
    if (axis_of_name(variable.dimension[n]) != 3 || count[n] == 0) continue;
    start[n] = count[n] - 1;
    count[n] = 1;
  }
  if (std::count_if(count.begin(), count.end(), [](std::size_t n) { return n != 1; }) > 1) return {};
  return input.read(variable, start, count);
}

std::optional<AirProfile> density_of_netcdf(const std::filesystem::path& file) {
  const NetcdfInput input(file, true);  // MicroHH has groups
  for (const std::string& name : density_names) {
    const NetcdfVariable* density = input.find(name);
    if (density == nullptr || density->length.empty()) continue;
    AirProfile profile{file, {}, last_profile(input, *density)};
    if (profile.density_kg_m3.size() < 2) continue;
    const auto unit = factor_of(density_units, density->units);
    if (!unit && is_unit_given(density->units)) {
      fail_import(file, "'{}': unit not known (found \"{}\", allowed {})", name, density->units, density_units.allowed);
    }
    for (double& value : profile.density_kg_m3) value *= unit.value_or(1);
    Names candidates = density->dimension;
    candidates.insert(candidates.end(), height_names.begin(), height_names.end());
    for (const std::string& candidate : candidates) {
      const NetcdfVariable* height = input.find(candidate);
      if (height == nullptr || height->length != std::vector<std::size_t>{profile.density_kg_m3.size()}) continue;
      if (std::find(density->dimension.begin(), density->dimension.end(), height->dimension[0]) ==
          density->dimension.end())
        continue;
      const auto metre = factor_of(length_units, height->units);
      if (!metre) {
        fail_import(
            file,
            "'{}': the heights of '{}' have no unit of length (found \"{}\", allowed {}); set its attribute units",
            candidate, name, height->units, length_units.allowed);
      }
      profile.height_m = input.read(*height);
      for (double& z : profile.height_m) z *= *metre;
      order_and_check(profile);
      return profile;
    }
    fail_import(file, "'{}': no heights beside this density (found no variable of its dimension '{}'); add one, in m",
                name, density->dimension.back());
  }
  return std::nullopt;
}

}  // namespace

double AirProfile::density_at(double height) const {
  const std::size_t last = height_m.size() - 1;
  const double lowest = 2 * height_m[0] - height_m[1], highest = 2 * height_m[last] - height_m[last - 1];
  if (!(height >= std::min(lowest, 0.0) && height <= highest)) {
    fail_import(file,
                "the profile does not reach the cloud (found heights {:.6g} to {:.6g} m, needed {:.6g} m); extend it",
                height_m.front(), height_m.back(), height);
  }
  const auto above = std::upper_bound(height_m.begin(), height_m.end(), height);
  const auto n = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(above - height_m.begin(), 1, static_cast<std::ptrdiff_t>(last)));
  const double part = (height - height_m[n - 1]) / (height_m[n] - height_m[n - 1]);
  return density_kg_m3[n - 1] * std::pow(density_kg_m3[n] / density_kg_m3[n - 1], part);
}

AirProfile read_air_profile(const std::filesystem::path& file) {
  std::optional<AirProfile> profile;
  if (begins_as_netcdf(file, allowed_kinds)) {
    profile = after_sandbox(file, {.library = "netCDF"}, [&] { return density_of_netcdf(file); });
  } else {
    constexpr std::uintmax_t most_text_bytes = 100000000;
    check_input(file, allowed_kinds, most_text_bytes);
    profile = density_of_text(file);
  }
  if (profile) return *profile;
  AirProfile by_gas_law{file, {}, {}};
  by_gas_law.atmosphere = read_atmosphere(file);
  by_gas_law.height_m = by_gas_law.atmosphere->height_m;
  for (const double z : by_gas_law.height_m)
    by_gas_law.density_kg_m3.push_back(std::clamp(by_gas_law.atmosphere->density_at(z), 1e-12, 2.0));
  return by_gas_law;
}

}  // namespace cloudbow

// A map in netCDF, or in HDF5 by netCDF's library.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>

#include "albedo_map_readers.hpp"
#include "netcdf_input.hpp"

namespace cloudbow {
namespace {

/// The two dimensions of a map, by their places among those of its variable.
struct Plane {
  std::size_t slow;
  std::size_t fast;
};

/// Leaves out dimensions of length 1 while there are more than two.
std::optional<Plane> plane_of(const NetcdfVariable& variable) {
  if (variable.length.size() < 2) return std::nullopt;
  std::size_t first = 0, last = variable.length.size() - 1;
  while (last - first > 1 && variable.length[first] == 1) ++first;
  while (last - first > 1 && variable.length[last] == 1) --last;
  if (last - first > 1) return std::nullopt;
  return Plane{first, last};
}

std::string described(const NetcdfVariable& variable) {
  std::string shape;
  for (std::size_t n = 0; n < variable.length.size(); ++n)
    shape += fmt::format("{}{} = {}", n == 0 ? "" : ", ", variable.dimension[n], variable.length[n]);
  return fmt::format("{}({})", variable.name, shape);
}

const NetcdfVariable& find_map(const std::filesystem::path& file, const NetcdfInput& input,
                               const MapQuantity& quantity) {
  const NetcdfVariable* named = nullptr;
  for (const char* name : quantity.variables) {
    if (named == nullptr) named = input.find(name);
  }
  const NetcdfVariable* found = named;
  std::string names;
  int planes = 0;
  for (const NetcdfVariable& variable : input.variables()) {
    names += (names.empty() ? "" : ", ") + described(variable);
    if (found == &variable || !plane_of(variable) || named != nullptr) continue;
    found = &variable;
    ++planes;
  }
  if (found == nullptr || planes > 1 || !plane_of(*found)) {
    fail_import(file,
                "no map of {} (found variables {}; allowed '{}', or only one, with the dimensions y, x and others of "
                "length 1)",
                quantity.name, names.empty() ? "none" : names, quantity.variables.front());
  }
  return *found;
}

/// Names of the dimensions may exchange them.
bool is_transposed(const std::filesystem::path& file, const NetcdfVariable& map, Plane plane) {
  const int slow = axis_of_name(map.dimension[plane.slow]), fast = axis_of_name(map.dimension[plane.fast]);
  if (std::max(slow, fast) > 1 || (slow >= 0 && slow == fast))
    fail_import(file, "'{}': not a map (found the dimensions of {}, allowed y, x)", map.name, described(map));
  return slow == 0 || fast == 1;
}

struct Axis {
  std::size_t place = 0;
  std::size_t length = 1;
  bool descends = false;
  std::optional<double> length_m{};
};

Axis read_axis(const std::filesystem::path& file, const NetcdfInput& input, const NetcdfVariable& map,
               std::size_t place) {
  const std::string& name = map.dimension[place];
  Axis axis{place, map.length[place], false, {}};
  const NetcdfVariable* variable = input.find(name);
  if (variable == nullptr || variable->length.size() != 1 || variable->length[0] != axis.length || axis.length < 2)
    return axis;
  const std::vector<double> centre = input.read(*variable);
  const auto steps = static_cast<double>(axis.length - 1);
  const double step = (centre.back() - centre.front()) / steps;
  constexpr double slack = 0.25;  // of a step: coordinates in floats
  for (std::size_t n = 0; n < centre.size(); ++n) {
    if (step != 0 && std::abs(centre[n] - centre.front() - static_cast<double>(n) * step) <= slack * std::abs(step))
      continue;
    fail_import(file,
                "'{}': uneven coordinates (found {} at index {}, allowed equal steps of {:.6g}); interpolate the map",
                name, centre[n], n, step);
  }
  axis.descends = step < 0;
  if (const auto factor = factor_of(length_units, variable->units))
    axis.length_m = std::abs(step) * static_cast<double>(axis.length) * *factor;
  return axis;
}

double unit_factor(const std::filesystem::path& file, const NetcdfVariable& map, const UnitTable& units) {
  if (const auto factor = factor_of(units, lower_case(map.units))) return *factor;
  fail_import(file, "'{}': unit not known (found '{}', allowed {})", map.name, map.units, units.allowed);
}

GroundMap read_map(const std::filesystem::path& file, const NetcdfInput& input, const MapQuantity& quantity) {
  const NetcdfVariable& variable = find_map(file, input, quantity);
  const Plane plane = *plane_of(variable);
  const bool transposed = is_transposed(file, variable, plane);
  const Axis x = read_axis(file, input, variable, transposed ? plane.slow : plane.fast);
  const Axis y = read_axis(file, input, variable, transposed ? plane.fast : plane.slow);
  check_map_size(file, static_cast<double>(x.length), static_cast<double>(y.length));
  const double factor = unit_factor(file, variable, quantity.units);

  GroundMap map{static_cast<int>(x.length), static_cast<int>(y.length), {}, {x.length_m, y.length_m}};
  map.value.resize(x.length * y.length);
  const std::size_t fast_length = variable.length[plane.fast], slow_length = variable.length[plane.slow];
  constexpr std::size_t values_at_once = 1 << 20;
  const std::size_t rows_at_once = std::max<std::size_t>(1, values_at_once / fast_length);
  std::vector<std::size_t> start(variable.length.size(), 0), count(variable.length.size(), 1);
  count[plane.fast] = fast_length;
  for (std::size_t first = 0; first < slow_length; first += rows_at_once) {
    start[plane.slow] = first;
    count[plane.slow] = std::min(rows_at_once, slow_length - first);
    const std::vector<double> value = input.read(variable, start, count);
    for (std::size_t n = 0; n < value.size(); ++n) {
      const std::size_t slow = first + n / fast_length, fast = n % fast_length;
      const std::size_t at_x = transposed ? slow : fast, at_y = transposed ? fast : slow;
      const std::size_t i = x.descends ? x.length - 1 - at_x : at_x, j = y.descends ? y.length - 1 - at_y : at_y;
      map.value[j * x.length + i] = static_cast<float>(value[n] * factor);
    }
  }
  return map;
}

}  // namespace

GroundMap read_netcdf_map(const std::filesystem::path& file, const MapQuantity& quantity) {
  std::optional<NetcdfInput> input;
  try {
    input.emplace(file);
  } catch (const InputError& error) {
    const std::string why = std::string(error.what()).substr(file.string().size() + 2);
    fail_import(file, "neither PNG nor HDF5 nor netCDF that can be read ({})", why);
  }
  return read_map(file, *input, quantity);
}

}  // namespace cloudbow

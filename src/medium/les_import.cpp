// Output of large-eddy simulations in netCDF.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "cloudbow/core/rehearsal.hpp"
#include "import_parts.hpp"
#include "les_vocabulary.hpp"
#include "netcdf_input.hpp"

namespace cloudbow {
namespace {

class LesReader {
 public:
  explicit LesReader(const CloudImportOptions& options)
      : options_(options), file_(options.file), input_(options.file) {}

  LevelledCloud read() {
    const NetcdfVariable& water = find(options_.variable, kWater, "liquid water", "--variable");
    note("liquid water: {}", described(water, options_.units.empty() ? water.units : options_.units));
    assign_axes(water);
    check_time(water);
    set_columns();
    set_levels();
    cloud_.quantity = "liquid_water_content";
    cloud_.density = read_field(water, "liquid water");
    check_values(water, cloud_.density);
    to_liquid_water_content(water);
    add_effective_radius();
    return std::move(cloud_);
  }

 private:
  struct Axis {
    bool is_there = false;
    std::string name{};
    std::size_t length = 1;
  };

  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    fail_import(file_, text, std::forward<Args>(args)...);
  }
  template <class... Args>
  void note(fmt::format_string<Args...> text, Args&&... args) {
    cloud_.notes.push_back(fmt::format(text, std::forward<Args>(args)...));
  }

  static std::string described(const NetcdfVariable& variable, const std::string& units) {
    std::string shape;
    for (std::size_t n = 0; n < variable.length.size(); ++n) {
      shape += fmt::format("{}{} = {}", n == 0 ? "" : ", ", variable.dimension[n], variable.length[n]);
    }
    return fmt::format("'{}' ({}) [{}]", variable.name, shape, units.empty() ? "unit not said" : units);
  }

  std::string fields_there() const {
    std::string names;
    int count = 0;
    for (const NetcdfVariable& variable : input_.variables()) {
      if (variable.length.size() < 2) continue;
      if (++count > 30) return names + ", ...";
      names += (names.empty() ? "" : ", ") + variable.name;
    }
    return names.empty() ? "none" : names;
  }

  const NetcdfVariable* find_any(const std::string& given, const Names& guesses, const std::string& option) const {
    if (!given.empty()) {
      const NetcdfVariable* variable = input_.find(given);
      if (variable == nullptr) {
        fail("no variable '{}' (as {} says; fields in the file: {})", given, option, fields_there());
      }
      return variable;
    }
    for (const std::string& name : guesses) {
      if (const NetcdfVariable* variable = input_.find(name); variable != nullptr && !variable->length.empty())
        return variable;
    }
    return nullptr;
  }

  const NetcdfVariable& find(const std::string& given, const Names& guesses, const char* what,
                             const std::string& option) const {
    if (const NetcdfVariable* variable = find_any(given, guesses, option)) return *variable;
    std::string tried;
    for (const std::string& name : guesses) tried += (tried.empty() ? "" : ", ") + name;
    fail("no variable of {} (looked for {}; fields in the file: {}) name it with {}", what, tried, fields_there(),
         option);
  }

  /// What one of the unit in the file is; guessed only where the file does not say.
  double factor(const NetcdfVariable& variable, const std::string& units, const UnitTable& table, double guess,
                const char* guessed_unit) {
    if (const auto known = factor_of(table, units)) return *known;
    if (is_unit_given(units))
      fail("'{}': unit not known (found '{}', allowed {})", variable.name, units, table.allowed);
    note("GUESSED unit of '{}': {}", variable.name, guessed_unit);
    return guess;
  }

  // -- axes -------------------------------------------------------------------------------------------------------

  void assign_axes(const NetcdfVariable& variable) {
    const std::size_t rank = variable.length.size();
    if (rank < 1 || rank > 4)
      fail("'{}': wrong number of dimensions (found {}, allowed z; z, x; z, y, x; with or without time)", variable.name,
           rank);
    std::vector<int> role(rank, -1);
    for (std::size_t n = 0; n < rank; ++n) role[n] = axis_of_dimension(variable.dimension[n]);
    // Names that say nothing stand for what is customary: (time, z, y, x), the last of them first.
    for (std::size_t n = 0; n < rank; ++n) {
      if (role[n] >= 0) continue;
      const int customary = static_cast<int>(rank - 1 - n);
      if (rank < 3 || std::find(role.begin(), role.end(), customary) != role.end()) {
        fail(
            "'{}': dimension '{}' is none that is known (allowed: say which with --x-axis, --y-axis, --z-axis, "
            "--time-axis)",
            variable.name, variable.dimension[n]);
      }
      role[n] = customary;
      note("GUESSED axis: dimension '{}' is {}", variable.dimension[n],
           kAxisNames[static_cast<std::size_t>(customary)]);
    }
    for (std::size_t n = 0; n < rank; ++n) {
      auto& axis = axes_[static_cast<std::size_t>(role[n])];
      if (axis.is_there) {
        fail("'{}': dimensions '{}' and '{}' are both taken for {} (allowed: say which with --{}-axis)", variable.name,
             axis.name, variable.dimension[n], kAxisNames[static_cast<std::size_t>(role[n])],
             kAxisNames[static_cast<std::size_t>(role[n])]);
      }
      axis = {true, variable.dimension[n], variable.length[n]};
    }
    if (!axes_[2].is_there)
      fail("'{}': no vertical dimension (found only others; say which with --z-axis)", variable.name);
    for (std::size_t a = 0; a < 3; ++a) {
      if (axes_[a].is_there && axes_[a].length == 0)
        fail("axis '{}' has length 0 (allowed: at least 1)", axes_[a].name);
    }
    check_import_size(options_, static_cast<double>(axes_[0].length), static_cast<double>(axes_[1].length),
                      static_cast<double>(axes_[2].length));
    cloud_.nx = static_cast<int>(axes_[0].length);
    cloud_.ny = static_cast<int>(axes_[1].length);
  }

  int axis_of_dimension(const std::string& dimension) const {
    for (std::size_t a = 0; a < 4; ++a) {
      if (!options_.axes[a].empty() && options_.axes[a] == dimension) return static_cast<int>(a);
    }
    const int guess = axis_of_name(dimension);
    return guess >= 0 && !options_.axes[static_cast<std::size_t>(guess)].empty() ? -1 : guess;
  }

  void check_time(const NetcdfVariable& water) const {
    const Axis& time = axes_[3];
    if (!time.is_there) {
      if (options_.time > 0) fail("'{}' has no time axis (found --time {}, allowed 0)", water.name, options_.time);
      return;
    }
    if (time.length == 0)
      fail("time axis '{}' has length 0: there is no field in the file (allowed: at least 1)", time.name);
    if (options_.time >= time.length) {
      fail("--time is beyond the time axis '{}' (found {}, allowed 0 to {})", time.name, options_.time,
           time.length - 1);
    }
  }

  /// Coordinates of a dimension in metres; empty where the file has none.
  std::vector<double> coordinates(const Axis& axis, const NetcdfVariable* coordinate) {
    if (coordinate == nullptr) return {};
    std::vector<std::size_t> start(coordinate->length.size(), 0), count = coordinate->length;
    if (count.size() == 2 && coordinate->dimension[0] == axes_[3].name) {  // levels that a file repeats at every time
      start[0] = options_.time;
      count[0] = 1;
    } else if (count.size() != 1) {
      fail("'{}': not a list of coordinates (found {} dimensions, allowed 1)", coordinate->name, count.size());
    }
    if (count.back() != axis.length) return {};
    std::vector<double> value = input_.read(*coordinate, start, count);
    for (const double number : value) {
      if (!std::isfinite(number))
        fail("'{}': a coordinate is not finite or missing (found {})", coordinate->name, number);
    }
    const double extent = std::abs(value.back() - value.front());
    const bool seems_km = extent < 0.5 * static_cast<double>(value.size());
    const double unit = factor(*coordinate, coordinate->units, kLength, seems_km ? 1e3 : 1, seems_km ? "km" : "m");
    for (double& number : value) number *= unit;
    return value;
  }

  void set_columns() {
    std::array<double, 2> size{};
    std::array<double, 2> low{};
    for (std::size_t a = 0; a < 2; ++a) {
      const Axis& axis = axes_[a];
      if (options_.voxel_size_m) {
        size[a] = (*options_.voxel_size_m)[a];
        continue;
      }
      auto centre =
          axis.is_there && axis.length > 1 ? coordinates(axis, input_.find(axis.name)) : std::vector<double>{};
      if (centre.empty()) continue;
      size[a] = uniform_spacing(file_, axis.name, centre);
      low[a] = centre.front() - 0.5 * size[a];
    }
    // A single row or column is as wide as the other way.
    for (std::size_t a = 0; a < 2; ++a) {
      if (size[a] == 0 && axes_[a].length == 1) size[a] = size[1 - a];
    }
    for (std::size_t a = 0; a < 2; ++a) {
      if (!(size[a] > 0))
        fail("no coordinates of '{}' (found no variable of this name and length, allowed with --voxel-size-m)",
             axes_[a].name.empty() ? kAxisNames[a] : axes_[a].name);
    }
    cloud_.dx_m = size[0];
    cloud_.dy_m = size[1];
    cloud_.x_min_m = low[0];
    cloud_.y_min_m = low[1];
  }

  void set_levels() {
    const Axis& axis = axes_[2];
    const NetcdfVariable* coordinate = input_.find(axis.name);
    for (const char* other : {"z", "zt", "height", "altitude", "z_t", "zu"}) {
      if (coordinate != nullptr) break;
      const NetcdfVariable* candidate = input_.find(other);
      if (candidate != nullptr && !candidate->dimension.empty() && candidate->dimension.back() == axis.name)
        coordinate = candidate;
    }
    std::vector<double> centre = coordinates(axis, coordinate);
    if (centre.empty()) {
      if (!options_.voxel_size_m) {
        fail("no heights of '{}' (found no variable of this name and length, allowed with --voxel-size-m)", axis.name);
      }
      for (std::size_t k = 0; k <= axis.length; ++k)
        cloud_.z_edge_m.push_back(static_cast<double>(k) * (*options_.voxel_size_m)[2]);
      note("levels: {} of {} m from the ground, as --voxel-size-m says", axis.length, (*options_.voxel_size_m)[2]);
      return;
    }
    if (centre.size() == 1) {
      if (!options_.voxel_size_m)
        fail("'{}': one level alone does not say how thick it is (allowed with --voxel-size-m)", axis.name);
      const double half = 0.5 * (*options_.voxel_size_m)[2];
      cloud_.z_edge_m = {centre[0] - half, centre[0] + half};
      return;
    }
    descending_ = centre.front() > centre.back();
    if (descending_) std::reverse(centre.begin(), centre.end());
    for (std::size_t k = 1; k < centre.size(); ++k) {
      if (!(centre[k] > centre[k - 1])) {
        fail("'{}': levels are not monotonic (found {} m next to {} m, allowed ascending or descending)",
             coordinate->name, centre[k], centre[k - 1]);
      }
    }
    cloud_.z_edge_m = edges_between(centre);
    note("levels: '{}', {} centres of cells that meet halfway", coordinate->name, centre.size());
  }

  // -- fields -----------------------------------------------------------------------------------------------------

  /// Values on all cells, in the order of LevelledCloud, from a variable that may lack any of the axes.
  std::vector<float> read_field(const NetcdfVariable& variable, const char* what) const {
    const std::size_t rank = variable.length.size();
    std::vector<std::size_t> start(rank, 0), count = variable.length;
    std::array<std::size_t, 3> stride{0, 0, 0};
    std::size_t step = 1;
    for (std::size_t n = rank; n-- > 0;) {
      const auto axis = std::find_if(axes_.begin(), axes_.end(),
                                     [&](const Axis& a) { return a.is_there && a.name == variable.dimension[n]; });
      if (axis == axes_.end() || axis->length != variable.length[n]) {
        fail("'{}' ({}): dimension '{}' is not one of the liquid water's (allowed: some of those)", variable.name, what,
             variable.dimension[n]);
      }
      const auto a = static_cast<std::size_t>(axis - axes_.begin());
      if (a == 3) {
        start[n] = options_.time;
        count[n] = 1;
      } else {
        stride[a] = step;
        step *= variable.length[n];
      }
    }
    const std::vector<double> read = input_.read(variable, start, count);
    const std::size_t nx = axes_[0].length, ny = axes_[1].length, nz = axes_[2].length;
    std::vector<float> value;
    value.reserve(nx * ny * nz);
    for (std::size_t k = 0; k < nz; ++k) {
      const std::size_t level = descending_ ? nz - 1 - k : k;
      for (std::size_t j = 0; j < ny; ++j) {
        for (std::size_t i = 0; i < nx; ++i) {
          value.push_back(static_cast<float>(read[level * stride[2] + j * stride[1] + i * stride[0]]));
        }
      }
    }
    return value;
  }

  /// Advection leaves water below zero of the size of rounding; more than that is an error.
  void check_values(const NetcdfVariable& variable, std::vector<float>& value) {
    constexpr double rounding = 1e-6;  // of the largest value
    float largest = 0;
    for (const float v : value) largest = std::max(largest, std::isfinite(v) ? v : 0);
    std::size_t below = 0;
    for (std::size_t n = 0; n < value.size(); ++n) {
      if (value[n] >= 0 && std::isfinite(value[n])) continue;
      if (!std::isfinite(value[n]) || value[n] < -rounding * largest) {
        const std::size_t nx = axes_[0].length, ny = axes_[1].length;
        fail("'{}': cell ({}, {}, {}) has the value {} (allowed: finite numbers >= 0)", variable.name, n % nx,
             n / nx % ny, n / nx / ny, std::isnan(value[n]) ? "NaN or missing" : fmt::format("{}", value[n]));
      }
      value[n] = 0;
      ++below;
    }
    if (below > 0) note("'{}': {} cells barely below 0 count as 0", variable.name, below);
  }

  void to_liquid_water_content(const NetcdfVariable& water) {
    const std::string units = options_.units.empty() ? water.units : options_.units;
    if (const auto content = factor_of(kContent, units)) {
      for (float& value : cloud_.density) value = static_cast<float>(value * *content);
      return;
    }
    double ratio = 1;
    if (const auto known = factor_of(kRatio, units)) {
      ratio = *known;
    } else if (is_unit_given(units)) {
      fail("'{}': unit not known (found '{}', allowed {}, {}; --units says it where the file is wrong)", water.name,
           units, kRatio.allowed, kContent.allowed);
    } else {
      const float largest = *std::max_element(cloud_.density.begin(), cloud_.density.end());
      const bool is_kg = largest < 0.05;  // more than 50 g of cloud water in a kg of air there is not
      const bool is_content = lower_case(water.name) == "lwc";
      note("GUESSED unit of '{}': {} (largest value {:.4g}); --units says it", water.name,
           is_content ? (is_kg ? "kg/m3" : "g/m3")
           : is_kg    ? "kg/kg"
                      : "g/kg",
           largest);
      if (is_content) {
        for (float& value : cloud_.density) value = static_cast<float>(value * (is_kg ? 1e3 : 1));
        return;
      }
      ratio = is_kg ? 1 : 1e-3;
    }
    const std::vector<float> air = air_density();
    for (std::size_t n = 0; n < cloud_.density.size(); ++n) {
      cloud_.density[n] = static_cast<float>(cloud_.density[n] * ratio * air[n] * 1e3);
    }
  }

  void check_positive(const NetcdfVariable& variable, const std::vector<float>& value) const {
    for (const float v : value) {
      if (!(v > 0) || !std::isfinite(v))
        fail("'{}' holds the value {} (allowed: finite numbers > 0)", variable.name, v);
    }
  }

  const std::vector<float>& air_density() {
    if (!air_.empty()) return air_;
    const bool by_gas_law = options_.air_density.empty() && !options_.pressure.empty();
    const NetcdfVariable* density = by_gas_law ? nullptr : find_any(options_.air_density, kAirDensity, "--air-density");
    if (density != nullptr) {
      air_ = read_field(*density, "air density");
      check_positive(*density, air_);
      const double unit = factor(*density, density->units, kDensity, 1, "kg/m3");
      for (float& value : air_) value = static_cast<float>(value * unit);
      note("air density: '{}'", density->name);
      return air_;
    }
    const NetcdfVariable* pressure = find_any(options_.pressure, kPressure, "--pressure");
    const NetcdfVariable* temperature = find_any(options_.temperature, kTemperature, "--temperature");
    if (pressure == nullptr || temperature == nullptr) {
      fail(
          "liquid water per kg of air needs the air's density (found neither it nor pressure with temperature; fields "
          "in the file: {}) name --air-density, or --pressure and --temperature",
          fields_there());
    }
    constexpr double gas_constant = 287.05;  // dry air, J/(kg K); vapour would change the density by less than 1 %
    air_ = read_field(*pressure, "pressure");
    check_positive(*pressure, air_);
    const std::vector<float> kelvin = read_field(*temperature, "temperature");
    check_positive(*temperature, kelvin);
    const double highest = *std::max_element(air_.begin(), air_.end());
    const double unit =
        factor(*pressure, pressure->units, kPressureUnits, highest < 2000 ? 100 : 1, highest < 2000 ? "hPa" : "Pa");
    factor(*temperature, temperature->units, kTemperatureUnits, 1, "K");
    for (std::size_t n = 0; n < air_.size(); ++n)
      air_[n] = static_cast<float>(air_[n] * unit / (gas_constant * kelvin[n]));
    note("air density: '{}' / (287.05 J/(kg K) '{}')", pressure->name, temperature->name);
    return air_;
  }

  void add_effective_radius() {
    const NetcdfVariable* radius = options_.droplet_number.empty() && options_.droplet_number_cm3 <= 0
                                       ? find_any(options_.effective_radius, kEffectiveRadius, "--effective-radius")
                                       : nullptr;
    if (radius != nullptr) {
      cloud_.effective_radius_um = read_field(*radius, "effective radius");
      const float largest = *std::max_element(cloud_.effective_radius_um.begin(), cloud_.effective_radius_um.end());
      const double unit =
          factor(*radius, radius->units, kRadius, largest < 1e-2 ? 1e6 : 1, largest < 1e-2 ? "m" : "um");
      for (float& value : cloud_.effective_radius_um) value = static_cast<float>(value * unit);
      check_radii("'" + radius->name + "'");
      note("effective radius: '{}'", radius->name);
      return;
    }
    std::vector<float> number;
    std::string source;
    if (options_.droplet_number_cm3 > 0) {
      number.assign(cloud_.density.size(), static_cast<float>(options_.droplet_number_cm3 * 1e6));
      source = fmt::format("{} per cm3", options_.droplet_number_cm3);
    } else {
      const NetcdfVariable* variable = find_any(options_.droplet_number, kDropletNumber, "--droplet-number");
      if (variable == nullptr) return;
      number = droplets_per_m3(*variable);
      source = "'" + variable->name + "'";
    }
    cloud_.effective_radius_um.assign(cloud_.density.size(), 0);
    for (std::size_t n = 0; n < number.size(); ++n) {
      if (!(cloud_.density[n] > 0)) continue;
      cloud_.effective_radius_um[n] =
          static_cast<float>(effective_radius_of_droplets(cloud_.density[n], number[n], options_.radius_ratio_cubed));
    }
    check_radii("effective radius from " + source);
    note("effective radius: (3 L / (4 pi rho_w k N))^(1/3) with N = {}, k = {}", source, options_.radius_ratio_cubed);
  }

  std::vector<float> droplets_per_m3(const NetcdfVariable& variable) {
    std::vector<float> number = read_field(variable, "droplet number");
    if (const auto per_mass = factor_of(kNumberPerMass, variable.units)) {
      const std::vector<float>& air = air_density();
      for (std::size_t n = 0; n < number.size(); ++n) number[n] = static_cast<float>(number[n] * *per_mass * air[n]);
      return number;
    }
    if (const auto per_volume = factor_of(kNumberPerVolume, variable.units)) {
      for (float& value : number) value = static_cast<float>(value * *per_volume);
      return number;
    }
    if (is_unit_given(variable.units)) {
      fail("'{}': unit not known (found '{}', allowed {}, {})", variable.name, variable.units, kNumberPerVolume.allowed,
           kNumberPerMass.allowed);
    }
    const float largest = *std::max_element(number.begin(), number.end());
    const bool is_per_cm3 = largest < 1e5;
    note("GUESSED unit of '{}': {} (largest value {:.4g})", variable.name, is_per_cm3 ? "1/cm3" : "1/kg", largest);
    const std::vector<float> air = is_per_cm3 ? std::vector<float>(number.size(), 1e6F) : air_density();
    for (std::size_t n = 0; n < number.size(); ++n) number[n] *= air[n];
    return number;
  }

  void check_radii(const std::string& what) const {
    for (std::size_t n = 0; n < cloud_.density.size(); ++n) {
      const float radius = cloud_.effective_radius_um[n];
      if (cloud_.density[n] > 0 && cloud_.density[n] >= options_.minimum && !(radius > 0 && std::isfinite(radius))) {
        const std::size_t nx = axes_[0].length, ny = axes_[1].length;
        fail(
            "{}: cell ({}, {}, {}) holds {:.3g} g/m3 of water and has the value {} (allowed: > 0 where there is water; "
            "--minimum leaves out cells with less)",
            what, n % nx, n / nx % ny, n / nx / ny, cloud_.density[n], radius);
      }
    }
  }

  const CloudImportOptions& options_;
  const std::filesystem::path& file_;
  NetcdfInput input_;
  LevelledCloud cloud_;
  std::array<Axis, 4> axes_{};
  bool descending_ = false;
  std::vector<float> air_;
};

}  // namespace

LevelledCloud import_les(const CloudImportOptions& options) {
  return after_rehearsal(options.file, {.library = "netCDF"}, [&] { return LesReader(options).read(); });
}

}  // namespace cloudbow

// Output of large-eddy simulations in netCDF.
#include <algorithm>
#include <cmath>
#include <optional>

#include "cloudbow/core/sandbox.hpp"
#include "import_parts.hpp"
#include "les_air.hpp"
#include "les_file.hpp"
#include "les_grid.hpp"

namespace cloudbow {
namespace {

class LesReader {
 public:
  LesReader(const CloudImportOptions& options, const AirProfile* profile)
      : options_(options),
        file_(options),
        main_(main_variable()),
        grid_(file_, main_),
        cloud_(grid_.empty_cloud()),
        air_(file_, grid_, cloud_.density, profile) {}

  std::size_t times() const { return grid_.times(); }

  LevelledCloud read() {
    cloud_.quantity = is_extinction_             ? "extinction"
                      : main_species_ != nullptr ? main_species_->grid
                                                 : "liquid_water_content";
    if (main_species_ != nullptr) {
      cloud_.grid = main_species_->grid;
      cloud_.radius_grid = main_species_->radius_grid;
    }
    cloud_.source = fmt::format("'{}' [{}]", main_.name, units());
    cloud_.source_hint = " --units says it otherwise";
    cloud_.density = grid_.read(main_, is_extinction_             ? "extinction"
                                       : main_species_ != nullptr ? main_species_->what
                                                                  : "liquid water");
    check_other_water();
    if (is_liquid()) subtract_ice();
    check_values(main_, cloud_.density);
    for (const Species* species : others_) read_species(*species);
    if (is_extinction_) {
      to_extinction();
      add_scattering_albedo();
    } else {
      if (const double ratio = kg_per_kg(main_, units(), cloud_.density); ratio > 0) {
        if (is_liquid()) air_.set_liquid_ratio(ratio);
        to_content(ratio, cloud_.density);
      }
      finish_species();
    }
    add_effective_radius();
    if (options_.temperature_grid) add_temperature();
    report_species();
    check_ground();
    cloud_.column_edge_m = grid_.take_column_edges();
    cloud_.notes = std::move(file_.notes);
    return std::move(cloud_);
  }

 private:
  std::string units() const { return options_.units.empty() ? main_.units : options_.units; }
  bool is_liquid() const { return !is_extinction_ && main_species_ == nullptr; }

  // -- which variable -----------------------------------------------------------------------------------------------

  /// The species of --species: liquid water first if it is wanted, which is the cloud as it is without this option.
  void set_species() {
    const auto is_wanted = [&](const char* option) {
      return std::find(options_.species.begin(), options_.species.end(), option) != options_.species.end();
    };
    const bool wants_all = is_wanted("all");
    const bool has_liquid = !options_.variable.empty() || !file_.candidates(water_names).empty();
    const bool wants_liquid = options_.species.empty() || is_wanted("liquid") || (wants_all && has_liquid);
    if (!options_.species.empty() && options_.quantity == "extinction")
      file_.fail("--species: of water alone (found --quantity extinction); leave out one of the two");
    if (!wants_liquid && !options_.variable.empty())
      file_.fail("--species: without liquid (found --variable, which names liquid water); leave out one of the two");
    for (const Species& species : species_names) {
      if (species.option == nullptr) continue;
      const bool is_there = file_.first_of(*species.names) != nullptr;
      if (!is_wanted(species.option) && !(wants_all && is_there)) continue;
      if (!is_there) {
        std::string tried;
        for (const std::string& name : species.names->names) tried += (tried.empty() ? "" : ", ") + name;
        file_.fail("no variable of {} (looked for {}; fields in the file: {}); leave {} out of --species", species.what,
                   tried, file_.fields_there(), species.option);
      }
      if (wants_liquid || main_species_ != nullptr) {
        others_.push_back(&species);
      } else {
        main_species_ = &species;
      }
    }
  }

  const NetcdfVariable& main_variable() {
    set_species();
    if (main_species_ != nullptr) {
      const NetcdfVariable& variable = *file_.first_of(*main_species_->names);
      file_.note("{}: {}", main_species_->what,
                 LesFile::described(variable, options_.units.empty() ? variable.units : options_.units));
      return variable;
    }
    const NetcdfVariable& variable =
        options_.variable.empty() ? guessed_variable() : file_.named(options_.variable, "--variable");
    const std::string unit = options_.units.empty() ? variable.units : options_.units;
    const bool has_unit_of_extinction = factor_of(extinction_units, unit).has_value();
    const Names& names = extinction_names.names;
    is_extinction_ = options_.quantity.empty()
                         ? has_unit_of_extinction || std::find(names.begin(), names.end(), variable.name) != names.end()
                         : options_.quantity == "extinction";
    if (is_extinction_ && !others_.empty()) {
      file_.fail("'{}' is extinction (found --species, allowed for water alone); leave out --species", variable.name);
    }
    file_.note("{}: {}", is_extinction_ ? "extinction" : "liquid water", LesFile::described(variable, unit));
    return variable;
  }

  const NetcdfVariable& guessed_variable() {
    const auto extinction = file_.candidates(extinction_names);
    if (options_.quantity == "extinction" && !extinction.empty()) return *extinction.front();
    const auto water = file_.candidates(water_names);
    if (!water.empty()) {
      if (!extinction.empty())
        file_.note("NOT imported: '{}', extinction (--quantity extinction imports it)", extinction.front()->name);
      return *water.front();
    }
    if (!extinction.empty() && options_.quantity.empty()) return *extinction.front();
    std::string tried, other;
    for (const std::string& name : water_names.names) tried += (tried.empty() ? "" : ", ") + name;
    for (const Species& species : species_names) {
      if (species.option == nullptr || file_.first_of(*species.names) == nullptr) continue;
      other += fmt::format(", or give --species {} for its {}", species.option, species.what);
    }
    file_.fail("no variable of liquid water (looked for {}; fields in the file: {}) name it with --variable{}", tried,
               file_.fields_there(), other);
  }

  /// Two variables of liquid water that differ: the user must choose.
  void check_other_water() {
    if (!is_liquid() || !options_.variable.empty()) return;
    for (const NetcdfVariable* other : file_.candidates(water_names)) {
      if (other == &main_ || is_condensate(*other)) continue;
      const bool is_alike =
          other->length == main_.length && other->dimension == main_.dimension && other->units == main_.units;
      if (!is_alike) {
        file_.note("NOT imported: {}, liquid water too by its name (--variable chooses)",
                   LesFile::described(*other, other->units));
        continue;
      }
      const std::vector<float> value = grid_.read(*other, "liquid water");
      const auto is_same = [](float x, float y) { return x == y || (std::isnan(x) && std::isnan(y)); };
      if (std::equal(value.begin(), value.end(), cloud_.density.begin(), is_same)) continue;
      file_.fail("two kinds of liquid water (found '{}' and '{}', which differ, allowed one); name it with --variable",
                 main_.name, other->name);
    }
  }

  // -- water --------------------------------------------------------------------------------------------------------

  bool is_condensate(const NetcdfVariable& variable) const {
    const std::string meaning = file_.meaning(variable);
    const auto& names = condensate_names;
    return std::find(names.begin(), names.end(), variable.name) != names.end() ||
           meaning.find("water+ice") != std::string::npos || meaning.find("water and ice") != std::string::npos;
  }

  /// SAM's QN is water and ice together, with QI beside it in some versions.
  void subtract_ice() {
    if (!is_condensate(main_)) return;
    if (const NetcdfVariable* ice = file_.first_of(ice_names); ice != nullptr && grid_.holds(*ice)) {
      if (ice->units != main_.units) {
        file_.fail(
            "'{}' is water and ice together, and '{}' is in another unit (found '{}' and '{}', allowed the same)",
            main_.name, ice->name, main_.units, ice->units);
      }
      const std::vector<float> value = grid_.read(*ice, "ice");
      for (std::size_t n = 0; n < value.size(); ++n) cloud_.density[n] -= value[n];
      file_.note("liquid water: '{}' less '{}', because the former is water and ice together", main_.name, ice->name);
      return;
    }
    const NetcdfVariable* temperature = file_.find(options_.temperature, temperature_names, "--temperature");
    constexpr double freezing = 273.16;
    if (temperature != nullptr && grid_.holds(*temperature) && factor_of(kelvin_units, temperature->units)) {
      const std::vector<float> kelvin = grid_.read(*temperature, "temperature");
      for (std::size_t n = 0; n < kelvin.size(); ++n) {
        if (!(cloud_.density[n] > 0 && kelvin[n] < freezing)) continue;
        file_.fail(
            "'{}' is water and ice together, and {} may hold ice (found {:.6g} K and no variable of ice, allowed {} K "
            "and "
            "more); name liquid water alone with --variable",
            main_.name, grid_.cell_text(n), kelvin[n], freezing);
      }
    }
    file_.note("liquid water: '{}' is water and ice together, all of it counts as liquid", main_.name);
  }

  /// Advection and packing leave values around 0 of the size of rounding; what is further below is an error.
  void check_values(const NetcdfVariable& variable, std::vector<float>& value) {
    const double step = file_.input.packing_step(variable);
    float largest = 0;
    for (const float v : value) largest = std::max(largest, std::isfinite(v) ? v : 0);
    const double rounding = std::max(1e-6 * largest, 1.001 * step);
    std::size_t below = 0, around = 0, missing = 0;
    for (std::size_t n = 0; n < value.size(); ++n) {
      if (std::isnan(value[n]) && options_.fill == "clear") {
        value[n] = 0;
        ++missing;
      } else if (!std::isfinite(value[n])) {
        file_.fail(
            "'{}': {} has the value {} (allowed: finite numbers >= 0) --fill clear takes missing cells for clear air",
            variable.name, grid_.cell_text(n), std::isnan(value[n]) ? "NaN or missing" : "infinity");
      } else if (value[n] < -rounding) {
        file_.fail("'{}': {} has the value {} (allowed: numbers >= 0, and down to {:.2g}, which counts as 0){}",
                   variable.name, grid_.cell_text(n), value[n], -rounding,
                   step > 0 ? " did a number not fit into its packed integers?" : "");
      } else if (value[n] < 0) {
        value[n] = 0;
        ++below;
      } else if (value[n] > 0 && value[n] <= 0.5001 * step) {
        value[n] = 0;
        ++around;
      }
    }
    if (below > 0) file_.note("'{}': {} cells barely below 0 count as 0", variable.name, below);
    if (around > 0)
      file_.note("'{}': {} cells within half a step of its packing ({:.3g}) count as 0", variable.name, around, step);
    if (missing > 0)
      file_.note("'{}': {} cells are missing and count as clear air, as --fill says", variable.name, missing);
  }

  void scale(double factor) {
    for (float& value : cloud_.density) value = static_cast<float>(value * factor);
  }

  void to_extinction() {
    const auto factor = factor_of(extinction_units, units());
    if (!factor) {
      file_.fail("'{}': unit of extinction not known (found '{}', allowed {}); say it with --units", main_.name,
                 units(), extinction_units.allowed);
    }
    scale(*factor);
    constexpr double most = 10;  // 1/m: 20 g/m3 of droplets of 3 um
    const auto thickest = std::max_element(cloud_.density.begin(), cloud_.density.end());
    if (*thickest > most) {
      file_.fail("'{}': extinction of {:.6g} 1/m in {} (allowed up to {} 1/m): is its unit '{}'? --units says it",
                 main_.name, *thickest, grid_.cell_text(static_cast<std::size_t>(thickest - cloud_.density.begin())),
                 most, units());
    }
  }

  void add_scattering_albedo() {
    const NetcdfVariable* albedo = file_.find("", scattering_albedo_names, "");
    if (albedo == nullptr) return;
    cloud_.single_scattering_albedo = grid_.read(*albedo, "single-scattering albedo");
    for (std::size_t n = 0; n < cloud_.density.size(); ++n) {
      float& value = cloud_.single_scattering_albedo[n];
      if (cloud_.density[n] == 0) {
        value = 1;
      } else if (!(value >= 0 && value <= 1)) {
        file_.fail("'{}': {} has the value {} (allowed 0 to 1)", albedo->name, grid_.cell_text(n), value);
      }
    }
    file_.note("single-scattering albedo: '{}'", albedo->name);
  }

  /// Size of the unit of water per kg of air; 0 if the values are contents, which are converted to g/m3.
  double kg_per_kg(const NetcdfVariable& variable, const std::string& unit, std::vector<float>& value) {
    const auto scale_value = [&value](double factor) {
      for (float& v : value) v = static_cast<float>(v * factor);
      return 0.0;
    };
    if (const auto content = factor_of(content_units, unit)) return scale_value(*content);
    if (const auto known = factor_of(ratio_units, unit)) return *known;
    if (is_unit_given(unit)) {
      file_.fail("'{}': unit not known (found '{}', allowed {}, {}; --units says it if the file is wrong)",
                 variable.name, unit, ratio_units.allowed, content_units.allowed);
    }
    const float largest = *std::max_element(value.begin(), value.end());
    const bool is_kg = largest < 0.05;  // more than 50 g of cloud water in a kg of air there is not
    const bool is_content = lower_case(variable.name) == "lwc";
    file_.note("GUESSED unit of '{}': {} (largest value {:.4g}); --units says it", variable.name,
               is_content ? (is_kg ? "kg/m3" : "g/m3")
               : is_kg    ? "kg/kg"
                          : "g/kg",
               largest);
    if (is_content) return scale_value(is_kg ? 1e3 : 1);
    return is_kg ? 1 : 1e-3;
  }

  void to_content(double ratio, std::vector<float>& value) {
    const std::vector<float>& air = air_.density();
    for (std::size_t n = 0; n < value.size(); ++n) {
      if (value[n] == 0) continue;  // the air may be missing
      value[n] = static_cast<float>(value[n] * ratio * air[n] * 1e3);
    }
  }

  // -- other species ------------------------------------------------------------------------------------------------

  void read_species(const Species& species) {
    const NetcdfVariable& variable = *file_.first_of(*species.names);
    file_.note("{}: {}", species.what, LesFile::described(variable, variable.units));
    LevelledSpecies other{species.grid, species.grid, species.radius_grid, grid_.read(variable, species.what), {}};
    check_values(variable, other.density);
    air_.add_water(other.density);
    cloud_.others.push_back(std::move(other));
  }

  /// To g/m3, when the air's density can be had.
  void finish_species() {
    for (std::size_t n = 0; n < others_.size(); ++n) {
      const NetcdfVariable& variable = *file_.first_of(*others_[n]->names);
      LevelledSpecies& other = cloud_.others[n];
      if (const double ratio = kg_per_kg(variable, variable.units, other.density); ratio > 0)
        to_content(ratio, other.density);
      other.effective_radius_um = radii_of(*others_[n], other.density);
    }
  }

  /// Empty if the file has none.
  std::vector<float> radii_of(const Species& species, const std::vector<float>& density) {
    const NetcdfVariable* variable = file_.first_of(*species.radius_names);
    if (variable == nullptr) {
      file_.note("effective radius of {}: none in the file, a scene gives it", species.what);
      return {};
    }
    return radii_in(*variable, density);
  }

  std::vector<float> radii_in(const NetcdfVariable& variable, const std::vector<float>& density) {
    std::vector<float> radius = grid_.read(variable, "effective radius");
    const float largest = *std::max_element(radius.begin(), radius.end());
    const double unit = file_.factor(variable, radius_units, largest < 1e-2 ? 1e6 : 1, largest < 1e-2 ? "m" : "um");
    for (float& value : radius) value = static_cast<float>(value * unit);
    check_radii("'" + variable.name + "'", density, radius);
    file_.note("effective radius: '{}'", variable.name);
    return radius;
  }

  // -- effective radius ---------------------------------------------------------------------------------------------

  void add_effective_radius() {
    if (main_species_ != nullptr) {
      cloud_.effective_radius_um = radii_of(*main_species_, cloud_.density);
      return;
    }
    const NetcdfVariable* radius =
        options_.droplet_number.empty() && options_.droplet_number_cm3 <= 0
            ? file_.find(options_.effective_radius, effective_radius_names, "--effective-radius")
            : nullptr;
    if (radius != nullptr) {
      cloud_.effective_radius_um = radii_in(*radius, cloud_.density);
      return;
    }
    if (is_extinction_) return;
    std::vector<float> number;
    std::string source;
    if (options_.droplet_number_cm3 > 0) {
      number.assign(cloud_.density.size(), static_cast<float>(options_.droplet_number_cm3 * 1e6));
      source = fmt::format("{} per cm3", options_.droplet_number_cm3);
    } else {
      const NetcdfVariable* variable = file_.find(options_.droplet_number, droplet_number_names, "--droplet-number");
      if (variable == nullptr) return;
      number = droplets_per_m3(*variable);
      source = "'" + variable->name + "'";
    }
    check_droplet_number(source, number);
    cloud_.effective_radius_um.assign(cloud_.density.size(), 0);
    for (std::size_t n = 0; n < number.size(); ++n) {
      if (!(cloud_.density[n] > 0)) continue;
      cloud_.effective_radius_um[n] =
          static_cast<float>(effective_radius_of_droplets(cloud_.density[n], number[n], options_.radius_ratio_cubed));
    }
    check_radii("effective radius from " + source, cloud_.density, cloud_.effective_radius_um);
    file_.note("effective radius: (3 L / (4 pi rho_w k N))^(1/3) with N = {}, k = {}", source,
               options_.radius_ratio_cubed);
  }

  std::vector<float> droplets_per_m3(const NetcdfVariable& variable) {
    std::vector<float> number = grid_.read(variable, "droplet number");
    if (const auto per_mass = factor_of(number_per_mass_units, variable.units)) {
      const std::vector<float>& air = air_.density();
      for (std::size_t n = 0; n < number.size(); ++n) number[n] = static_cast<float>(number[n] * *per_mass * air[n]);
      return number;
    }
    if (const auto per_volume = factor_of(number_per_volume_units, variable.units)) {
      for (float& value : number) value = static_cast<float>(value * *per_volume);
      return number;
    }
    if (is_unit_given(variable.units)) {
      file_.fail("'{}': unit not known (found '{}', allowed {}, {})", variable.name, variable.units,
                 number_per_volume_units.allowed, number_per_mass_units.allowed);
    }
    const float largest = *std::max_element(number.begin(), number.end());
    const bool is_per_cm3 = largest < 1e5;
    file_.note("GUESSED unit of '{}': {} (largest value {:.4g})", variable.name, is_per_cm3 ? "1/cm3" : "1/kg",
               largest);
    const std::vector<float> air = is_per_cm3 ? std::vector<float>(number.size(), 1e6F) : air_.density();
    for (std::size_t n = 0; n < number.size(); ++n) number[n] *= air[n];
    return number;
  }

  /// The cell with most water decides: other cells may be the rims of clouds.
  void check_droplet_number(const std::string& source, const std::vector<float>& number) const {
    constexpr double least = 0.1, most = 1e5;  // per cm3
    const auto n = static_cast<std::size_t>(std::max_element(cloud_.density.begin(), cloud_.density.end()) -
                                            cloud_.density.begin());
    if (!(cloud_.density[n] > 0)) return;
    const double per_cm3 = number[n] * 1e-6;
    if (per_cm3 >= least && per_cm3 <= most) return;
    file_.fail(
        "droplet number {}: {} has {:.6g} per cm3 (allowed {} to {} per cm3): is it in the unit that the file says? "
        "--droplet-number-cm3 gives one number for all",
        source, grid_.cell_text(n), per_cm3, least, most);
  }

  void check_radii(const std::string& what, const std::vector<float>& density, const std::vector<float>& radii) const {
    for (std::size_t n = 0; n < density.size(); ++n) {
      const float radius = radii[n];
      if (density[n] > 0 && density[n] >= options_.minimum && !(radius > 0 && std::isfinite(radius))) {
        file_.fail(
            "{}: {} holds {:.3g} {} and has the value {} (allowed: > 0 in cloud; --minimum leaves out "
            "cells with less)",
            what, grid_.cell_text(n), density[n], is_extinction_ ? "1/m of extinction" : "g/m3 of water", radius);
      }
    }
  }

  // -- temperature --------------------------------------------------------------------------------------------------

  void add_temperature() {
    cloud_.temperature_k = air_.temperature(is_liquid() ? &cloud_.density : nullptr);
    float lowest = INFINITY, highest = 0;
    for (std::size_t n = 0; n < cloud_.density.size(); ++n) {
      if (!has_water(n)) continue;
      lowest = std::min(lowest, cloud_.temperature_k[n]);
      highest = std::max(highest, cloud_.temperature_k[n]);
    }
    file_.note("temperature grid: {:.5g} to {:.5g} K in cells with cloud", lowest, highest);
  }

  // -- what else ----------------------------------------------------------------------------------------------------

  bool has_water(std::size_t cell) const {
    return cloud_.density[cell] > 0 || std::any_of(cloud_.others.begin(), cloud_.others.end(),
                                                   [cell](const auto& other) { return other.density[cell] > 0; });
  }

  bool is_imported(const Species& species) const {
    return main_species_ == &species || std::find(others_.begin(), others_.end(), &species) != others_.end();
  }

  /// Water of other kinds is not imported unless it is named; a note reports it.
  void report_species() {
    for (const Species& species : species_names) {
      if (is_imported(species)) continue;
      const Names& names = species.names->names;
      if (!is_extinction_ && std::find(names.begin(), names.end(), main_.name) != names.end())
        file_.note("'{}' is {} by its name, and counts as liquid water", main_.name, species.what);
      const NetcdfVariable* variable = file_.first_of(*species.names);
      if (variable == nullptr || variable == &main_) continue;
      if (!grid_.holds(*variable)) {
        file_.note("NOT imported: '{}', {}", variable->name, species.what);
        continue;
      }
      float largest = 0;
      for (const float value : grid_.read(*variable, species.what)) largest = std::max(largest, value);
      if (largest > 0) {
        const std::string way = species.option == nullptr || is_extinction_
                                    ? ""
                                    : fmt::format("; --species liquid,{} imports it", species.option);
        file_.note("NOT imported: '{}', {} (largest {:.4g}{}{}){}", variable->name, species.what, largest,
                   variable->units.empty() ? "" : " ", variable->units, way);
      }
    }
  }

  void check_ground() const {
    const std::size_t columns = cloud_.columns();
    for (int k = 0; k < cloud_.nz(); ++k) {
      const double centre =
          0.5 * (cloud_.z_edge_m[static_cast<std::size_t>(k)] + cloud_.z_edge_m[static_cast<std::size_t>(k) + 1]);
      if (centre >= 0) return;
      const std::size_t begin = columns * static_cast<std::size_t>(k);
      bool is_cloudy = false;
      for (std::size_t n = begin; n < begin + columns && !is_cloudy; ++n) is_cloudy = has_water(n);
      if (!is_cloudy) continue;
      file_.fail(
          "cloud below the ground (found it at {:.6g} m, allowed 0 m and above); correct the heights, or give "
          "--voxel-size-m DX DY DZ",
          centre);
    }
  }

  const CloudImportOptions& options_;
  LesFile file_;
  bool is_extinction_ = false;
  const Species* main_species_ = nullptr;  ///< of the main variable; null: liquid water, or extinction
  std::vector<const Species*> others_;
  const NetcdfVariable& main_;
  LesGrid grid_;
  LevelledCloud cloud_;
  LesAir air_;
};

}  // namespace

LevelledCloud import_les(const CloudImportOptions& options) {
  std::optional<AirProfile> profile;
  if (!options.profile.empty()) profile = read_air_profile(options.profile);
  return after_sandbox(options.file, {.library = "netCDF"},
                       [&] { return LesReader(options, profile ? &*profile : nullptr).read(); });
}

std::size_t count_times(const CloudImportOptions& options) {
  CloudImportOptions first = options;
  first.time = 0;
  return after_sandbox(options.file, {.library = "netCDF"}, [&] { return LesReader(first, nullptr).times(); });
}

}  // namespace cloudbow

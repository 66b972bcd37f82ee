// Tables of bulk optics in the layout of ecRad's scattering files.
#include "cloudbow/medium/bulk_table_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "cloudbow/core/sandbox.hpp"
#include "import_parts.hpp"
#include "les_vocabulary.hpp"
#include "netcdf_input.hpp"

namespace cloudbow {
namespace {

constexpr const char* allowed_file = "a table of bulk optics as netCDF";
constexpr std::size_t most_values = 10000000;

const UnitTable wavenumber_units{"cm-1, m-1", {{"cm-1", 1}, {"1/cm", 1}, {"/cm", 1}, {"m-1", 1e-2}, {"1/m", 1e-2}}};
const UnitTable mass_extinction_units{
    "m2 kg-1, m2 g-1",
    {{"m2kg-1", 1e-3}, {"m2/kg", 1e-3}, {"m2g-1", 1}, {"m2/g", 1}, {"cm2g-1", 1e-4}, {"cm2/g", 1e-4}}};
const UnitTable number_units{"1", {{"", 1}, {"1", 1}, {"-", 1}}};

class BulkReader {
 public:
  explicit BulkReader(const std::filesystem::path& file) : file_(file), input_(file) {}

  BulkTable read() const {
    check_variables();
    BulkTable table;
    table.name = file_.string();
    table.wavenumber_cm1 = axis("wavenumber", wavenumber_units);
    table.effective_radius_um = axis("effective_radius", radius_units);
    const std::size_t wavenumbers = table.wavenumber_cm1.size(), radii = table.effective_radius_um.size();
    const auto extinction = by_wavenumber("mass_extinction_coefficient", mass_extinction_units, wavenumbers, radii);
    const auto albedo = by_wavenumber("single_scattering_albedo", number_units, wavenumbers, radii);
    const auto asymmetry = by_wavenumber("asymmetry_factor", number_units, wavenumbers, radii);
    table.value.assign(wavenumbers, std::vector<BulkOptics>(radii));
    for (std::size_t n = 0; n < wavenumbers; ++n) {
      for (std::size_t r = 0; r < radii; ++r) {
        const std::size_t at = n * radii + r;
        table.value[n][r] = {extinction[at], within_one(albedo[at]), within_one(asymmetry[at])};
      }
    }
    check_bulk_table(table);
    return table;
  }

 private:
  static constexpr std::array<const char*, 5> names{"wavenumber", "effective_radius", "mass_extinction_coefficient",
                                                    "single_scattering_albedo", "asymmetry_factor"};

  /// Numbers of 32 bits may exceed 1 by their rounding.
  static double within_one(double value) {
    constexpr double rounding = 1e-6;
    return value > 1 && value <= 1 + rounding ? 1 : value;
  }

  void check_variables() const {
    std::string missing, found;
    for (const char* name : names) {
      if (input_.find(name) == nullptr) missing += (missing.empty() ? "" : ", ") + std::string(name);
    }
    if (missing.empty()) return;
    for (const NetcdfVariable& variable : input_.variables()) found += (found.empty() ? "" : ", ") + variable.name;
    fail_import(file_,
                "not a table of bulk optics: no variable {} (found {}, allowed ecRad's layout with wavenumber, "
                "effective_radius, mass_extinction_coefficient, single_scattering_albedo and asymmetry_factor); name "
                "another file",
                missing, found.empty() ? "none" : found);
  }

  double unit(const NetcdfVariable& variable, const UnitTable& units) const {
    if (const auto factor = factor_of(units, variable.units)) return *factor;
    fail_import(file_, "'{}': unit not known (found \"{}\", allowed {}); set its attribute units", variable.name,
                variable.units, units.allowed);
  }

  std::vector<double> values(const NetcdfVariable& variable, const UnitTable& units) const {
    std::size_t count = 1;
    for (const std::size_t length : variable.length) {
      if (length > most_values / count)
        fail_import(file_, "'{}': too large (found more, allowed {} numbers)", variable.name, most_values);
      count *= std::max<std::size_t>(length, 1);
    }
    const double factor = unit(variable, units);
    std::vector<double> value = input_.read(variable);
    for (double& number : value) number *= factor;
    return value;
  }

  std::vector<double> axis(const char* name, const UnitTable& units) const {
    const NetcdfVariable& variable = *input_.find(name);
    if (variable.dimension != std::vector<std::string>{name}) {
      fail_import(file_, "'{}': dimensions of another kind (found {}, allowed {})", name, text_of(variable.dimension),
                  name);
    }
    return values(variable, units);
  }

  /// [wavenumber][radius], whichever of the two is slower in the file.
  std::vector<double> by_wavenumber(const char* name, const UnitTable& units, std::size_t wavenumbers,
                                    std::size_t radii) const {
    using Names = std::vector<std::string>;
    const NetcdfVariable& variable = *input_.find(name);
    const bool in_order = variable.dimension == Names{"wavenumber", "effective_radius"};
    if (!in_order && variable.dimension != Names{"effective_radius", "wavenumber"}) {
      fail_import(file_, "'{}': dimensions of another kind (found {}, allowed effective_radius, wavenumber)", name,
                  text_of(variable.dimension));
    }
    std::vector<double> value = values(variable, units);
    if (in_order) return value;
    std::vector<double> turned(value.size());
    for (std::size_t r = 0; r < radii; ++r) {
      for (std::size_t n = 0; n < wavenumbers; ++n) turned[n * radii + r] = value[r * wavenumbers + n];
    }
    return turned;
  }

  static std::string text_of(const std::vector<std::string>& dimensions) {
    std::string text;
    for (const std::string& name : dimensions) text += (text.empty() ? "" : ", ") + name;
    return text.empty() ? "none" : text;
  }

  const std::filesystem::path& file_;
  NetcdfInput input_;
};

}  // namespace

BulkTable read_bulk_table(const std::filesystem::path& file) {
  if (!begins_as_netcdf(file, allowed_file)) {
    fail_import(file, "not netCDF (found another kind of file, allowed {} in ecRad's layout); name another file",
                allowed_file);
  }
  return after_sandbox(file, {.library = "netCDF"}, [&] { return BulkReader(file).read(); });
}

}  // namespace cloudbow

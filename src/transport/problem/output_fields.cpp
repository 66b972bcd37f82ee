#include "cloudbow/transport/output_fields.hpp"

#include <algorithm>
#include <array>

namespace cloudbow {
namespace {

using Grid = OutputField::Grid;

constexpr std::array<OutputField, 6> fields{{
    {"upwelling_flux", "W m-2", "upwelling diffuse flux through a horizontal surface",
     "upwelling_shortwave_flux_in_air", Grid::levels, &Solution::upwelling_flux, &Solution::profile_upwelling_flux,
     "fluxes", nullptr, nullptr, nullptr, "upwelling_longwave_flux_in_air",
     "upwelling_radiative_flux_per_unit_wavelength_in_air"},
    {"downwelling_diffuse_flux", "W m-2",
     "downwelling diffuse flux through a horizontal surface, without the direct beam",
     "diffuse_downwelling_shortwave_flux_in_air", Grid::levels, &Solution::downwelling_diffuse_flux,
     &Solution::profile_downwelling_diffuse_flux, "fluxes", nullptr, nullptr, nullptr,
     "downwelling_longwave_flux_in_air", "downwelling_radiative_flux_per_unit_wavelength_in_air"},
    {"direct_flux", "W m-2", "unscattered sunlight through a horizontal surface (true extinction)",
     "direct_downwelling_shortwave_flux_in_air", Grid::levels, &Solution::direct_flux, &Solution::profile_direct_flux,
     "fluxes", nullptr},
    {"absorbed_power", "W m-3", "solar power absorbed per volume", nullptr, Grid::cells, &Solution::absorbed_power,
     nullptr, "absorption", &OutputOptions::absorption, "net_absorbed_power",
     "power absorbed per volume less the power emitted"},
    {"actinic_flux", "W m-2", "actinic flux: 4 pi times the mean radiance, direct beam included", nullptr, Grid::cells,
     &Solution::actinic_flux, nullptr, "actinic", &OutputOptions::actinic},
    {"circumsolar_flux", "W m-2", "diffuse light from the cone about the sun, through a plane that faces the sun",
     nullptr, Grid::levels, &Solution::circumsolar_flux, nullptr, nullptr, nullptr},
}};

}  // namespace

std::span<const OutputField> output_fields() { return fields; }

std::string with_spectral_unit(const std::string& units, SpectralUnit unit) {
  return unit == SpectralUnit::wavelength ? units + " um-1" : units;
}

FieldNames names_of(const OutputField& field, const Solution& solution, SpectralUnit unit) {
  FieldNames names{field.name, field.units, field.long_name, field.standard_name};
  if (!solution.emits) return names;
  if (field.net_name != nullptr) names.name = field.net_name;
  if (field.net_long_name != nullptr) names.long_name = field.net_long_name;
  names.units = with_spectral_unit(field.units, unit);
  names.standard_name = solution.sun                       ? nullptr
                        : unit == SpectralUnit::wavelength ? field.wavelength_name
                                                           : field.longwave_name;
  return names;
}

void ask_for_fluxes_alone(OutputOptions& options) {
  for (const OutputField& field : fields) {
    if (field.asked != nullptr) options.*field.asked = false;
  }
  options.radiance_field = false;
  options.circumsolar_half_angle = 0;
  options.views.clear();
  options.cameras.clear();
}

int cell_field_count(const OutputOptions& options) {
  return static_cast<int>(std::count_if(fields.begin(), fields.end(), [&](const OutputField& field) {
    return field.grid == Grid::cells && (field.asked == nullptr || options.*field.asked);
  }));
}

}  // namespace cloudbow

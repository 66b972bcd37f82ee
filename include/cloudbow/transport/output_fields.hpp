// The one list of a solution's fields: their names, the locations of their values, the options that request them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Spectral interval of a scene's fluxes.
enum class SpectralUnit {
  band,       ///< W m-2: a band, or whatever the sun's irradiance is of
  wavelength  ///< W m-2 um-1
};

struct OutputField {
  enum class Grid {
    levels,  ///< [level][ny][nx], at Solution::flux_level
    cells    ///< [nz][ny][nx]
  };

  const char* name;  ///< of the variable in a result
  const char* units;
  const char* long_name;
  const char* standard_name;  ///< of the CF standard name table (version 83); null: it has none for exactly this
  Grid grid;
  std::vector<float> Solution::*values;
  std::vector<double> Solution::*profile;  ///< [nz+1] domain means; null: none
  const char* key;                         ///< in `output.fields` of a scene; null: another key asks for it
  bool OutputOptions::*asked;              ///< null: always there, or its values are empty
  // In scenes that emit; null: as above.
  const char* net_name = nullptr;
  const char* net_long_name = nullptr;
  // Standard names of scenes that emit and have no sun; null: none.
  const char* longwave_name = nullptr;    ///< over a band
  const char* wavelength_name = nullptr;  ///< at a wavelength
};

/// Attributes of a field in one result.
struct FieldNames {
  std::string name;
  std::string units;
  std::string long_name;
  const char* standard_name;  ///< null: none
};

/// @param unit of scenes that emit; that of other scenes is not known to the solution.
FieldNames names_of(const OutputField& field, const Solution& solution, SpectralUnit unit = SpectralUnit::band);

/// Unit of a flux, radiance or power per volume over a band, in the spectral unit of the scene.
std::string with_spectral_unit(const std::string& units, SpectralUnit unit);

/// All fields of levels and cells, in the order of a result.
std::span<const OutputField> output_fields();

/// Leaves only the outputs that are always present: no fields of cells, images or radiance field.
void ask_for_fluxes_alone(OutputOptions& options);

/// How many values of the fields of cells a solution holds per cell.
int cell_field_count(const OutputOptions& options);

}  // namespace cloudbow

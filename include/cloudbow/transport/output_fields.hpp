// The one list of a solution's fields: their names, the locations of their values, the options that request them.
#pragma once

#include <span>
#include <vector>

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

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
  const char* key;                         ///< in `output.fields` of a scene
  bool OutputOptions::*asked;              ///< null: always there
};

/// All fields of levels and cells, in the order of a result.
std::span<const OutputField> output_fields();

/// Leaves only the outputs that are always present: no fields of cells, images or radiance field.
void ask_for_fluxes_alone(OutputOptions& options);

/// How many values of the fields of cells a solution holds per cell.
int cell_field_count(const OutputOptions& options);

}  // namespace cloudbow

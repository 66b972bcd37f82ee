// Cells so thick that their light drowns in rounding.
#pragma once

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Beyond an optical depth of 1e6 a cell's own light is lost in rounding, and the iteration fails.
/// @throws InputError if a cell that scatters is thicker.
void check_cell_thickness(const Problem& problem);

}  // namespace cloudbow

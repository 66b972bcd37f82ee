// Levels of accuracy: the solver settings of each.
#pragma once

#include <string>
#include <vector>

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Along which horizontal axes a scene has more than one column: none, one, both.
enum class HorizontalExtent { column, slice, field };

std::vector<std::string> accuracy_names();

/// Options of one level of the ladder ("draft", "balanced", "fine", "reference").
/// @param extent a column costs nothing and is solved in double precision, a slice costs little and gets more
/// ordinates.
/// @param measured_phase_functions some phase function with a forward peak is given by moments or a table: their peaks
/// take a beam truncated at a lower order than those of Henyey and Greenstein.
SolverOptions accuracy_options(const std::string& name, HorizontalExtent extent, bool measured_phase_functions);

/// Largest change of the fluxes of a level if few phase functions represent many, as PhaseClasses estimates it.
double class_tolerance(const std::string& accuracy);

}  // namespace cloudbow

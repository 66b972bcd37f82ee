// Check that the values of a solution are finite.
#pragma once

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// @throws std::runtime_error that names the first value that is not finite, and its location. Pixels of cameras
/// through which no line of sight goes are NaN by definition.
void check_finite(const Solution& solution);

}  // namespace cloudbow

// Whether float is enough.
#pragma once

#include "cloudbow/transport/options.hpp"
#include "cloudbow/transport/problem.hpp"

namespace cloudbow {

/// Whether a solve needs double: asked for, or cells too thick for float to tell radiance from source.
bool runs_in_double(const Problem& problem, const SolverOptions& options);

}  // namespace cloudbow

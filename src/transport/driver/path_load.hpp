// How long the shared patterns of a solve are, before any is made.
#pragma once

#include "cloudbow/transport/solve_plan.hpp"

namespace cloudbow {

/// Segments of patterns (path_pattern.hpp) of a solve by ordinates.
struct PathLoad {
  double beam = 0;             ///< of a ray of the direct beam
  double longest_diffuse = 0;  ///< of an ordinate, a direction of the final gather or a view
  double ordinates = 0;        ///< of all ordinates together, as they are marched

  /// Held at once by so many threads.
  double bytes(int threads) const;
};

PathLoad path_load(const SolvePlan& plan);

/// Segments of one ray of the direct beam; 0 if there is no beam that crosses columns.
double beam_segments(const Problem& problem, const SolverOptions& options);

/// Whether the sun is so low for these cells that float loses its beam.
bool beam_needs_double(const Problem& problem, const SolverOptions& options);

/// @throws InputError if a ray crosses more cells than can be solved in a sensible time. It also throws if the sun
/// lights the sides of an open domain much more than its top: an error relative to the top is then meaningless.
void check_paths(const SolvePlan& plan);

}  // namespace cloudbow

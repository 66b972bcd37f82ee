// Backward Monte Carlo of thermal emission, for solve_by_monte_carlo().
#pragma once

#include <cstdint>
#include <vector>

#include "reference/photon_box.hpp"

namespace cloudbow::reference {

/// Tallies of one batch of some `photons`, one at least for each sensor, plane after plane as in MonteCarloResult.
std::vector<double> backward_batch(const MonteCarloScene& scene, const Box& box, Random random, std::int64_t photons);

}  // namespace cloudbow::reference

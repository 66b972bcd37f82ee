// Independent columns sampled from a field: how a g-point answers, at next to no cost.
#pragma once

#include <cstddef>
#include <span>

#include "app/planning/spectral_choice.hpp"
#include "cloudbow/transport/options.hpp"
#include "cloudbow/transport/problem.hpp"

namespace cloudbow {

/// Of a field, for the choice of g-points.
constexpr std::size_t columns_of_choice = 128;

/// Solves some columns of a problem independently, by polar streams. Ground with a BRDF counts as Lambertian of the
/// same bihemispherical albedo.
///
/// The power is EnergyLedger::power of these columns: light of sun and sky through the top, and emission. A field per
/// power is the field of the problem over this number, also in three dimensions: not over the ledger's power of that
/// solve. So a field of all g-points is nearly the sum of weight/power times the fields of the chosen.
/// @param columns indices j*nx + i of the field, the same for all g-points, such as representative_columns() returns.
ColumnAnswers column_answers(const Problem& problem, const SolverOptions& options,
                             std::span<const std::size_t> columns);

}  // namespace cloudbow

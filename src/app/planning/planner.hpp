// Which level of accuracy serves a wanted error, or a time that there is.
#pragma once

#include <optional>
#include <span>
#include <string>

namespace cloudbow {

enum class ErrorOf { domain, columns };

std::string name_of(ErrorOf of);

/// At least one of the two numbers is given.
struct Target {
  std::optional<double> error;  ///< fraction, > 0
  ErrorOf of = ErrorOf::domain;
  std::optional<double> budget_seconds;  ///< wall time of all solves, > 0
};

/// Expected error and cost of a level of accuracy in one scene.
struct LevelCost {
  std::string level;
  double error = 0;  ///< of the fluxes that the target names; fraction
  double seconds = 0;
  double memory_bytes = 0;
};

/// Resources available, apart from the budget of the target.
struct Resources {
  double spent_seconds = 0;  ///< by solves before
  double memory_bytes = 0;
};

/// The cheapest level that is expected to reach the error within the time and the memory; without an error the best
/// that fits.
/// @param levels from the coarsest on, at least one.
/// @returns index of the level. @throws InputError if there is none, with the values that would be possible.
std::size_t choose_level(std::span<const LevelCost> levels, const Target& target, const Resources& resources);

/// The level after `level`, if time and memory allow it; else nothing.
std::optional<std::size_t> next_level(std::span<const LevelCost> levels, std::size_t level, const Target& target,
                                      const Resources& resources);

/// "1%", "1 %" or ".01" as a fraction. @throws InputError for anything else, and outside of (0, 1).
double parse_target_error(const std::string& text);

/// "30s", "2m", "1.5h" or "30" (seconds) in seconds. @throws InputError for anything else.
double parse_budget(const std::string& text);

}  // namespace cloudbow

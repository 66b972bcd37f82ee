#include "app/planning/planner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>

#include "app/process/messages.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

/// Rounds up to the next number of two digits: an error printed as possible must be possible.
double rounded_up(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return std::ceil(value / unit * (1 - 1e-9)) * unit;
}

std::string seconds(double value) { return fmt::format("{:.2g} s", value); }

bool fits(const LevelCost& level, const Target& target, const Resources& resources) {
  return level.memory_bytes <= resources.memory_bytes &&
         (!target.budget_seconds || resources.spent_seconds + level.seconds <= *target.budget_seconds);
}

[[noreturn]] void refuse_error(const LevelCost& best, const Target& target, const std::string& why) {
  throw InputError(
      fmt::format("--target-error: {} of {} can't be promised{} (found {}, allowed: `{}` is expected to "
                  "reach {}; ask for >= {})",
                  percent(*target.error), name_of(target.of), why, percent(*target.error), best.level,
                  percent(best.error), percent(rounded_up(best.error))));
}

[[noreturn]] void refuse_budget(const LevelCost& cheapest, const Target& target, const Resources& resources) {
  const double needed = resources.spent_seconds + cheapest.seconds;
  throw InputError(
      fmt::format("--budget: too short for `{}`, the cheapest level that would do (found {}, allowed at "
                  "least {})",
                  cheapest.level, seconds(*target.budget_seconds), seconds(rounded_up(needed))));
}

/// Number at the beginning of a text, and the rest without blanks.
std::pair<std::optional<double>, std::string> number_and_unit(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !std::isfinite(value)) return {std::nullopt, text};
  std::string unit(end, text.data() + text.size());
  std::erase(unit, ' ');
  return {value, unit};
}

}  // namespace

std::string name_of(ErrorOf of) { return of == ErrorOf::domain ? "domain" : "columns"; }

std::size_t choose_level(std::span<const LevelCost> levels, const Target& target, const Resources& resources) {
  assert(!levels.empty() && (target.error || target.budget_seconds));
  std::optional<std::size_t> chosen, in_memory;
  const LevelCost* cheapest_enough = nullptr;
  for (std::size_t n = 0; n < levels.size(); ++n) {
    const LevelCost& level = levels[n];
    if (level.memory_bytes > resources.memory_bytes) continue;
    if (!in_memory || level.error < levels[*in_memory].error) in_memory = n;
    const bool enough = !target.error || level.error <= *target.error;
    if (!enough) continue;
    if (cheapest_enough == nullptr || level.seconds < cheapest_enough->seconds) cheapest_enough = &level;
    if (!fits(level, target, resources)) continue;
    const bool better =
        !chosen || (target.error ? level.seconds < levels[*chosen].seconds : level.error < levels[*chosen].error);
    if (better) chosen = n;
  }
  if (chosen) return *chosen;
  if (!in_memory) {
    throw InputError(
        fmt::format("no level of accuracy fits into memory (found {:.2f} GB needed by `{}`, allowed {:.2f} GB)",
                    levels.front().memory_bytes / 1e9, levels.front().level, resources.memory_bytes / 1e9));
  }
  if (cheapest_enough != nullptr) {
    const LevelCost* best_in_time = nullptr;
    for (const LevelCost& level : levels) {
      if (fits(level, target, resources) && (best_in_time == nullptr || level.error < best_in_time->error))
        best_in_time = &level;
    }
    if (target.error && best_in_time != nullptr)
      refuse_error(*best_in_time, target,
                   fmt::format(" within {} (`{}` would take {})", seconds(*target.budget_seconds),
                               cheapest_enough->level, seconds(resources.spent_seconds + cheapest_enough->seconds)));
    refuse_budget(*cheapest_enough, target, resources);
  }
  const bool all_fit = std::all_of(levels.begin(), levels.end(), [&](const LevelCost& level) {
    return level.memory_bytes <= resources.memory_bytes;
  });
  refuse_error(levels[*in_memory], target, all_fit ? "" : " in the available memory");
}

std::optional<std::size_t> next_level(std::span<const LevelCost> levels, std::size_t level, const Target& target,
                                      const Resources& resources) {
  if (level + 1 >= levels.size() || !fits(levels[level + 1], target, resources)) return std::nullopt;
  return level + 1;
}

double parse_target_error(const std::string& text) {
  const auto [value, unit] = number_and_unit(text);
  const double fraction = value.value_or(0) * (unit == "%" ? .01 : 1);
  if (!value || (unit != "%" && !unit.empty()) || fraction <= 0 || fraction >= 1)
    throw InputError(
        fmt::format("--target-error: found '{}', allowed a share above 0 and below 1, as 1% or 0.01", text));
  return fraction;
}

double parse_budget(const std::string& text) {
  const auto [value, unit] = number_and_unit(text);
  const double scale = unit.empty() || unit == "s" ? 1 : unit == "m" ? 60 : unit == "h" ? 3600 : 0;
  if (!value || *value <= 0 || scale == 0)
    throw InputError(fmt::format("--budget: found '{}', allowed a time above 0, as 30s, 2m or 1.5h", text));
  return *value * scale;
}

}  // namespace cloudbow

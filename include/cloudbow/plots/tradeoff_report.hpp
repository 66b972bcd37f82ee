// Error against cost as a table, a CSV file and a plot.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cloudbow/results/tradeoff.hpp"

namespace cloudbow {

struct TradeoffRow {
  std::string level;
  SolveCost cost;
  std::optional<FluxErrors> errors;  ///< none: the row is the truth of the others
};

struct TradeoffReport {
  std::string title;
  std::string truth;               ///< a level, or a file
  std::vector<TradeoffRow> rows;   ///< in the order of the ladder
  std::vector<std::string> notes;  ///< levels left out, and why
};

/// Ends with a newline. An asterisk marks errors on the Pareto front against CPU seconds.
std::string tradeoff_table(const TradeoffReport& report);

/// One line per level after a header; the truth has no errors. @throws InputError if it cannot be written.
void write_tradeoff_csv(const std::filesystem::path& file, const TradeoffReport& report);

/// Errors against CPU seconds, both logarithmic (PNG). @throws InputError if it cannot be written.
void write_tradeoff_plot(const std::filesystem::path& file, const TradeoffReport& report);

}  // namespace cloudbow

#include "cloudbow/io/phase_set_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <utility>

#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/input_file.hpp"
#include "cloudbow/optics/legendre_series.hpp"
#include "io/number_rows.hpp"

namespace cloudbow {
namespace {

constexpr double rounding = 1e-4;  // of tables with five decimals

/// Moments as the file has them, brought to chi_l.
std::vector<double> without_factor(std::vector<double> moments) {
  for (std::size_t l = 1; l < moments.size(); ++l) moments[l] /= static_cast<double>(2 * l + 1);
  return moments;
}

bool is_negative(const std::vector<double>& moments) { return least_value(moments).value < least_allowed(moments); }

/// Moments with the factor 2l+1 rise above 1, or they are those of a function that is negative without it.
bool includes_factor(const std::vector<std::vector<double>>& functions, double largest) {
  if (largest > 1 + rounding) return true;
  return std::any_of(functions.begin(), functions.end(), is_negative) &&
         std::none_of(functions.begin(), functions.end(),
                      [](const auto& moments) { return is_negative(without_factor(moments)); });
}

}  // namespace

PhaseSetFile read_phase_set_file(const std::filesystem::path& file, MomentFactor factor) {
  std::ifstream stream = open_input(file, "a text file", most_text_bytes);
  PhaseSetFile set;
  std::string line;
  std::size_t degree = 0;
  double largest = 0;
  for (int number = 1; std::getline(stream, line); ++number) {
    const auto row = numbers_in(line);
    const auto fail = [&](const std::string& problem) {
      throw InputError(fmt::format("{}:{}: {}", file.string(), number, problem));
    };
    if (!row && set.moments.empty()) continue;  // names of the columns
    if (!row) fail("not numbers (allowed: l and the moments of that degree)");
    if (row->empty()) continue;
    if (set.moments.empty()) set.moments.resize(row->size() - 1);
    if (set.moments.empty()) fail("no phase function (allowed: l, then a column for each)");
    if (row->size() != set.moments.size() + 1) {
      fail(fmt::format("{} numbers (allowed: l and {}, as in the first row)", row->size(), set.moments.size()));
    }
    if ((*row)[0] != static_cast<double>(degree)) {
      fail(fmt::format("degree out of order (found l = {}, allowed {})", (*row)[0], degree));
    }
    for (std::size_t p = 0; p < set.moments.size(); ++p) {
      const double moment = (*row)[p + 1];
      if (!(std::abs(moment) <= static_cast<double>(2 * degree + 1) * (1 + rounding))) {
        fail(fmt::format("moment of function {} out of range (found {})", p + 1, moment));
      }
      set.moments[p].push_back(moment);
      largest = std::max(largest, std::abs(moment));
    }
    ++degree;
  }
  if (degree < 2)
    throw InputError(fmt::format("{}: too few rows (found {}, allowed l = 0, 1, ...)", file.string(), degree));
  set.factor_was_included =
      factor == MomentFactor::included || (factor == MomentFactor::automatic && includes_factor(set.moments, largest));
  if (!set.factor_was_included && largest > 1 + rounding) {
    throw InputError(
        fmt::format("{}: a moment is {} (allowed: -1 to 1, without the factor 2l+1)", file.string(), largest));
  }
  for (std::size_t p = 0; p < set.moments.size(); ++p) {
    std::vector<double>& moments = set.moments[p];
    if (std::abs(moments[0] - 1) > rounding) {
      throw InputError(fmt::format("{}: moment 0 of function {} is {} (allowed: 1)", file.string(), p + 1, moments[0]));
    }
    moments[0] = 1;
    while (moments.size() > 2 && moments.back() == 0) moments.pop_back();
    if (set.factor_was_included) moments = without_factor(std::move(moments));
    for (double& moment : moments) moment = std::clamp(moment, -1.0, 1.0);
    try {
      const std::string note = check_not_negative(moments);
      if (!note.empty() && set.note.empty()) set.note = fmt::format("function {}: {}", p + 1, note);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: function {}: {}", file.string(), p + 1, error.what()));
    }
  }
  return set;
}

void write_phase_set_file(const std::filesystem::path& file, const std::vector<std::vector<double>>& moments) {
  std::size_t degrees = 2;
  for (const auto& function : moments) degrees = std::max(degrees, function.size());
  std::string text =
      "# Legendre moments chi_l without the factor 2l+1, one column per phase function, counted from 1\nl";
  for (std::size_t p = 0; p < moments.size(); ++p) text += fmt::format(",chi_phase{}", p + 1);
  text += '\n';
  for (std::size_t l = 0; l < degrees; ++l) {
    text += fmt::format("{}", l);
    for (const auto& function : moments) text += fmt::format(",{:.9g}", l < function.size() ? function[l] : 0.0);
    text += '\n';
  }
  write_file_atomically(file, text);
}

}  // namespace cloudbow

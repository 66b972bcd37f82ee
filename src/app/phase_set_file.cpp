#include "cloudbow/app/phase_set_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/input_file.hpp"

namespace cloudbow {
namespace {

constexpr std::uintmax_t kMaxBytes = 256u << 20;
constexpr double kRounding = 1e-4;  // of tables with five decimals

/// None where a word is no number.
std::optional<std::vector<double>> numbers_in(std::string_view line) {
  constexpr std::string_view separators = " \t\r,";
  std::vector<double> value;
  for (std::size_t at = line.find_first_not_of(separators); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(separators, at), line.size());
    double number = 0;
    const auto [stop, error] = std::from_chars(line.data() + at, line.data() + end, number);
    if (error != std::errc() || stop != line.data() + end) return std::nullopt;
    value.push_back(number);
    at = line.find_first_not_of(separators, end);
  }
  return value;
}

}  // namespace

PhaseSetFile read_phase_set_file(const std::filesystem::path& file, MomentFactor factor) {
  std::ifstream stream = open_input(file, "a text file", kMaxBytes);
  PhaseSetFile set;
  std::string line;
  std::size_t degree = 0;
  double largest = 0;
  for (int number = 1; std::getline(stream, line); ++number) {
    const auto row = numbers_in(std::string_view(line).substr(0, line.find('#')));
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
      if (!(std::abs(moment) <= static_cast<double>(2 * degree + 1) * (1 + kRounding))) {
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
      factor == MomentFactor::included || (factor == MomentFactor::automatic && largest > 1 + kRounding);
  if (!set.factor_was_included && largest > 1 + kRounding) {
    throw InputError(
        fmt::format("{}: a moment is {} (allowed: -1 to 1, without the factor 2l+1)", file.string(), largest));
  }
  for (std::size_t p = 0; p < set.moments.size(); ++p) {
    std::vector<double>& moments = set.moments[p];
    if (std::abs(moments[0] - 1) > kRounding) {
      throw InputError(fmt::format("{}: moment 0 of function {} is {} (allowed: 1)", file.string(), p + 1, moments[0]));
    }
    moments[0] = 1;
    while (moments.size() > 2 && moments.back() == 0) moments.pop_back();
    for (std::size_t l = 1; l < moments.size(); ++l) {
      if (set.factor_was_included) moments[l] /= static_cast<double>(2 * l + 1);
      moments[l] = std::clamp(moments[l], -1.0, 1.0);
    }
  }
  return set;
}

void write_phase_set_file(const std::filesystem::path& file, const std::vector<std::vector<double>>& moments) {
  std::size_t degrees = 2;
  for (const auto& function : moments) degrees = std::max(degrees, function.size());
  std::string text = "# Legendre moments chi_l without the factor 2l+1, one column a phase function, counted from 1\nl";
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

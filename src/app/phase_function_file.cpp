#include "cloudbow/app/phase_function_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/printable.hpp"

namespace cloudbow {
namespace {

std::vector<std::pair<double, double>> read_pairs(const std::filesystem::path& file) {
  constexpr std::uintmax_t max_bytes = 64u << 20;
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) throw InputError(fmt::format("{}: there is no such file", file.string()));
  if (!std::filesystem::is_regular_file(status)) {
    throw InputError(fmt::format("{}: {} (allowed: a text file)", file.string(),
                                 std::filesystem::is_directory(status) ? "a directory" : "not a file"));
  }
  if (std::filesystem::file_size(file, error) > max_bytes) {
    throw InputError(fmt::format("{}: too large (allowed at most {} MB)", file.string(), max_bytes >> 20));
  }
  std::ifstream stream(file);
  if (!stream) throw InputError(fmt::format("{}: cannot be opened", file.string()));
  std::vector<std::pair<double, double>> pairs;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const std::string content = line.substr(0, line.find('#'));
    if (content.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::istringstream words(content);
    std::pair<double, double> pair;
    std::string rest;
    if (!(words >> pair.first >> pair.second) || words >> rest || !std::isfinite(pair.first) ||
        !std::isfinite(pair.second)) {
      throw InputError(fmt::format("{}:{}: not two numbers (found '{}', allowed two numbers and a # comment)",
                                   file.string(), number, printable(line.substr(0, 80))));
    }
    pairs.push_back(pair);
  }
  return pairs;
}

/// Puts the file's name before what is wrong with its numbers.
template <class Make>
PhaseFunction made_from(const std::filesystem::path& file, const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", file.string(), error.what()));
  }
}

}  // namespace

PhaseFunction read_legendre_file(const std::filesystem::path& file) {
  std::vector<double> moments;
  for (const auto& [l, chi] : read_pairs(file)) {
    if (l != static_cast<double>(moments.size())) {
      throw InputError(
          fmt::format("{}: moments out of order (found l = {}, allowed l = {}: 0, 1, 2, ... on lines \"l chi_l\")",
                      file.string(), l, moments.size()));
    }
    moments.push_back(chi);
  }
  return made_from(file, [&] { return PhaseFunction::legendre(moments); });
}

PhaseFunction read_phase_table_file(const std::filesystem::path& file) {
  std::vector<double> angle;
  std::vector<double> value;
  for (const auto& [a, v] : read_pairs(file)) {
    angle.push_back(a);
    value.push_back(v);
  }
  return made_from(file, [&] { return PhaseFunction::table(angle, value); });
}

}  // namespace cloudbow

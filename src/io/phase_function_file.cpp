#include "cloudbow/io/phase_function_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/input_file.hpp"
#include "cloudbow/core/printable.hpp"
#include "cloudbow/optics/legendre_series.hpp"
#include "cloudbow/optics/phase_table.hpp"
#include "io/number_rows.hpp"

namespace cloudbow {
namespace {

/// All rows that hold numbers, each as many as the first: `least` to 2.
std::vector<std::vector<double>> read_rows(const std::filesystem::path& file, std::size_t least, const char* layout) {
  std::ifstream stream = open_input(file, "a text file", most_text_bytes);
  std::vector<std::vector<double>> rows;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    auto row = numbers_in(line);
    if (row && row->empty()) continue;
    if (!row || row->size() < least || row->size() > 2 || (!rows.empty() && row->size() != rows.front().size())) {
      throw InputError(fmt::format("{}:{}: wrong layout (found '{}', allowed {}, with # or ! comments)", file.string(),
                                   number, printable(line.substr(0, 80)), layout));
    }
    rows.push_back(std::move(*row));
  }
  return rows;
}

/// Puts the file's name before what is wrong with its numbers.
template <class Make>
auto made_from(const std::filesystem::path& file, const Make& make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", file.string(), error.what()));
  }
}

struct AngleTable {
  std::vector<double> angle_deg;
  std::vector<double> value;
};

/// Conversion of an axis to ascending degrees, if its ends fit radians or cosines alone.
void to_ascending_degrees(AngleTable& table, std::vector<std::string>& notes) {
  std::vector<double>& axis = table.angle_deg;
  if (axis.size() < 2) return;
  constexpr double rounding = 2e-3;  // of pi as 3.14
  const auto runs = [&](double from, double to, double slack) {
    return std::abs(axis.front() - from) <= slack && std::abs(axis.back() - to) <= slack;
  };
  const bool cosines = runs(-1, 1, 0) || runs(1, -1, 0);
  const bool radians = runs(0, std::numbers::pi, rounding) || runs(std::numbers::pi, 0, rounding);
  if (cosines) {
    for (double& x : axis) x = std::acos(std::clamp(x, -1.0, 1.0)) * 180 / std::numbers::pi;
    notes.emplace_back("read as a table over the cosine of the scattering angle");
  } else if (radians) {
    for (double& x : axis) x *= 180 / std::numbers::pi;
    notes.emplace_back("read as a table over the scattering angle in radians");
  }
  if (axis.front() > axis.back()) {
    std::reverse(axis.begin(), axis.end());
    std::reverse(table.value.begin(), table.value.end());
  }
  if (radians || cosines) {
    axis.front() = 0;
    axis.back() = 180;
  }
}

/// Tables are of mean 1, or of integral 1 over the cosine or over the sphere.
void check_norm(const AngleTable& table, std::vector<std::string>& notes) {
  struct Norm {
    double mean;
    const char* meaning;
  };
  constexpr std::array<Norm, 3> norms{{{1, "mean 1 over the sphere"},
                                       {0.5, "integral 1 over the cosine"},
                                       {0.25 * std::numbers::inv_pi, "integral 1 over the sphere"}}};
  constexpr double largest_error = 1e-2, told_error = 1e-3;
  const double mean = make_phase_table(table.angle_deg, table.value).mean();
  const auto off = [mean](const Norm& norm) { return std::abs(mean / norm.mean - 1); };
  const Norm& norm =
      *std::min_element(norms.begin(), norms.end(), [&](const Norm& a, const Norm& b) { return off(a) < off(b); });
  if (!(off(norm) <= largest_error)) {
    throw InputError(
        fmt::format("phase function table: wrong norm (found mean {:.6g} over the sphere, allowed 1, 1/2 or 1/(4 pi), "
                    "to 1 %); give more angles in peaks, between which values are taken linearly in the cosine; if "
                    "the table is fine enough, divide its values by {:.6g}",
                    mean, mean));
  }
  if (norm.mean != 1) notes.push_back(fmt::format("read as a table of {}", norm.meaning));
  if (off(norm) > told_error) {
    notes.push_back(
        fmt::format("the table's integral is off by {:+.2f} %: its values are scaled", 100 * (mean / norm.mean - 1)));
  }
}

}  // namespace

PhaseFunctionFile read_legendre_file(const std::filesystem::path& file) {
  std::vector<double> moments;
  for (const auto& row : read_rows(file, 1, "\"l chi_l\", or \"chi_l\" on each line")) {
    if (row.size() == 2 && row[0] != static_cast<double>(moments.size())) {
      throw InputError(
          fmt::format("{}: moments out of order (found l = {}, allowed l = {}: 0, 1, 2, ... on lines \"l chi_l\")",
                      file.string(), row[0], moments.size()));
    }
    moments.push_back(row.back());
  }
  return made_from(file, [&] {
    PhaseFunctionFile read{PhaseFunction::legendre(moments), {}};
    if (auto note = check_not_negative(read.function.moments()); !note.empty()) read.notes.push_back(std::move(note));
    return read;
  });
}

PhaseFunctionFile read_phase_table_file(const std::filesystem::path& file) {
  AngleTable table;
  std::vector<std::string> notes;
  for (const auto& row : read_rows(file, 2, "two numbers, \"angle_deg value\"")) {
    table.angle_deg.push_back(row[0]);
    table.value.push_back(row[1]);
  }
  return made_from(file, [&] {
    to_ascending_degrees(table, notes);
    check_norm(table, notes);
    return PhaseFunctionFile{PhaseFunction::table(table.angle_deg, table.value), std::move(notes)};
  });
}

}  // namespace cloudbow

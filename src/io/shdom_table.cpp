#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/input_file.hpp"
#include "cloudbow/core/number_text.hpp"
#include "cloudbow/core/text_case.hpp"
#include "io/droplet_table_readers.hpp"

namespace cloudbow {
namespace {

constexpr std::uintmax_t max_bytes = 256u << 20;
constexpr int max_degree = 1 << 20;

/// The numbers at the front of a line.
std::vector<double> leading_numbers(std::string_view line) {
  std::vector<double> numbers;
  for (const std::string_view word : split_words(line)) {
    const auto number = number_in(word);
    if (!number || !std::isfinite(*number)) break;
    numbers.push_back(*number);
  }
  return numbers;
}

/// @param line in lower case
bool is_row_head(const std::string& line) {
  return line.find("reff") != std::string::npos && line.find("ext") != std::string::npos;
}

/// Coefficients of one radius, (2l+1) chi_l for l = 0 .. degree. Polarised tables have more elements of the phase
/// matrix behind them; SHDOM's begin each with its number.
std::vector<double> moments_of(const std::vector<double>& numbers, int degree, double radius) {
  const auto count = static_cast<std::size_t>(degree) + 1;
  std::size_t first = 0;
  if (numbers.size() == 6 * (count + 1) && numbers[0] == 1 && numbers[count + 1] == 2) {
    first = 1;
  } else if (numbers.size() < count || numbers.size() % count != 0) {
    throw InputError(
        fmt::format("effective radius {} um: wrong number of Legendre coefficients (found {}, allowed {}, as "
                    "Nleg {} says)",
                    radius, numbers.size(), count, degree));
  }
  std::vector<double> moments(count);
  for (std::size_t l = 0; l < count; ++l) moments[l] = numbers[first + l] / static_cast<double>(2 * l + 1);
  while (moments.size() > 2 && moments.back() == 0) moments.pop_back();
  return moments;
}

}  // namespace

bool is_shdom_table(std::string_view head) {
  return lower_case(std::string(head)).find("table vs. effective radius") != std::string::npos;
}

DropletTable read_shdom_table(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::file_size(path, error) > max_bytes) {
    throw InputError(fmt::format("too large (allowed at most {} MB)", max_bytes >> 20));
  }
  std::ifstream stream = open_input(path, "a table of droplets");
  if (!stream) throw InputError("cannot be opened");
  DropletTable table;
  double rows = 0;
  int degree = 0;
  std::vector<double> numbers;
  const auto finish_row = [&] {
    if (!table.effective_radius_um.empty()) {
      table.moments.push_back(moments_of(numbers, degree, table.effective_radius_um.back()));
    }
    numbers.clear();
  };
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const std::string lower = lower_case(line);
    if (is_row_head(lower)) {
      finish_row();
      const std::vector<double> head = leading_numbers(line);
      if (head.size() < 4 || head[3] < 1 || head[3] > max_degree || head[3] != std::floor(head[3])) {
        throw InputError(
            fmt::format("line {}: not the head of a radius (found '{}', allowed radius, extinction, albedo, number of "
                        "Legendre terms)",
                        number, line.substr(0, 80)));
      }
      table.effective_radius_um.push_back(head[0]);
      table.extinction_m2_per_g.push_back(head[1] / 1000);  // from km-1 for 1 g/m3
      table.single_scattering_albedo.push_back(head[2]);
      degree = static_cast<int>(head[3]);
    } else if (!table.effective_radius_um.empty()) {
      const std::vector<double> more = leading_numbers(line);
      numbers.insert(numbers.end(), more.begin(), more.end());
    } else if (lower.find("wavelength") != std::string::npos) {
      const std::vector<double> edges = leading_numbers(line);
      if (!edges.empty()) table.wavelength_um = edges.size() > 1 ? (edges[0] + edges[1]) / 2 : edges[0];
    } else if (lower.find("ending effective radius") != std::string::npos) {
      const std::vector<double> axis = leading_numbers(line);
      if (!axis.empty()) rows = axis[0];
    }
  }
  finish_row();
  if (rows > 0 && static_cast<double>(table.size()) != rows) {
    throw InputError(
        fmt::format("incomplete (found {} effective radii, allowed {}, as its head says)", table.size(), rows));
  }
  return table;
}

}  // namespace cloudbow

// Functions that the tests of files of phase functions share.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/io/phase_function_file.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {

inline constexpr double degree = std::numbers::pi / 180;

class PhaseFiles : public testing::Test {
 protected:
  PhaseFunctionFile table(const std::string& text) const {
    return read_phase_table_file(folder_.write("table.txt", text));
  }
  PhaseFunctionFile legendre(const std::string& text) const {
    return read_legendre_file(folder_.write("moments.txt", text));
  }
  static std::string message(const std::function<void()>& read) {
    try {
      read();
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  std::string table_message(const std::string& text) const {
    return message([&] { table(text); });
  }
  std::string legendre_message(const std::string& text) const {
    return message([&] { legendre(text); });
  }

  const TemporaryFolder folder_;
};

/// Henyey and Greenstein's function of .5 at `count` + 1 equal steps of the angle. Each line is made by `line` of
/// degrees and value.
inline std::string lines(int count, const std::function<std::string(double, double)>& line, double factor = 1) {
  const PhaseFunction phase = PhaseFunction::henyey_greenstein(0.5);
  std::string text;
  for (int n = 0; n <= count; ++n) {
    const double angle = 180.0 * n / count;
    text += line(angle, factor * phase(std::cos(angle * degree))) + "\n";
  }
  return text;
}

inline std::string plain(double angle, double value) { return fmt::format("{} {}", angle, value); }

/// Steps of a degree: linear interpolation leaves less than 1e-4.
inline void expect_henyey_greenstein(const PhaseFunctionFile& read) {
  EXPECT_NEAR(read.function.asymmetry_parameter(), 0.5, 1e-4);
  EXPECT_NEAR(read.function.moment(2), 0.25, 1e-4);
  EXPECT_NEAR(read.function(0.3), PhaseFunction::henyey_greenstein(0.5)(0.3), 1e-3);
}

}  // namespace cloudbow

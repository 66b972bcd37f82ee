// The command line as a user calls it, with what it prints.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

#include "cloudbow/app/command_line.hpp"

namespace cloudbow {

struct Outcome {
  int exit_code;
  std::string output;
  std::string errors;
};

inline Outcome cloudbow(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "cloudbow");
  std::vector<const char*> argv;
  for (const std::string& argument : arguments) argv.push_back(argument.c_str());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int exit_code = run_command_line(static_cast<int>(argv.size()), argv.data());
  std::fflush(stdout);
  return {exit_code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

inline const std::string slab_toml = R"([[layer]]
bottom_m = 0
top_m = 100
optical_depth = 1
single_scattering_albedo = 0.9
phase_function = "rayleigh"
[sun]
zenith_deg = 60
azimuth_deg = 0
[solver]
accuracy = "draft"
)";

/// Text that a run printed on lines that begin with a word.
inline std::vector<std::string> lines_of(const std::string& text, const std::string& word) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with(word)) lines.push_back(line);
  }
  return lines;
}

}  // namespace cloudbow

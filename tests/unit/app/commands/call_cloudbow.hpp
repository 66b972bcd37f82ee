// The command line as a user calls it, with what it prints.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
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

}  // namespace cloudbow

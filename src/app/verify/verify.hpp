// `cloudbow verify`: the built-in physical checks. Each is a property of light in any scene, or a published number. The
// program computes it itself, on the machine it runs on, without any file.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace cloudbow {

/// One property, as a single number >= 0: its deviation.
struct PhysicalCheck {
  std::string name;       ///< small letters, words joined by hyphens
  std::string statement;  ///< the property that must hold
  std::string unit;       ///< of the deviation and the tolerance
  double tolerance = 0;
  std::function<double()> deviation;
};

struct CheckOutcome {
  double found = 0;  ///< the deviation; not a number if the check ended in an error
  bool passed = false;
  std::string error;  ///< message of that error
  double seconds = 0;
};

struct VerifyOptions {
  std::vector<std::string> only;  ///< names of checks; empty: all
  bool json = false;              ///< one JSON document in the place of lines
  bool list = false;              ///< name and statement of the checks; nothing is checked
};

/// All checks, in the order of execution: prerequisites of others come first.
std::vector<PhysicalCheck> physical_checks();

/// Passed if the deviation is within the tolerance. A deviation that is not a number, and an error, are failures.
CheckOutcome carry_out(const PhysicalCheck& check);

/// Carries out the checks and prints one line per check to stdout.
/// @returns exit_done, or exit_does_not_hold if any has failed.
/// @throws InputError for a name that no check has.
int verify(const std::vector<PhysicalCheck>& checks, const VerifyOptions& options);

}  // namespace cloudbow

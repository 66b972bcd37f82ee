#include "app/commands/verify_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "app/commands/command_checks.hpp"
#include "app/process/cache_directory.hpp"
#include "app/process/exit_codes.hpp"
#include "app/process/messages.hpp"
#include "app/process/version.hpp"
#include "app/verify/checks.hpp"
#include "app/verify/machine_speed.hpp"
#include "app/verify/verify.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

constexpr double slow_seconds = 10;  // checks take less than this in all; beyond it, progress is printed

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

std::vector<PhysicalCheck> chosen(const std::vector<PhysicalCheck>& checks, const std::vector<std::string>& only) {
  std::vector<std::string> names;
  for (const PhysicalCheck& check : checks) names.push_back(check.name);
  for (const std::string& name : only) {
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw InputError(fmt::format("--only: no such check (found \"{}\", allowed {})", name, joined(names)));
  }
  std::vector<PhysicalCheck> those;
  std::copy_if(checks.begin(), checks.end(), std::back_inserter(those), [&only](const PhysicalCheck& check) {
    return only.empty() || std::find(only.begin(), only.end(), check.name) != only.end();
  });
  return those;
}

void print_line(const PhysicalCheck& check, const CheckOutcome& outcome) {
  fmt::print("{:<22} {:>8.2g}  tolerance {:<7.2g} {:<22} {}", check.name, outcome.found, check.tolerance, check.unit,
             outcome.passed ? "passed" : "FAILED");
  if (!outcome.passed) fmt::print(": {}", outcome.error.empty() ? check.statement : outcome.error);
  fmt::print("\n");
  std::fflush(stdout);
}

std::string json_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (static_cast<unsigned char>(c) < 0x20) {
      quoted += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

// JSON cannot express numbers that are not finite.
std::string json_number(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "null"; }

std::string json_entry(const PhysicalCheck& check, const CheckOutcome& outcome) {
  return fmt::format(
      "    {{\"name\": {}, \"found\": {}, \"tolerance\": {}, \"unit\": {}, \"passed\": {}, \"seconds\": {:.3f},\n"
      "     \"statement\": {}, \"error\": {}}}",
      json_text(check.name), json_number(outcome.found), json_number(check.tolerance), json_text(check.unit),
      outcome.passed, outcome.seconds, json_text(check.statement),
      outcome.error.empty() ? "null" : json_text(outcome.error));
}

}  // namespace

std::vector<PhysicalCheck> physical_checks() {
  std::vector<PhysicalCheck> all;
  for (const auto& part : {sphere_checks(), optics_checks(), column_checks(), energy_checks(), thermal_checks(),
                           direction_checks(), field_checks()}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

CheckOutcome carry_out(const PhysicalCheck& check) {
  const auto start = Clock::now();
  CheckOutcome outcome;
  try {
    outcome.found = check.deviation();
    outcome.passed = outcome.found <= check.tolerance;
  } catch (const std::exception& error) {
    outcome.found = std::numeric_limits<double>::quiet_NaN();
    outcome.error = error.what();
  }
  outcome.seconds = seconds_since(start);
  return outcome;
}

int verify(const std::vector<PhysicalCheck>& checks, const VerifyOptions& options) {
  const auto those = chosen(checks, options.only);
  if (options.list) {
    for (const PhysicalCheck& check : those) fmt::print("{:<22} {}\n", check.name, check.statement);
    return exit_done;
  }
  const auto start = Clock::now();
  std::size_t failed = 0;
  std::string entries;
  for (const PhysicalCheck& check : those) {
    if (seconds_since(start) > slow_seconds) tell("cloudbow: checking {}\n", check.name);
    const CheckOutcome outcome = carry_out(check);
    if (!outcome.passed) ++failed;
    if (options.json) {
      entries += (entries.empty() ? "" : ",\n") + json_entry(check, outcome);
    } else {
      print_line(check, outcome);
    }
  }
  const double seconds = seconds_since(start);
  if (options.json) {
    fmt::print(
        "{{\n  \"program\": {}, \"passed\": {}, \"failed_checks\": {}, \"seconds\": {:.3f},\n  \"checks\": [\n{}\n  "
        "]\n}}\n",
        json_text(fmt::format("cloudbow {}", version())), failed == 0, failed, seconds, entries);
  } else {
    fmt::print("{} of {} checks passed, {:.1f} s\n", those.size() - failed, those.size(), seconds);
  }
  return failed == 0 ? exit_done : exit_does_not_hold;
}

namespace {

int calibrate_and_tell() {
  const double factor = calibrate_machine();
  fmt::print("solves take {:.3g} times the seconds that the built-in figures predict; kept in {}\n", factor,
             cache_directory().string());
  return exit_done;
}

}  // namespace

void add_verify(CLI::App& app, std::function<int()>& action) {
  auto options = std::make_shared<VerifyOptions>();
  CLI::App* verify_app = app.add_subcommand("verify", "Check the physics of the program on this machine, in seconds");
  verify_app->add_option("--only", options->only, "These checks alone")->type_name("NAME ...");
  auto* json = verify_app->add_flag("--json", options->json, "One JSON document in the place of lines");
  verify_app->add_flag("--list", options->list, "List the checks and run none")->excludes(json);
  auto calibrate = std::make_shared<bool>(false);
  verify_app->add_flag(
      "--calibrate", *calibrate,
      "Measure this machine's speed in place of the checks, and keep it for run --dry-run and --budget");
  verify_app->footer(
      "A line has the deviation of the worst case, its unit and the tolerance (docs/verify.md). Scenes are made in "
      "memory; nothing is read or written. Exit codes: 0 all hold, 3 some do not, 2 wrong usage.");
  verify_app->callback([&action, options, calibrate] {
    action = [options, calibrate] { return *calibrate ? calibrate_and_tell() : verify(physical_checks(), *options); };
  });
}

}  // namespace cloudbow

// `cloudbow verify` if checks hold and if they do not. Truth: the exit codes promised (0 all hold, 3 some do not, 2
// wrong usage). That the checks themselves hold is tested on the program, by check_verify.py.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "app/process/exit_codes.hpp"
#include "app/verify/verify.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

PhysicalCheck check(const char* name, double deviation, double tolerance = 1e-3) {
  return {name, "what must hold", "of \"it\"", tolerance, [deviation] { return deviation; }};
}

PhysicalCheck throwing() {
  return {"throwing", "nothing", "1", 1, []() -> double { throw std::runtime_error("no \"table\"\n"); }};
}

struct Printed {
  int exit_code;
  std::string output;
};

Printed verified(const std::vector<PhysicalCheck>& checks, const VerifyOptions& options = {}) {
  testing::internal::CaptureStdout();
  const int exit_code = verify(checks, options);
  std::fflush(stdout);
  return {exit_code, testing::internal::GetCapturedStdout()};
}

TEST(Verify, PassesUpToTheToleranceAndNotBeyond) {
  EXPECT_TRUE(carry_out(check("a", 1e-3)).passed);
  EXPECT_FALSE(carry_out(check("a", 1.001e-3)).passed);
  EXPECT_TRUE(carry_out(check("a", 0, 0)).passed);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_FALSE(carry_out(check("a", bad)).passed);
  const CheckOutcome outcome = carry_out(throwing());
  EXPECT_FALSE(outcome.passed);
  EXPECT_TRUE(std::isnan(outcome.found));
  EXPECT_THAT(outcome.error, HasSubstr("no \"table\""));
}

TEST(Verify, PrintsALineACheck) {
  const Printed printed = verified({check("good", 2e-4), check("better", 0)});
  EXPECT_EQ(printed.exit_code, exit_done);
  EXPECT_EQ(std::count(printed.output.begin(), printed.output.end(), '\n'), 3);
  EXPECT_THAT(printed.output,
              AllOf(HasSubstr("good "), HasSubstr("0.0002"), HasSubstr("tolerance 0.001"), HasSubstr("of \"it\""),
                    HasSubstr("passed\n"), HasSubstr("2 of 2 checks passed"), Not(HasSubstr("FAILED"))));
}

TEST(Verify, ACheckThatFailsIsExitCode3) {
  const Printed printed = verified({check("good", 0), check("bad", .5), throwing(), check("last", 0)});
  EXPECT_EQ(printed.exit_code, 3);
  EXPECT_THAT(printed.output, AllOf(HasSubstr("FAILED: what must hold\n"), HasSubstr("FAILED: no \"table\""),
                                    HasSubstr("last "), HasSubstr("2 of 4 checks passed")));
}

TEST(Verify, JsonSaysTheSame) {
  VerifyOptions options;
  options.json = true;
  const Printed printed =
      verified({check("good", 2e-4), check("bad", std::numeric_limits<double>::quiet_NaN()), throwing()}, options);
  EXPECT_EQ(printed.exit_code, 3);
  EXPECT_THAT(
      printed.output,
      AllOf(HasSubstr("\"passed\": false, \"failed_checks\": 2"),
            HasSubstr("{\"name\": \"good\", \"found\": 0.0002, \"tolerance\": 0.001, \"unit\": \"of \\\"it\\\"\", "
                      "\"passed\": true"),
            HasSubstr("{\"name\": \"bad\", \"found\": null,"), HasSubstr("\"error\": \"no \\\"table\\\"\\u000a\"")));
}

TEST(Verify, OnlyThoseThatAreNamed) {
  VerifyOptions options;
  options.only = {"good"};
  const std::vector<PhysicalCheck> checks{check("good", 0), check("bad", 1)};
  const Printed printed = verified(checks, options);
  EXPECT_EQ(printed.exit_code, exit_done);
  EXPECT_THAT(printed.output, AllOf(HasSubstr("1 of 1 checks passed"), Not(HasSubstr("bad"))));
  options.only = {"good", "ugly"};
  try {
    verify(checks, options);
    FAIL() << "no check has this name";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("found \"ugly\""), HasSubstr("allowed good, bad")));
  }
}

TEST(Verify, ListsWithoutChecking) {
  VerifyOptions options;
  options.list = true;
  const Printed printed = verified({check("bad", 1)}, options);
  EXPECT_EQ(printed.exit_code, exit_done);
  EXPECT_THAT(printed.output, AllOf(HasSubstr("bad "), HasSubstr("what must hold"), Not(HasSubstr("FAILED"))));
}

TEST(Verify, ChecksHaveNamesOfTheirOwnAndSayWhatHolds) {
  std::set<std::string> names;
  for (const PhysicalCheck& check : physical_checks()) {
    EXPECT_TRUE(names.insert(check.name).second) << check.name;
    EXPECT_EQ(check.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-"), std::string::npos) << check.name;
    EXPECT_FALSE(check.statement.empty() || check.unit.empty()) << check.name;
    EXPECT_GE(check.tolerance, 0) << check.name;
  }
}

}  // namespace
}  // namespace cloudbow

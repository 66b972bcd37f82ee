// The table of a phase function. Truth: fits whose moments are feasible, and one whose are not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "phase_report_sample.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

TEST(PhaseTable, NamesWhatIsInfeasible) {
  EXPECT_THAT(phase_table(sample_report()), Not(HasSubstr("infeasible")));
  EXPECT_THAT(phase_table(sample_report(0.95)), HasSubstr("linear-programming: moments l <= 3 are infeasible"));
}

}  // namespace
}  // namespace cloudbow

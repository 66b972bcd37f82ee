// Weights of the error estimate by level. Truth: what docs/error-estimates.md promises of the table.
#include <gtest/gtest.h>

#include "app/planning/error_calibration.hpp"
#include "app/scene/accuracy.hpp"

namespace cloudbow {
namespace {

constexpr SolvedAs by_level[] = {SolvedAs::field, SolvedAs::column, SolvedAs::column_by_its_streams};

TEST(ErrorCalibration, TheDraftIsComparedWithItself) {
  for (const SolvedAs as : by_level) {
    const ByFlux ratio = error_ratio_to_draft("draft", as);
    EXPECT_EQ(ratio.domain, 1);
    EXPECT_EQ(ratio.up, 1);
    EXPECT_EQ(ratio.down, 1);
  }
}

TEST(ErrorCalibration, NoLevelIsExpectedToBeWorseThanTheOneBefore) {
  const std::vector<std::string> names = accuracy_names();
  for (const SolvedAs as : by_level) {
    for (std::size_t n = 1; n < names.size(); ++n) {
      const ByFlux before = error_ratio_to_draft(names[n - 1], as), here = error_ratio_to_draft(names[n], as);
      EXPECT_LE(here.domain, before.domain);
      EXPECT_LE(here.up, before.up);
      EXPECT_LE(here.down, before.down);
      EXPECT_GT(std::min({here.domain, here.up, here.down}), 0);
    }
  }
}

// Columns have no spatial error that a coarse solve of fewer cells would show.
TEST(ErrorCalibration, ColumnsHaveAngularWeightsAlone) {
  for (const std::string& name : accuracy_names()) {
    for (const SolvedAs as : {SolvedAs::column, SolvedAs::column_by_its_streams, SolvedAs::column_beside_streams}) {
      const ErrorWeights weights = error_weights(name, as);
      EXPECT_EQ(weights.spatial.domain, 0);
      EXPECT_EQ(weights.spatial.up, 0);
      EXPECT_EQ(weights.spatial.down, 0);
      EXPECT_GT(weights.angular.domain, 0);
    }
    EXPECT_GT(error_weights(name, SolvedAs::field).spatial.domain, 0);
  }
}

}  // namespace
}  // namespace cloudbow

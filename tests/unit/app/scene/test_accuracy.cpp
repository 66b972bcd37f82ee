// Levels of accuracy. Truth: a level is nowhere coarser than the one before it (docs/accuracy-and-speed.md).
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "app/scene/accuracy.hpp"
#include "cloudbow/sphere/ordinate_set.hpp"

namespace cloudbow {
namespace {

TEST(Accuracy, LevelsAreInTheirOrder) {
  EXPECT_EQ(accuracy_names(), (std::vector<std::string>{"draft", "balanced", "fine", "reference"}));
}

TEST(Accuracy, NoLevelIsCoarserThanTheOneBefore) {
  const std::vector<std::string> names = accuracy_names();
  for (const HorizontalExtent extent : {HorizontalExtent::column, HorizontalExtent::slice, HorizontalExtent::field}) {
    for (std::size_t n = 1; n < names.size(); ++n) {
      const SolverOptions coarse = accuracy_options(names[n - 1], extent, false);
      const SolverOptions fine = accuracy_options(names[n], extent, false);
      EXPECT_GE(fine.control_points, coarse.control_points);
      EXPECT_GT(make_ordinate_set(fine.directions).size(), make_ordinate_set(coarse.directions).size());
      EXPECT_GT(fine.fit.delta_m_order, coarse.fit.delta_m_order);
      EXPECT_GT(fine.fit.beam_delta_m_order, coarse.fit.beam_delta_m_order);
      EXPECT_GE(fine.fit.exact_moments, coarse.fit.exact_moments);
      EXPECT_GE(fine.gather_directions, coarse.gather_directions);
      EXPECT_GE(fine.column_streams, coarse.column_streams);
      EXPECT_LT(fine.tolerance, coarse.tolerance);
      EXPECT_LT(class_tolerance(names[n]), class_tolerance(names[n - 1]));
    }
  }
}

TEST(Accuracy, OneColumnIsSolvedInDoubleAndMeasuredPeaksAreTruncatedEarlier) {
  for (const std::string& name : accuracy_names()) {
    EXPECT_TRUE(accuracy_options(name, HorizontalExtent::column, false).double_precision);
    EXPECT_FALSE(accuracy_options(name, HorizontalExtent::field, false).double_precision);
    const SolverOptions measured = accuracy_options(name, HorizontalExtent::field, true);
    EXPECT_EQ(measured.fit.beam_delta_m_order, measured.fit.delta_m_order + 2);
    EXPECT_LE(measured.fit.beam_delta_m_order,
              accuracy_options(name, HorizontalExtent::field, false).fit.beam_delta_m_order);
  }
}

}  // namespace
}  // namespace cloudbow

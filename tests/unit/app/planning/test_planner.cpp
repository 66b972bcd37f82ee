// Truth: the rule itself, on invented cost estimates for which the answer is obvious.
#include <gtest/gtest.h>

#include "app/planning/planner.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

const std::vector<LevelCost> four_levels{
    {"draft", .02, 1, 1e8}, {"balanced", .01, 3, 2e8}, {"fine", .004, 10, 4e8}, {"reference", .003, 40, 8e8}};
constexpr Resources plenty{0, 1e12};

Target error_target(double error) { return {error, ErrorOf::domain, std::nullopt}; }
Target time_target(double seconds) { return {std::nullopt, ErrorOf::columns, seconds}; }

std::string refusal(const Target& target, const Resources& resources) {
  try {
    choose_level(four_levels, target, resources);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Planner, TakesTheCheapestLevelThatReachesTheError) {
  EXPECT_EQ(choose_level(four_levels, error_target(.05), plenty), 0u);
  EXPECT_EQ(choose_level(four_levels, error_target(.01), plenty), 1u);
  EXPECT_EQ(choose_level(four_levels, error_target(.005), plenty), 2u);
  EXPECT_EQ(choose_level(four_levels, error_target(.003), plenty), 3u);
}

TEST(Planner, TakesTheCheapestOfTwoLevelsEvenWhereItIsTheBetterOne) {
  const std::vector<LevelCost> levels{{"draft", .01, 5, 1e8}, {"balanced", .005, 2, 1e8}};
  EXPECT_EQ(choose_level(levels, error_target(.01), plenty), 1u);
}

TEST(Planner, TakesTheBestLevelWithinTheBudget) {
  EXPECT_EQ(choose_level(four_levels, time_target(2), plenty), 0u);
  EXPECT_EQ(choose_level(four_levels, time_target(12), plenty), 2u);
  EXPECT_EQ(choose_level(four_levels, time_target(100), plenty), 3u);
}

TEST(Planner, CountsTheTimeThatIsSpent) { EXPECT_EQ(choose_level(four_levels, time_target(12), {2.5, 1e12}), 1u); }

TEST(Planner, LeavesOutLevelsThatNeedMoreMemoryThanThereIs) {
  EXPECT_EQ(choose_level(four_levels, time_target(100), {0, 3e8}), 1u);
}

TEST(Planner, AnErrorOutOfReachIsRefusedWithTheLeastPossible) {
  const std::string text = refusal(error_target(.001), plenty);
  EXPECT_NE(text.find("`reference` is expected to reach 0.3 %; ask for >= 0.3 %"), std::string::npos) << text;
  EXPECT_NE(text.find("0.1 % of domain"), std::string::npos) << text;
}

TEST(Planner, WhatARefusalOffersIsAccepted) {
  std::vector<LevelCost> levels = four_levels;
  levels.back().error = .0034567;
  try {
    choose_level(levels, error_target(.001), plenty);
    FAIL() << "an error out of reach was accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("ask for >= 0.35 %"), std::string::npos) << error.what();
  }
  EXPECT_EQ(choose_level(levels, error_target(.0035), plenty), 3u);
}

TEST(Planner, AnErrorOutOfReachInTheMemorySaysSo) {
  const std::string text = refusal(error_target(.001), {0, 5e8});
  EXPECT_NE(text.find("in the available memory"), std::string::npos) << text;
  EXPECT_NE(text.find("`fine`"), std::string::npos) << text;
}

TEST(Planner, ABudgetTooShortIsRefusedWithTheLeastThatWouldDo) {
  const std::string text = refusal(time_target(.5), plenty);
  EXPECT_NE(text.find("--budget"), std::string::npos) << text;
  EXPECT_NE(text.find("at least 1 s"), std::string::npos) << text;
}

TEST(Planner, AnErrorOutOfReachWithinTheBudgetNamesBothWaysOut) {
  const std::string text = refusal({.004, ErrorOf::columns, 5}, plenty);
  EXPECT_NE(text.find("`fine` would take 10 s"), std::string::npos) << text;
  EXPECT_NE(text.find("`balanced` is expected to reach 1 %"), std::string::npos) << text;
}

TEST(Planner, NoLevelInMemoryIsRefused) {
  EXPECT_NE(refusal(error_target(.5), {0, 1e7}).find("memory"), std::string::npos);
}

TEST(Planner, TheNextLevelIsTakenWhereItFits) {
  EXPECT_EQ(next_level(four_levels, 1, error_target(.001), plenty), std::optional<std::size_t>(2));
  EXPECT_EQ(next_level(four_levels, 3, error_target(.001), plenty), std::nullopt);
  EXPECT_EQ(next_level(four_levels, 1, {.001, ErrorOf::domain, 12}, {3, 1e12}), std::nullopt);
  EXPECT_EQ(next_level(four_levels, 1, error_target(.001), {0, 3e8}), std::nullopt);
}

TEST(TargetError, IsAShareInPerCentOrPlain) {
  EXPECT_DOUBLE_EQ(parse_target_error("1%"), .01);
  EXPECT_DOUBLE_EQ(parse_target_error("0.3 %"), .003);
  EXPECT_DOUBLE_EQ(parse_target_error("0.02"), .02);
  for (const char* wrong : {"", "%", "0", "-1%", "100%", "1", "nan", "1s", "1%%", "inf%"})
    EXPECT_THROW(parse_target_error(wrong), InputError) << wrong;
}

TEST(Budget, IsATimeInSecondsMinutesOrHours) {
  EXPECT_DOUBLE_EQ(parse_budget("30s"), 30);
  EXPECT_DOUBLE_EQ(parse_budget("30"), 30);
  EXPECT_DOUBLE_EQ(parse_budget("2m"), 120);
  EXPECT_DOUBLE_EQ(parse_budget("1.5 h"), 5400);
  for (const char* wrong : {"", "s", "0s", "-3s", "nan", "3 days", "3ss"})
    EXPECT_THROW(parse_budget(wrong), InputError) << wrong;
}

}  // namespace
}  // namespace cloudbow

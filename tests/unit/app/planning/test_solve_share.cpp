// Solves shared out over ranks. Truth: the same solves in one process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "../../thread_ranks.hpp"
#include "app/planning/solve_share.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

/// A result with something in each of its members.
SolveResult result_of(std::size_t solve) {
  SolveResult result;
  const auto number = static_cast<float>(solve + 1);
  result.solution.box.z_edge_m = {0, 100, 300};
  result.solution.sun = Sun{Direction(0, .6, -.8), 2.0};
  result.solution.flux_level = {0, 2};
  result.solution.upwelling_flux = {number, 2 * number};
  result.solution.images.push_back({{"view", Direction(0, 0, 1), 1, 1}, {3 * number}});
  result.solution.camera_images.emplace_back().radiance = {4 * number};
  result.solution.radiance_field.emplace().radiance = {5 * number};
  result.solution.ledger.power = number;
  result.solution.report.mode = "3d";
  result.solution.report.sweeps = static_cast<int>(solve);
  result.independent_columns = result.solution;
  result.phase_classes = PhaseClassReport{9, 4, .1};
  result.clouds.push_back({"liquid", {1, 2}, .55, ColumnFigures{3, 4}, 5, std::array{6., 7.}, std::array{8., 9.}});
  result.error.emplace().calibrated_for = "draft";
  result.error->upwelling_flux_error = {number};
  result.cloud_optical_depth = {number};
  result.cloud_extinction = {number, 2 * number};
  return result;
}

TEST(SolveShare, ResultsComeBackWithAllTheirBytes) {
  const SolveResult result = result_of(4);
  const std::vector<std::byte> bytes = bytes_of(result);
  const SolveResult read = solve_result(bytes);
  EXPECT_EQ(bytes_of(read), bytes);
  EXPECT_EQ(read.solution.images.at(0).view.name, "view");
  EXPECT_EQ(read.solution.camera_images.at(0).radiance, result.solution.camera_images.at(0).radiance);
  EXPECT_EQ(read.solution.radiance_field->radiance, result.solution.radiance_field->radiance);
  EXPECT_EQ(read.solution.sun->travel, result.solution.sun->travel);
  EXPECT_EQ(read.clouds.at(0).temperature_k, result.clouds.at(0).temperature_k);
  EXPECT_THROW(solve_result(std::span(bytes).first(bytes.size() - 1)), InputError);
}

TEST(SolveShare, ResultsOfAllRanksComeTogetherInOrder) {
  for (const int size : {1, 2, 3, 5}) {
    ThreadRanks::run(size, [](Ranks& ranks) {
      SharedByRanks share(ranks);
      for (std::size_t solve = 0; solve < 4; ++solve) {
        const auto result = shared_solve(&share, solve, [&] { return result_of(solve); });
        EXPECT_EQ(result.has_value(), ranks.is_first());
        if (result) {
          EXPECT_EQ(bytes_of(*result), bytes_of(result_of(solve)));
        }
      }
    });
  }
}

TEST(SolveShare, AnErrorElsewhereIsThatOfTheSolve) {
  ThreadRanks::run(2, [](Ranks& ranks) {
    SharedByRanks share(ranks);
    const auto fail = [&](std::size_t solve, const auto& error) {
      return shared_solve(&share, solve, [&]() -> SolveResult { throw error; });
    };
    if (!ranks.is_first()) {
      EXPECT_FALSE(fail(1, InputError("scene.toml: wrong")));
      EXPECT_FALSE(fail(3, std::runtime_error("diverges")));
      return;
    }
    try {
      share.take(1);
      ADD_FAILURE();
    } catch (const InputError& error) {
      EXPECT_STREQ(error.what(), "scene.toml: wrong");
    }
    try {
      share.take(3);
      ADD_FAILURE();
    } catch (const InputError&) {
      ADD_FAILURE() << "another kind of error";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "diverges");
    }
  });
}

TEST(SolveShare, WithoutAShareAllIsSolvedHere) {
  EXPECT_TRUE(collects(nullptr));
  EXPECT_EQ(bytes_of(*shared_solve(nullptr, 2, [] { return result_of(2); })), bytes_of(result_of(2)));
}

}  // namespace
}  // namespace cloudbow

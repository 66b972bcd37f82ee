// Errors and fronts. Truth: closed forms, the definition of a Pareto front.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "../io/sample_solution.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/io/boundary_result.hpp"
#include "cloudbow/plots/tradeoff_report.hpp"
#include "cloudbow/results/tradeoff.hpp"

namespace cloudbow {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double na_n = std::numeric_limits<double>::quiet_NaN();

BoundaryResult two_columns() { return {"truth.h5", {50, 150}, {25}, {}, {{0.5, 0.375, {1, 3}, {2, 6}}}, {}}; }

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::temp_directory_path() / ("cloudbow-tradeoff-" + std::to_string(getpid()) + "-" + name);
}

std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(ParetoFront, OfPointsInAPlane) {
  const auto front = [](std::vector<double> cost, std::vector<double> error) { return pareto_front(cost, error); };
  EXPECT_THAT(front({1, 2, 3, 4}, {8, 4, 2, 1}), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(front({1, 2, 3, 4}, {4, 5, 1, 1}), ElementsAre(0, 2));
  EXPECT_THAT(front({4, 3, 2, 1}, {1, 2, 4, 8}), ElementsAre(3, 2, 1, 0));
  EXPECT_THAT(front({1, 1, 2}, {5, 3, 3}), ElementsAre(1));
  EXPECT_THAT(front({1, 1}, {3, 3}), ElementsAre(0));
  EXPECT_THAT(front({1, 2, 3}, {infinite, 0, na_n}), ElementsAre(1));
  EXPECT_THAT(front({}, {}), ElementsAre());
}

TEST(ParetoFront, IsWhatNoOtherPointBeats) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> few(0, 9);  // many ties
  for (int repeat = 0; repeat < 200; ++repeat) {
    std::vector<double> cost, error;
    for (int n = 0; n < 12; ++n) {
      cost.push_back(few(random));
      error.push_back(few(random));
    }
    std::vector<std::size_t> unbeaten;
    for (std::size_t i = 0; i < cost.size(); ++i) {
      bool beaten = false;
      for (std::size_t j = 0; j < cost.size(); ++j) {
        const bool no_worse = cost[j] <= cost[i] && error[j] <= error[i];
        const bool equal = cost[j] == cost[i] && error[j] == error[i];
        beaten = beaten || (no_worse && (!equal || j < i));
      }
      if (!beaten) unbeaten.push_back(i);
    }
    EXPECT_THAT(pareto_front(cost, error), testing::UnorderedElementsAreArray(unbeaten));
  }
}

TEST(FluxErrors, InClosedForm) {
  const BoundaryResult truth = two_columns();
  BoundaryResult result = truth;
  result.fluxes[0] = {0.53125, 0.3125, {2, 4}, {2, 0}};
  const FluxErrors errors = flux_errors(result, truth);
  EXPECT_DOUBLE_EQ(errors.domain, 6.25);  // transmittance is farther off than reflectance
  EXPECT_DOUBLE_EQ(errors.up, 50);        // 1 / 2
  EXPECT_DOUBLE_EQ(errors.down, 100 * std::sqrt(18) / 4);
}

TEST(FluxErrors, OfAResultAgainstItselfAreZero) {
  BoundaryResult truth = two_columns();
  truth.fluxes[0].down_at_bottom = {0, 0};  // nothing comes through: no division of 0 by 0
  const FluxErrors errors = flux_errors(truth, truth);
  EXPECT_EQ(errors.domain, 0);
  EXPECT_EQ(errors.up, 0);
  EXPECT_EQ(errors.down, 0);
}

TEST(FluxErrors, OfASpectrumAreTheLargest) {
  BoundaryResult truth = two_columns();
  truth.wavelengths_um = {0.5, 0.6};
  truth.fluxes.push_back(truth.fluxes[0]);
  BoundaryResult result = truth;
  result.fluxes[0].reflectance += 0.25;
  result.fluxes[1].up_at_top = {2, 4};
  const FluxErrors errors = flux_errors(result, truth);
  EXPECT_DOUBLE_EQ(errors.domain, 25);
  EXPECT_DOUBLE_EQ(errors.up, 50);
  EXPECT_EQ(errors.down, 0);
}

TEST(FluxErrors, NeedTheSameColumnsAndWavelengths) {
  const BoundaryResult truth = two_columns();
  BoundaryResult other = truth;
  other.x_m = {50, 150, 250};
  EXPECT_THAT([&] { flux_errors(other, truth); }, ThrowsMessage<InputError>(HasSubstr("2 x 1 columns")));
  other = truth;
  other.y_m = {75};
  EXPECT_THAT([&] { flux_errors(other, truth); }, ThrowsMessage<InputError>(HasSubstr("truth.h5")));
  other = truth;
  other.wavelengths_um = {0.5};
  EXPECT_THAT([&] { flux_errors(other, truth); }, ThrowsMessage<InputError>(HasSubstr("wavelengths")));
}

class BoundaryFile : public testing::Test {
 protected:
  ~BoundaryFile() override { std::filesystem::remove(file_); }
  const std::filesystem::path file_ = temporary("result.h5");
};

TEST_F(BoundaryFile, IsReadAtTopAndBottom) {
  for (const std::vector<int>& levels : {std::vector<int>{}, std::vector<int>{0, 4}}) {
    write_result(file_, sample::solution(3, 2, 4, levels), sample::info());
    const BoundaryResult result = read_boundary_result(file_);
    ASSERT_EQ(result.fluxes.size(), 1U);
    EXPECT_EQ(result.fluxes[0].reflectance, 0.5);
    EXPECT_EQ(result.fluxes[0].transmittance, 0.375);
    EXPECT_THAT(result.x_m, ElementsAre(112.5, 137.5, 162.5));
    EXPECT_THAT(result.y_m, ElementsAre(-25, 25));
    ASSERT_EQ(result.fluxes[0].up_at_top.size(), 6U);
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 3; ++i) {
        const auto column = static_cast<std::size_t>(3 * j + i);
        EXPECT_EQ(result.fluxes[0].up_at_top[column], sample::field_value(1, 4, j, i));
        EXPECT_EQ(result.fluxes[0].down_at_bottom[column],
                  sample::field_value(2, 0, j, i) + sample::field_value(3, 0, j, i));
      }
    }
    EXPECT_EQ(result.cost.cpu_seconds, 24);
    EXPECT_EQ(result.cost.wall_seconds, 12.5);
    EXPECT_EQ(result.cost.table_seconds, 0.5);
    EXPECT_EQ(result.cost.peak_memory_bytes, 6e9);
    EXPECT_EQ(result.cost.sweeps, 17);
    EXPECT_EQ(result.cost.control_points, 162);
    EXPECT_TRUE(result.cost.converged);
  }
}

TEST_F(BoundaryFile, OfASpectrumAddsUpTheCost) {
  std::vector<Solution> both{sample::solution(3, 2, 4), sample::solution(3, 2, 4)};
  both[1].upwelling_flux.back() = 7;
  both[1].ledger.reflectance = 0.25;
  both[1].report.peak_memory_bytes = 7'000'000'000;
  both[1].report.converged = false;
  ResultInfo info = sample::info();
  info.wavelengths_um = {0.5, 0.6};
  write_result(file_, both, info);
  const BoundaryResult result = read_boundary_result(file_);
  ASSERT_EQ(result.fluxes.size(), 2U);
  EXPECT_THAT(result.wavelengths_um, ElementsAre(0.5, 0.6));
  EXPECT_EQ(result.fluxes[0].up_at_top.back(), sample::field_value(1, 4, 1, 2));
  EXPECT_EQ(result.fluxes[1].up_at_top.back(), 7);
  EXPECT_EQ(result.fluxes[1].reflectance, 0.25);
  EXPECT_EQ(result.cost.cpu_seconds, 48);
  EXPECT_EQ(result.cost.peak_memory_bytes, 7e9);
  EXPECT_FALSE(result.cost.converged);
}

TEST_F(BoundaryFile, MustReachFromBottomToTop) {
  for (const std::vector<int>& levels : {std::vector<int>{0, 2}, std::vector<int>{1, 4}}) {
    write_result(file_, sample::solution(3, 2, 4, levels), sample::info());
    EXPECT_THAT([&] { read_boundary_result(file_); }, ThrowsMessage<InputError>(HasSubstr("output.flux_levels")));
  }
  std::ofstream(file_) << "no HDF5";
  EXPECT_THROW(read_boundary_result(file_), InputError);
  std::filesystem::remove(file_);
  EXPECT_THAT([&] { read_boundary_result(file_); }, ThrowsMessage<InputError>(HasSubstr("no such file")));
}

TradeoffReport report() {
  TradeoffReport report{"Step cloud", "reference", {}, {"huge                left out"}};
  report.rows.push_back(
      {"draft", {.cpu_seconds = 1, .peak_memory_bytes = 5e7, .converged = true}, FluxErrors{4, 8, 2}});
  report.rows.push_back({"balanced", {.cpu_seconds = 2, .converged = false}, FluxErrors{1, 9, 1}});
  report.rows.push_back({"reference", {.cpu_seconds = 40, .converged = true}, std::nullopt});
  return report;
}

TEST(TradeoffReport, TableMarksFrontTruthAndWhatDidNotConverge) {
  const std::string table = tradeoff_table(report());
  EXPECT_THAT(table, testing::ContainsRegex("draft +1.00 .* 50 .* 4.000\\* +8.000\\* +2.000\\*\n"));
  EXPECT_THAT(table, testing::ContainsRegex("balanced .* 1.000\\* +9.000  +1.000\\*  NOT CONVERGED\n"));
  EXPECT_THAT(table, testing::ContainsRegex("reference .* truth\n"));
  EXPECT_THAT(table, HasSubstr("\nhuge                left out\n"));
}

TEST(TradeoffReport, CsvHasALineForEachLevel) {
  const auto file = temporary("table.csv");
  write_tradeoff_csv(file, report());
  const std::string text = read_text(file);
  EXPECT_THAT(text, testing::StartsWith("level,control_points,"));
  EXPECT_THAT(text, HasSubstr(",50000000,4,8,2,1,1,1\nbalanced,"));
  EXPECT_THAT(text, HasSubstr(",1,9,1,1,0,1\nreference,"));
  EXPECT_THAT(text, testing::EndsWith(",40,0,0,0,,,,,,\n"));
  EXPECT_THAT(text, Not(HasSubstr("nan")));
  std::filesystem::remove(file);
}

TEST(TradeoffReport, PlotIsAPngEvenOfATruthAlone) {
  const auto file = temporary("plot.png");
  TradeoffReport alone = report();
  alone.rows.erase(alone.rows.begin(), alone.rows.begin() + 2);
  for (const TradeoffReport& drawn : {report(), alone}) {
    write_tradeoff_plot(file, drawn);
    EXPECT_THAT(read_text(file), testing::StartsWith("\x89PNG"));
    std::filesystem::remove(file);
  }
}

}  // namespace
}  // namespace cloudbow

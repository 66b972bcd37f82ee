// Reports of a trade-off. Truth: the numbers of the levels.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "../io/sample_solution.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/io/boundary_result.hpp"
#include "cloudbow/plots/tradeoff_report.hpp"
#include "cloudbow/results/tradeoff.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;
using testing::Not;

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::temp_directory_path() / ("cloudbow-tradeoff-" + std::to_string(getpid()) + "-" + name);
}

std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
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

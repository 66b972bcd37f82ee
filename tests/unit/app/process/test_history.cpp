// The line of history. Truth: the format of ISO 8601, and the clock.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ctime>

#include "app/process/history.hpp"

namespace cloudbow {
namespace {

TEST(History, IsTheTimeInUtcAndTheCommand) {
  const std::string line = history_line("cloudbow run a.toml");
  EXPECT_THAT(line,
              testing::MatchesRegex("[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}Z cloudbow run a.toml"));
  std::tm utc{};
  ASSERT_NE(strptime(line.c_str(), "%Y-%m-%dT%H:%M:%SZ", &utc), nullptr);
  EXPECT_LE(std::abs(std::difftime(timegm(&utc), std::time(nullptr))), 60) << "not in local time";
}

}  // namespace
}  // namespace cloudbow

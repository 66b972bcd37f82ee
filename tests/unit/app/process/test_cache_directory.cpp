// The folder of caches. Truth: the XDG Base Directory Specification.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>

#include "app/process/cache_directory.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

TEST(CacheDirectory, IsThatOfTheEnvironmentAndIsMade) {
  const TemporaryFolder folder;
  const std::filesystem::path cache = folder / "cache", home = folder / "home";
  setenv("XDG_CACHE_HOME", cache.c_str(), 1);
  setenv("HOME", home.c_str(), 1);
  EXPECT_EQ(cache_directory(), cache / "cloudbow");
  EXPECT_TRUE(std::filesystem::is_directory(cache / "cloudbow"));
  setenv("XDG_CACHE_HOME", "relative", 1);  // must be ignored
  EXPECT_EQ(cache_directory(), home / ".cache" / "cloudbow");
  unsetenv("XDG_CACHE_HOME");
  EXPECT_EQ(cache_directory(), home / ".cache" / "cloudbow");
  unsetenv("HOME");
  EXPECT_EQ(cache_directory(), std::filesystem::path());
}

TEST(CacheDirectory, IsNoneIfItCannotBeMade) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("file", "no folder");
  setenv("XDG_CACHE_HOME", file.c_str(), 1);
  EXPECT_EQ(cache_directory(), std::filesystem::path());
  unsetenv("XDG_CACHE_HOME");
}

}  // namespace
}  // namespace cloudbow

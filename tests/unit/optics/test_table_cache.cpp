// Tables on disk. Truth: the bits of a table that is made without a cache; which files a bound leaves follows from
// their sizes and times.
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "cloudbow/core/digest.hpp"
#include "cloudbow/optics/scattering_table.hpp"
#include "optics/table_cache.hpp"

namespace cloudbow {
namespace {

class TableCacheTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "cloudbow-cache-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    directory = pattern;
  }
  void TearDown() override { std::filesystem::remove_all(directory); }

  ScatteringTable make(double g = 0.5, const std::filesystem::path& in = {}) const {
    FitOptions o;
    o.delta_m_order = 6;
    o.beam_delta_m_order = 8;
    o.exact_moments = o.beam_half_range_rows = 2;
    o.minimax = true;
    o.cache_directory = in.empty() ? directory : in;
    return make_scattering_table(PhaseFunction::henyey_greenstein(g), ControlPoints(42),
                                 make_ordinate_set("double-gauss-6x8"), Direction(0.8, 0, -0.6), o);
  }
  static void expect_equal(const ScatteringTable& a, const ScatteringTable& b) {
    EXPECT_EQ(a.points_from_ordinates, b.points_from_ordinates);
    EXPECT_EQ(a.ordinates_from_ordinates, b.ordinates_from_ordinates);
    EXPECT_EQ(a.points_from_beam, b.points_from_beam);
    EXPECT_EQ(a.report.linear_programmes, b.report.linear_programmes);
    EXPECT_EQ(a.report.max_error, b.report.max_error);
  }
  std::filesystem::path directory;
};

TEST_F(TableCacheTest, GivesBackTheSameBits) {
  const ScatteringTable fresh = make(), cached = make();
  EXPECT_FALSE(fresh.report.from_cache);
  EXPECT_TRUE(cached.report.from_cache);
  expect_equal(fresh, cached);
}

TEST_F(TableCacheTest, IsKeyedByItsInputs) {
  make(0.5);
  EXPECT_FALSE(make(0.6).report.from_cache);
  EXPECT_TRUE(make(0.6).report.from_cache);
}

TEST_F(TableCacheTest, RemakesDamagedFiles) {
  const ScatteringTable fresh = make();
  const auto damage = [&](auto&& change) {
    for (const auto& entry : std::filesystem::directory_iterator(directory)) {
      std::ifstream in(entry.path(), std::ios::binary);
      std::string text{std::istreambuf_iterator<char>(in), {}};
      in.close();
      change(text);
      std::ofstream(entry.path(), std::ios::binary) << text;
    }
    const ScatteringTable remade = make();
    EXPECT_FALSE(remade.report.from_cache);
    expect_equal(fresh, remade);
    EXPECT_TRUE(make().report.from_cache);
  };
  damage([](std::string& text) { text.clear(); });
  damage([](std::string& text) { text.resize(text.size() / 2); });
  damage([](std::string& text) { text[text.size() / 2] ^= 1; });
  damage([](std::string& text) { text = "something else altogether"; });
  damage([](std::string& text) { text += "more"; });
}

TEST_F(TableCacheTest, RemakesTablesOfAnotherVersion) {
  const ScatteringTable fresh = make();
  const auto change_version = [&](char from, char to) {
    for (const auto& entry : std::filesystem::directory_iterator(directory)) {
      std::ifstream in(entry.path(), std::ios::binary);
      std::string text{std::istreambuf_iterator<char>(in), {}};
      in.close();
      const std::string begin = "cloudbow scattering table ";
      ASSERT_EQ(text.substr(0, begin.size() + 1), begin + from);
      text[begin.size()] = to;
      // The hash of all before it ends the file: only the version distinguishes this one from a current table.
      text.resize(text.size() - sizeof(std::uint64_t));
      Digest digest;
      digest.add_bytes(text.data(), text.size());
      const std::uint64_t hash = digest.value();
      text.append(reinterpret_cast<const char*>(&hash), sizeof hash);
      std::ofstream(entry.path(), std::ios::binary) << text;
    }
  };
  change_version('4', '3');
  const ScatteringTable remade = make();
  EXPECT_FALSE(remade.report.from_cache);
  expect_equal(fresh, remade);
  EXPECT_TRUE(make().report.from_cache);
}

TEST_F(TableCacheTest, LeavesNothingButFinishedFiles) {
  make();
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    EXPECT_EQ(entry.path().extension(), ".table");
    ++files;
  }
  EXPECT_EQ(files, 2);  // the diffuse columns and the beam's
}

TEST_F(TableCacheTest, DoesWithoutATableWhoseNameIsTaken) {
  const ScatteringTable fresh = make();
  const auto take_names = [&](auto&& take) {
    std::vector<std::filesystem::path> tables;
    for (const auto& entry : std::filesystem::directory_iterator(directory)) tables.push_back(entry.path());
    for (const auto& table : tables) {
      std::filesystem::remove_all(table);
      take(table);
    }
    const ScatteringTable remade = make();
    EXPECT_FALSE(remade.report.from_cache);
    expect_equal(fresh, remade);
  };
  take_names([](const std::filesystem::path& table) { std::filesystem::create_directory(table); });
  take_names([](const std::filesystem::path& table) { mkfifo(table.c_str(), 0600); });
  // A link may lead to a file of the user's, which stays as it is.
  const std::filesystem::path cloud = directory.string() + ".vdb";
  std::ofstream(cloud) << "a cloud";
  take_names([&](const std::filesystem::path& table) { std::filesystem::create_symlink(cloud, table); });
  std::ifstream in(cloud);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "a cloud");
  std::filesystem::remove(cloud);
}

TEST_F(TableCacheTest, DoesWithoutADirectoryThatCannotBe) {
  std::ofstream(directory / "file") << "not a directory";
  expect_equal(make(), make(0.5, directory / "file" / "below"));
}

/// A table or another file of that many bytes, last used that many hours ago.
void put_file(const std::filesystem::path& file, std::size_t bytes, int hours) {
  std::ofstream(file) << std::string(bytes, 'x');
  std::filesystem::last_write_time(file, std::filesystem::file_time_type::clock::now() - std::chrono::hours(hours));
}

std::set<std::string> names_in(const std::filesystem::path& directory) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) names.insert(entry.path().filename());
  return names;
}

TEST_F(TableCacheTest, ABoundRemovesTheTablesThatAreOutOfUse) {
  put_file(directory / "scattering-1.table", 400, 1);
  put_file(directory / "scattering-2.table", 400, 3);
  put_file(directory / "scattering-3.table", 400, 2);
  put_file(directory / "machine-speed.txt", 400, 9);
  put_file(directory / "scattering-notes.txt", 400, 9);
  const std::set<std::string> others{"machine-speed.txt", "scattering-notes.txt"};
  const auto with = [&others](std::set<std::string> names) {
    names.insert(others.begin(), others.end());
    return names;
  };
  bound_cache(directory, 1200);
  EXPECT_EQ(names_in(directory), with({"scattering-1.table", "scattering-2.table", "scattering-3.table"}));
  bound_cache(directory, 1199);
  EXPECT_EQ(names_in(directory), with({"scattering-1.table", "scattering-3.table"}));
  bound_cache(directory, 0);
  EXPECT_EQ(names_in(directory), others);
  bound_cache(directory / "no such folder", 0);
}

TEST_F(TableCacheTest, ATableThatIsReadCountsAsUsed) {
  make(0.5);
  const std::set<std::string> first = names_in(directory);
  for (const std::string& name : first)
    std::filesystem::last_write_time(directory / name,
                                     std::filesystem::file_time_type::clock::now() - std::chrono::hours(5));
  put_file(directory / "scattering-1.table", 10, 1);
  ASSERT_TRUE(make(0.5).report.from_cache);
  std::uintmax_t bytes = 0;
  for (const std::string& name : first) bytes += std::filesystem::file_size(directory / name);
  bound_cache(directory, bytes);
  EXPECT_EQ(names_in(directory), first);
}

}  // namespace
}  // namespace cloudbow

// Files of parts. Truth: the results that were written. Damage of every kind is in tests/robustness/ranks.py.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "app/process/version.hpp"
#include "app/runs/run_part.hpp"
#include "cloudbow/core/error.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

SolveResult numbered_result(std::size_t solve) {
  SolveResult result;
  result.solution.upwelling_flux = {static_cast<float>(solve)};
  return result;
}

PartHeader header_of(std::uint64_t key) {
  PartHeader header;
  header.key = key;
  return header;
}

std::filesystem::path written(const std::filesystem::path& output, const JobShare& share, PartHeader header) {
  header.parts = share.of;
  header.version = version();
  const std::filesystem::path file = part_file(output, share);
  PartWriter writer(file, share, header);
  for (std::size_t solve = 0; solve < 5; ++solve) {
    if (writer.has(solve)) writer.give(solve, numbered_result(solve));
  }
  EXPECT_FALSE(std::filesystem::exists(file)) << "before it is complete";
  writer.finish();
  return file;
}

std::string refusal(const std::vector<std::filesystem::path>& files) {
  try {
    const PartsReader reader(files);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(RunPart, SolvesOfAllPartsComeBack) {
  const TemporaryFolder folder;
  PartHeader header = header_of(5);
  header.overrides = {"a=1"};
  header.compare = true;
  const auto second = written(folder / "out.h5", {2, 2}, header), first = written(folder / "out.h5", {1, 2}, header);
  EXPECT_EQ(first.filename(), "out.h5.part-1-of-2");
  PartsReader reader({second, first});
  EXPECT_EQ(reader.header().overrides, header.overrides);
  EXPECT_TRUE(reader.header().compare);
  for (std::size_t solve = 0; solve < 5; ++solve)
    EXPECT_EQ(bytes_of(reader.take(solve)), bytes_of(numbered_result(solve)));
  EXPECT_THROW(reader.take(5), InputError);
}

TEST(RunPart, PartsOfTwoRunsAreNotJoined) {
  const TemporaryFolder folder;
  const auto first = written(folder / "a.h5", {1, 2}, header_of(5));
  EXPECT_THAT(refusal({first}), HasSubstr("part 2 of 2 is missing"));
  EXPECT_THAT(refusal({first, first}), HasSubstr("found it twice"));
  EXPECT_THAT(refusal({first, written(folder / "b.h5", {2, 2}, header_of(6))}), HasSubstr("other inputs or options"));
  EXPECT_THAT(refusal({first, written(folder / "c.h5", {2, 3}, header_of(5))}), HasSubstr("found 3 parts"));
}

TEST(RunPart, DamagedPartsAreRefused) {
  const TemporaryFolder folder;
  const auto longer = written(folder / "a.h5", {1, 1}, header_of(5));
  std::ofstream(longer, std::ios::binary | std::ios::app) << 'x';
  EXPECT_THAT(refusal({longer}), HasSubstr("it goes on after its end"));
  EXPECT_THAT(refusal({written(folder / "b.h5", {3, 2}, header_of(5))}), HasSubstr("its bytes are damaged"))
      << "part 3 of 2";
}

}  // namespace
}  // namespace cloudbow

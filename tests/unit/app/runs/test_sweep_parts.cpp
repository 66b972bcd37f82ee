// Truth: a key changes with all that a result depends on, and with nothing else; the folder as the file system has it.
#include <gtest/gtest.h>

#include <cstring>

#include "../temporary_folder.hpp"
#include "app/runs/sweep_parts.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

TEST(RunKeys, ChangeWithAllThatAResultDependsOn) {
  const TemporaryFolder folder;
  Scene scene;
  scene.path = folder.write("scene.toml", "title = \"a\"\n");
  scene.inputs = {scene.path, folder.write("table.txt", "1 2\n")};
  const std::uint64_t key = RunKeys().of(scene, "text", {});
  EXPECT_EQ(RunKeys().of(scene, "text", {}), key);
  EXPECT_NE(RunKeys().of(scene, "other text", {}), key);
  RunOptions compare;
  compare.compare = true;
  EXPECT_NE(RunKeys().of(scene, "text", compare), key);
  RunOptions threads;
  threads.threads = 3;
  threads.output = folder / "elsewhere.h5";
  EXPECT_EQ(RunKeys().of(scene, "text", threads), key);
  // Comments of the scene file are not part of its text.
  folder.write("scene.toml", "title = \"a\"  # a comment\n");
  EXPECT_EQ(RunKeys().of(scene, "text", {}), key);
  folder.write("table.txt", "1 3\n");
  EXPECT_NE(RunKeys().of(scene, "text", {}), key);
}

TEST(RunKeys, IgnoreTheRandomIdentifierOfOpenVdb) {
  const TemporaryFolder folder;
  std::string bytes(200, 'x');
  std::memcpy(bytes.data(), " BDV", 4);
  Scene scene;
  scene.path = folder.write("scene.toml", "");
  scene.inputs = {folder.write("cloud.vdb", bytes)};
  const std::uint64_t key = RunKeys().of(scene, "", {});
  bytes.replace(21, 36, 36, 'y');
  folder.write("cloud.vdb", bytes);
  EXPECT_EQ(RunKeys().of(scene, "", {}), key);
  bytes[57] = 'y';
  folder.write("cloud.vdb", bytes);
  EXPECT_NE(RunKeys().of(scene, "", {}), key);
}

TEST(SweepParts, AreRemovedAndNothingElse) {
  const TemporaryFolder folder;
  const SweepParts parts(folder / "out.h5");
  parts.make();
  EXPECT_EQ(parts.folder(), folder / "out.h5.parts");
  EXPECT_FALSE(parts.has(7));
  folder.write("out.h5.parts/run-0000000000000007.h5", "damaged");
  EXPECT_FALSE(parts.has(7));
  folder.write("out.h5.parts/run-00000000000000ff.h5", "of another scene");
  folder.write("out.h5.parts/.run-00000000000000ff.h5.host.12-1.tmp", "of a killed run");
  folder.write("out.h5.parts/notes.txt", "of the user");
  EXPECT_EQ(parts.remove(std::vector<std::uint64_t>{7}), 1u) << "the run of another sweep stays";
  EXPECT_TRUE(std::filesystem::exists(parts.file(255)));
  EXPECT_EQ(parts.remove(std::vector<std::uint64_t>{7, 255}), 0u);
  EXPECT_TRUE(std::filesystem::exists(folder / "out.h5.parts/notes.txt"));
  EXPECT_FALSE(std::filesystem::exists(parts.file(255)));
  EXPECT_FALSE(std::filesystem::exists(folder / "out.h5.parts/.run-00000000000000ff.h5.host.12-1.tmp"));
  std::filesystem::remove(folder / "out.h5.parts/notes.txt");
  EXPECT_EQ(parts.remove({}), 0u);
  EXPECT_FALSE(std::filesystem::exists(parts.folder()));
  EXPECT_NO_THROW(parts.check());
  folder.write("out.h5.parts", "a file");
  EXPECT_THROW(parts.check(), InputError);
  EXPECT_THROW(parts.make(), InputError);
  std::filesystem::remove(parts.folder());
  std::filesystem::create_symlink(parts.folder().filename(), parts.folder());
  EXPECT_THROW(parts.check(), InputError) << "a link to itself";
  EXPECT_THROW(parts.make(), InputError);
}

}  // namespace
}  // namespace cloudbow

// Truth: the file system, which identifies files by device and number.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/output_files.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class OutputFiles : public TemporaryFolder {
 protected:
  OutputFiles() {
    make("there");
    fs::create_directory(folder_ / "sub");
    fs::create_directory_symlink("sub", folder_ / "to_sub");
    fs::create_symlink("../there", folder_ / "sub" / "to_there");
    fs::create_symlink("sub/coming", folder_ / "to_coming");
    fs::create_hard_link(folder_ / "there", folder_ / "hard");
  }

  static std::string message_of(const std::vector<OutputFile>& outputs, const std::vector<fs::path>& inputs) {
    try {
      check_outputs(outputs, inputs);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(OutputFiles, OneFileIsSeenUnderAllItsNames) {
  const fs::path there = folder_ / "there", coming = folder_ / "sub" / "coming";
  for (const fs::path& other : {folder_ / "." / "there", folder_ / "sub" / ".." / "there", folder_ / "sub" / "to_there",
                                folder_ / "to_sub" / "to_there", folder_ / "hard", fs::relative(there)}) {
    EXPECT_TRUE(same_file(there, other)) << other;
  }
  for (const fs::path& other : {folder_ / "to_sub" / "coming", folder_ / "to_coming", folder_ / "sub" / "." / "coming",
                                folder_ / "sub" / "COMING", fs::relative(coming)}) {
    EXPECT_TRUE(same_file(coming, other)) << other;
  }
  EXPECT_FALSE(same_file(there, coming));
  EXPECT_FALSE(same_file(folder_ / "coming", coming));
  EXPECT_FALSE(same_file(folder_ / "coming", folder_ / "coming.1"));
}

TEST_F(OutputFiles, EachKindHasItsEndings) {
  const std::vector<std::pair<OutputKind, std::vector<std::string>>> own{
      {OutputKind::hdf5, {"a.h5", "a.HDF5", "a.nc", "a.nc4"}},
      {OutputKind::checkpoint, {"a.h5", "a.hdf5", "a.ck", "a.ckpt", "a.checkpoint"}},
      {OutputKind::vdb, {"a.vdb", "a.VDB"}},
      {OutputKind::csv, {"a.csv", "a.txt"}},
      {OutputKind::plot, {"a.png", "a.svg", "a.PDF"}},
      {OutputKind::picture, {"a.png", "a.svg", "a.pdf", "a.exr"}}};
  for (const auto& [kind, names] : own) {
    for (const std::string& name : names) EXPECT_NO_THROW(check_ending({name, "it", kind})) << name;
    for (const char* name : {"a", "depth_0.5", ".a", "a.", "x.png/a"})
      EXPECT_NO_THROW(check_ending({name, "it", kind})) << name;
    EXPECT_THROW(check_ending({"a.toml", "it", kind}), InputError);
    EXPECT_THROW(check_ending({"a.png.jpg", "it", kind}), InputError);
    EXPECT_THROW(check_ending({"a.h5x", "it", kind}), InputError);
    EXPECT_THROW(check_ending({kind == OutputKind::vdb ? "a.h5" : "a.vdb", "it", kind}), InputError);
  }
  EXPECT_NO_THROW(check_ending({"a.toml", "it"}));
  EXPECT_THAT(message_of({{folder_ / "a.png", "the result", OutputKind::hdf5}}, {}),
              AllOf(HasSubstr("a.png: the result"), HasSubstr("found .png, allowed .h5")));
}

TEST_F(OutputFiles, AnInputIsNotOverwritten) {
  EXPECT_THAT(message_of({{folder_ / "new", "the plot"}, {folder_ / "hard", "the table"}},
                         {folder_ / "none", folder_ / "there"}),
              AllOf(HasSubstr((folder_ / "hard").string()), HasSubstr("the table would overwrite an input"),
                    HasSubstr((folder_ / "there").string())));
}

TEST_F(OutputFiles, AnotherOutputIsNotOverwritten) {
  EXPECT_THAT(message_of({{folder_ / "to_coming", "the plot"}, {folder_ / "sub" / "coming", "the table"}}, {}),
              HasSubstr("the table would overwrite the plot"));
}

TEST_F(OutputFiles, TheRemainsOfAKilledRunAreNoInputOfTheNext) {
  EXPECT_THAT(message_of({{folder_ / "new", "the result"}}, {folder_ / ".new.01234567.1-0.tmp"}),
              HasSubstr("would overwrite an input"));
}

TEST_F(OutputFiles, OthersAreAccepted) {
  EXPECT_EQ(
      message_of(
          {{folder_ / "new", "the plot"}, {"", "the table"}, {"", "the file"}, {folder_ / "sub" / "new", "the text"}},
          {folder_ / "there", ""}),
      "");
  EXPECT_FALSE(fs::exists(folder_ / "new"));
}

TEST_F(OutputFiles, EachMustBeWritable) {
  EXPECT_THAT(message_of({{folder_ / "new", "the plot"}, {folder_ / "no" / "new", "the table"}}, {}),
              HasSubstr("there is no folder"));
}

}  // namespace
}  // namespace cloudbow

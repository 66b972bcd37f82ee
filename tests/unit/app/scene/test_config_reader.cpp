// Typed access to a table. Truth: the values of the text; messages name place, key, what was found and what is allowed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "app/scene/config_reader.hpp"
#include "cloudbow/core/error.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::ThrowsMessage;

class ConfigReaderTest : public testing::Test {
 protected:
  ConfigReaderTest()
      : tree_(read_config(folder_.write("a.toml",
                                        "half = 0.5\nwhole = 3\nyes = true\nword = \"red\"\n"
                                        "list = [1, 2.5, 4]\nwords = [\"a\", \"b\"]\n"
                                        "[sun]\nzenith_deg = 60\n[[layer]]\n[[layer]]\ntop_m = 2\n"),
                          {})),
        root_(tree_.root, "") {}

  /// Of an action that must be refused.
  static std::string message(const std::function<void()>& action) {
    try {
      action();
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  const TemporaryFolder folder_;
  const ConfigTree tree_;
  const ConfigReader root_;
};

TEST_F(ConfigReaderTest, ReadsValuesByTheirTypes) {
  EXPECT_EQ(root_.number("half", fraction), .5);
  EXPECT_EQ(root_.number("whole", finite), 3);
  EXPECT_EQ(root_.find_integer("whole", 0, 3), 3);
  EXPECT_TRUE(root_.flag("yes", false));
  EXPECT_TRUE(root_.flag("absent", true));
  EXPECT_EQ(root_.text("word"), "red");
  EXPECT_EQ(root_.find_choice("word", {"green", "red"}), "red");
  EXPECT_THAT(root_.find_numbers("list", positive).value(), ElementsAre(1, 2.5, 4));
  EXPECT_EQ(root_.find_triple("list", positive), (std::array<double, 3>{1, 2.5, 4}));
  EXPECT_THAT(root_.find_texts("words").value(), ElementsAre("a", "b"));
  EXPECT_EQ(root_.find_number("absent", finite), std::nullopt);
  EXPECT_EQ(root_.find_table("sun")->path(), "sun");
  ASSERT_EQ(root_.tables("layer").size(), 2U);
  EXPECT_EQ(root_.tables("layer")[1].full_name("top_m"), "layer.1.top_m");
  EXPECT_TRUE(root_.tables("absent").empty());
}

TEST_F(ConfigReaderTest, MessagesNamePlaceKeyFoundAndAllowed) {
  EXPECT_THAT(message([&] { root_.number("whole", fraction); }),
              AllOf(HasSubstr("a.toml:2: whole: "), EndsWith("(found 3, allowed 0 to 1)")));
  EXPECT_THAT(message([&] { root_.number("absent", positive); }),
              AllOf(HasSubstr("a.toml: absent: missing"), HasSubstr("allowed > 0")));
  EXPECT_THAT(message([&] { root_.number("word", finite); }), HasSubstr("found \"red\""));
  EXPECT_THAT(message([&] { root_.find_integer("half", 0, 9); }), HasSubstr("found 0.5"));
  EXPECT_THAT(message([&] { root_.text("half"); }), HasSubstr("found 0.5"));
  EXPECT_THAT(message([&] { root_.flag("whole", false); }), HasSubstr("found 3"));
  EXPECT_THAT(message([&] {
                root_.find_choice("word", {"green", "reed"});
              }),
              AllOf(HasSubstr("found \"red\""), HasSubstr("did you mean reed?")));
  EXPECT_THAT(message([&] { root_.find_table("half"); }), HasSubstr("found 0.5"));
  EXPECT_THAT(message([&] { root_.find_triple("words", finite); }), HasSubstr("words"));
  EXPECT_THAT(message([&] { root_.tables("layer")[1].number("top_m", fraction); }),
              HasSubstr("a.toml:11: layer.1.top_m: "));
}

TEST_F(ConfigReaderTest, RangesIncludeTheirEndsIfTheySaySo) {
  EXPECT_TRUE(fraction.contains(0) && fraction.contains(1));
  EXPECT_FALSE(fraction.contains(-1e-300) || fraction.contains(1 + 1e-15));
  EXPECT_FALSE(positive.contains(0));
  EXPECT_FALSE(finite.contains(INFINITY) || finite.contains(NAN));
  const NumberRange open{"between", 0, 1, false, false};
  EXPECT_FALSE(open.contains(0) || open.contains(1));
  EXPECT_TRUE(open.contains(.5));
}

TEST_F(ConfigReaderTest, UnknownKeysAreNamedWithTheNearest) {
  EXPECT_THAT(message([&] {
                root_.check_keys({"half", "whole", "yes", "wort", "list", "words", "sun", "layer"});
              }),
              AllOf(HasSubstr("a.toml:4: word: unknown key"), HasSubstr("did you mean wort?")));
  // A key without its table.
  const std::string path = (folder_ / "a.toml").string();
  const ConfigTree bare = read_config(path, std::vector<std::string>{"zenith_deg=30"});
  const std::vector<std::string> known{"half", "whole", "yes", "word", "list", "words", "sun", "layer"};
  EXPECT_THAT(message([&] { ConfigReader(bare.root, "").check_keys(known); }),
              HasSubstr("did you mean sun.zenith_deg?"));
  const ConfigTree of_list = read_config(path, std::vector<std::string>{"zenith=0,30", "many=2:8:2", "text=a,b"});
  const ConfigReader reader(of_list.root, "");
  EXPECT_THAT(message([&] { reader.number("zenith", finite); }), HasSubstr("; `cloudbow sweep` takes lists"));
  EXPECT_THAT(message([&] { reader.find_integer("many", 0, 9); }), HasSubstr("; `cloudbow sweep` takes lists"));
  EXPECT_THAT(message([&] { reader.number("text", finite); }), testing::Not(HasSubstr("sweep")));
  EXPECT_EQ(message([&] {
              root_.check_keys({"half", "whole", "yes", "word", "list", "words", "sun", "layer"});
            }),
            "no error");
}

TEST_F(ConfigReaderTest, ListsHaveAnEntryForEachWavelength) {
  EXPECT_EQ(root_.number("list", positive, {1, 3}), 2.5);
  EXPECT_EQ(root_.number("half", positive, {1, 3}), .5) << "one number serves all";
  EXPECT_THAT(message([&] { root_.number("list", positive, {1, 2}); }), HasSubstr("list"));
  EXPECT_THAT(message([&] { root_.number("list", positive, {0, 0}); }), HasSubstr("list"));
  EXPECT_THAT(root_.spectral_texts("words", {0, 2}), ElementsAre("a", "b"));
}

TEST_F(ConfigReaderTest, ErrorsOfPartsGetThePlaceOfTheirKey) {
  EXPECT_THAT(message([&] { root_.with_place("half", [] { throw InputError("too small"); }); }),
              AllOf(HasSubstr("a.toml:1"), HasSubstr("half"), EndsWith("too small")));
}

}  // namespace
}  // namespace cloudbow

// TOML as a tree. Truth: a file that is written anew reads back as the same values, to the bit.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "app/scene/config_tree.hpp"
#include "cloudbow/core/error.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
bool same(const ConfigNode::OtherScalar& a, const ConfigNode::OtherScalar& b) { return a.text == b.text; }
template <class Value>
bool same(const Value& a, const Value& b) {
  return a == b;
}

bool same_scalar(const ConfigNode::Scalar& a, const ConfigNode::Scalar& b) {
  return a.index() == b.index() &&
         std::visit([&b](const auto& value) { return same(value, std::get<std::decay_t<decltype(value)>>(b)); }, a);
}

/// Keys of a table may come in another order.
void expect_same(const ConfigNode& a, const ConfigNode& b, const std::string& name) {
  ASSERT_EQ(a.kind, b.kind) << name;
  ASSERT_EQ(a.items.size(), b.items.size()) << name;
  if (a.kind == ConfigNode::Kind::scalar) {
    EXPECT_TRUE(same_scalar(a.scalar, b.scalar)) << name << ": " << describe(a) << ", " << describe(b);
  } else if (a.kind == ConfigNode::Kind::array) {
    for (std::size_t n = 0; n < a.items.size(); ++n) expect_same(a.items[n], b.items[n], fmt::format("{}.{}", name, n));
  } else {
    for (std::size_t n = 0; n < a.items.size(); ++n) {
      const ConfigNode* other = b.find(a.keys[n]);
      ASSERT_NE(other, nullptr) << name << ": " << describe_key(a.keys[n]);
      expect_same(a.items[n], *other, name + "." + a.keys[n]);
    }
  }
}

/// Reads `text` with one key set, and reads what that wrote.
void expect_reads_back(const std::string& text) {
  const TemporaryFolder folder;
  const std::vector<std::string> set{"new.key=0.1"};
  const ConfigTree tree = read_config(folder.write("first.toml", text), set);
  SCOPED_TRACE(tree.text);
  const ConfigTree again = read_config(folder.write("again.toml", tree.text), {});
  expect_same(tree.root, again.root, "");
  EXPECT_EQ(std::get<double>(again.root.find("new")->find("key")->scalar), 0.1);
}

TEST(ConfigTree, WithoutOverridesTheTextIsThatOfTheFile) {
  const TemporaryFolder folder;
  const std::string text = "# note\nb = 1\n\n  a = 0x10 # odd\n";
  EXPECT_EQ(read_config(folder.write("a.toml", text), {}).text, text);
}

TEST(ConfigTree, OverridesGiveTomlForPeople) {
  const TemporaryFolder folder;
  const std::vector<std::string> set{"sun.zenith_deg=41.1", "title=a \"new\" title"};
  EXPECT_EQ(read_config(folder.write("a.toml",
                                     "[sun] # high\nzenith_deg = 3\nazimuth_deg = 0\n"
                                     "[[layer]]\noptical_depth = [1e-5, 0.1]\n[[layer]]\n"
                                     "optical_depth = 1361.0\n"),
                        set)
                .text,
            "title = \"a \\\"new\\\" title\"\n\n[sun]\nazimuth_deg = 0\nzenith_deg = 41.1\n\n"
            "[[layer]]\noptical_depth = [ 1e-05, 0.1 ]\n\n[[layer]]\noptical_depth = 1361.0\n");
}

TEST(ConfigTree, KeysOfOverridesHaveNoEmptyPart) {
  const TemporaryFolder folder;
  const auto file = folder.write("a.toml", "a = 1\n");
  for (const std::string assignment : {"b.=3", ".b=3", "b..c=3", "=3", ".=3", "b"})
    EXPECT_THROW(read_config(file, std::vector{assignment}), InputError) << assignment;
}

// As numbers of C and Python, which TOML has not.
TEST(ConfigTree, OverridesAreNumbersWithoutADigitBeforeOrBehindThePoint) {
  const TemporaryFolder folder;
  const auto file = folder.write("a.toml", "a = 1\n");
  const auto value_of = [&](const std::string& value) {
    const std::vector<std::string> set{"a=" + value};
    return *read_config(file, set).root.find("a");
  };
  const auto number = [&](const std::string& value) { return std::get<double>(value_of(value).scalar); };
  EXPECT_EQ(number(".7"), .7);
  EXPECT_EQ(number("-.7"), -.7);
  EXPECT_EQ(number("+.7e3"), 700.);
  EXPECT_EQ(number("5."), 5.);
  EXPECT_EQ(number("5.e-1"), .5);
  const ConfigNode list = value_of("[.1, 2., \"a .3\", 4]");
  ASSERT_EQ(list.items.size(), 4U);
  EXPECT_EQ(std::get<double>(list.items[0].scalar), .1);
  EXPECT_EQ(std::get<double>(list.items[1].scalar), 2.);
  EXPECT_EQ(std::get<std::string>(list.items[2].scalar), "a .3");
  for (const char* text : {".vdb", "../.5.vdb", "a.5", ".", "1.2.3", ".7 m", "..7"})
    EXPECT_EQ(std::get<std::string>(value_of(text).scalar), text);
}

TEST(ConfigTree, NumbersThatADoubleCannotHoldAreRefused) {
  const TemporaryFolder folder;
  for (const char* number : {"1e400", "-1e400", "1e-400"}) {
    const auto file = folder.write("a.toml", fmt::format("a = 1\nb = {}\n", number));
    try {
      read_config(file, {});
      ADD_FAILURE() << number;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("a.toml:2:"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("not representable in 64 bits"), std::string::npos) << error.what();
    }
  }
}

TEST(ConfigTree, TablesAndArraysReadBack) {
  expect_reads_back(
      "z = 1\na = [1, 2.0, \"x\", [true, []], {b = {c = 1}}]\nempty = []\ntables = [{}, {a = 1}]\n[none]\n"
      "[[layer]]\nbottom_m = 0\n[[layer]]\ntop_m = 1.5\n[layer.optics]\ng = 0.85\n[[layer.part]]\nn = 1\n"
      "[phase_function.a.b]\nc = -1\n[\"a key\".\"b.c\"]\n\"\" = 1\n\"\\\"quoted\\\"\" = 2\n'back\\slash' = "
      "3\n\"\\u00e9\" = 4\n"
      "\"#\" = 5\n");
}

TEST(ConfigTree, ScalarsReadBack) {
  expect_reads_back(
      "hex = 0xff\noct = 0o17\nbin = 0b101\nleast = -9223372036854775808\nlargest = 9223372036854775807\n"
      "yes = true\nno = false\nday = 2020-02-29\ntime = 07:32:00.25\nlocal = 1979-05-27T07:32:00\n"
      "offset = 1979-05-27T00:32:00.999999-07:00\nutc = 1979-05-27T07:32:00Z\n");
}

TEST(ConfigTree, TextsReadBack) {
  expect_reads_back(
      "plain = \"a b\"\nempty = \"\"\nquotes = 'say \"no\" twice'\nboth = \"'\\\"\"\nback = 'C:\\new\\table'\n"
      "lines = \"\"\"first\nsecond\n\n\"\"\"\ntab = \"a\\tb\"\ncontrols = \"\\u0000\\u0001\\u001f\\u007f\\b\\f\\r\"\n"
      "unicode = \"\xc3\xa9 \xe2\x82\xac \xf0\x9f\x8c\x88\"\nhash = \"# [no] = {comment}\"\nspaces = \"  \"\n");
}

TEST(ConfigTree, FloatsReadBackToTheBit) {
  using Limits = std::numeric_limits<double>;
  std::vector<double> numbers{0.1,
                              1. / 3,
                              1e5,
                              1e15,
                              1e16,
                              1e17,
                              123456789012345678.,
                              1e21,
                              1e22,
                              1e23,
                              5e-324,
                              0.,
                              -0.,
                              1.0,
                              -2.0,
                              0.00001,
                              1e300,
                              Limits::max(),
                              Limits::min(),
                              Limits::denorm_min(),
                              Limits::epsilon(),
                              0.1 + 0.2};
  std::mt19937_64 random(1);
  while (numbers.size() < 2000) {
    const double number = std::bit_cast<double>(random());
    if (std::isfinite(number)) numbers.push_back(number);
  }
  std::string text;
  for (std::size_t n = 0; n < numbers.size(); ++n) text += fmt::format("n{} = {:.17e}\n", n, numbers[n]);
  text += "infinite = inf\nminus = -inf\n";
  expect_reads_back(text);

  const TemporaryFolder folder;
  const std::vector<std::string> set{"b=1"};
  const ConfigTree tree = read_config(folder.write("first.toml", text), set);
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    const auto value = std::get<double>(tree.root.find(fmt::format("n{}", n))->scalar);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(value), std::bit_cast<std::uint64_t>(numbers[n])) << numbers[n];
  }
}

}  // namespace
}  // namespace cloudbow

// Texts that are nested too deeply. Truth: the grammar of TOML 1.0, and the stack of 8 MB that a parser without limits
// overflows.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloudbow/app/scene.hpp"
#include "cloudbow/core/error.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

const std::string slab_toml =
    "[[layer]]\nbottom_m = 0\ntop_m = 100\noptical_depth = 1\nsingle_scattering_albedo = 0.9\nphase_function = "
    "\"rayleigh\"\n[sun]\nzenith_deg = 60\nazimuth_deg = 0\n";

std::string repeated(const std::string& part, int times) {
  std::string text;
  for (int n = 0; n < times; ++n) text += part;
  return text;
}

// Each hides its levels in another way.
TEST(TomlDepth, DeepNestingIsRefused) {
  const int many = 20000;
  const std::string a = "a" + repeated(".a", many);
  const std::vector<std::pair<std::string, int>> texts{
      {a + " = 1", 1},
      {R"("#")" + repeated(".a", many) + " = 1", 1},
      {"'#'" + repeated(".'#'", many) + " = 1", 1},
      {R"("!")" + repeated(R"(."!")", many) + " = 1", 1},
      {R"("\"#")" + repeated(".a", many) + " = 1", 1},
      {repeated("a \t. ", many) + "a = 1", 1},
      {"\xef\xbb\xbf" + a + " = 1", 1},
      {"[" + a + "]", 1},
      {"[[\"]\"" + repeated(".\"]\"", many) + "]]", 1},
      {"x = {" + a + " = 1}", 1},
      {R"(x = {y = "#", "{")" + repeated(".a", many) + " = 1}", 1},
      {"x = [1, # ]\n {" + a + " = 1}]", 2},
      {"x = \"\"\"\n\\\"\"\"\" # \"\"\"\"\"\n" + a + " = 1", 3},
      {"x = '''\n'' # '''''\n" + a + " = 1", 3},
      {"x = '\\'\r\n" + a + " = 1", 2},
      {"x = \"\"\n" + a + " = 1", 2},
      {"x = " + repeated("{a.b = ", many), 1},
      {"x = " + repeated("[", many), 1},
      {"x = " + repeated("[{a = ", many), 1},
      // Levels of all kinds add up.
      {"[" + repeated("a.", 15) + "a]\n" + repeated("b.", 15) + "b = {c = 1}", 2},
      {repeated("b.", 15) + "b = {" + repeated("c.", 16) + "c = 1}", 1},
      {"x = " + repeated("[", 17) + "{" + repeated("c.", 15) + "c = 1}", 1}};
  const TemporaryFolder folder;
  const auto slab = folder.write("slab.toml", slab_toml);
  for (const auto& [text, line] : texts) {
    const auto file = folder.write("deep.toml", text);
    EXPECT_THAT([&] { read_scene(file); },
                ThrowsMessage<InputError>(HasSubstr(fmt::format("deep.toml:{}: nested too deeply", line))))
        << text.substr(0, 60);
    // Behind a value that is set it goes the same way to the parser.
    const std::vector<std::string> set{"x=1\n" + text};
    EXPECT_THAT([&] { read_scene(slab, set); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("--set"), HasSubstr("nested too deeply"))))
        << text.substr(0, 60);
  }
  const std::vector<std::string> key{a + "=1"};
  EXPECT_THAT([&] { read_scene(slab, key); }, ThrowsMessage<InputError>(HasSubstr("nested too deeply")));
}

TEST(TomlDepth, DotsAndBracketsInTextAreNoLevels) {
  const TemporaryFolder folder;
  const std::string marks = repeated(".[{", 100);
  for (const std::string& text :
       {"title = \"" + marks + "\"\n", "title = '" + marks + "'\n", "title = '''\n" + marks + "'''\n",
        "title = \"\"\"" + marks + "\\\"\"\"\"\n", "# " + marks + "\n", std::string("\xef\xbb\xbf# with a mark\r\n"),
        "[output]\nflux_levels = [" + repeated("50.0, ", 100) + "]\n",
        repeated("[[radiance]]\nzenith_deg = 0.5\n", 50)}) {
    const auto file = folder.write("scene.toml", text.find('[') == 0 ? slab_toml + text : text + slab_toml);
    try {
      read_scene(file);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), Not(HasSubstr("nested"))) << text;
    }
  }
}

}  // namespace
}  // namespace cloudbow

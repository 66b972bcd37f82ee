// Remedies for lines that are not TOML. Truth: the grammar of TOML 1.0.
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

// Typical mistakes of new users.
TEST(TomlHint, FaultsComeWithAWayOut) {
  const std::vector<std::pair<std::string, std::string>> lines{
      {"file = cloud.vdb", "text stands in quotes: file = \"cloud.vdb\""},
      {"file = ../clouds/cloud.vdb # mine", "text stands in quotes: file = \"../clouds/cloud.vdb\""},
      {"accuracy = fine", "text stands in quotes: accuracy = \"fine\""},
      {"fields = [\"fluxes\", actinic]", "text stands in quotes: \"actinic\""},
      {"fields = [\n  fluxes,\n]", "text stands in quotes: \"fluxes\""},
      {"file = \"cloud.vdb", "a string ends with the quote"},
      {"file = \"a, b.vdb", "a string ends with the quote"},
      {"file = \"C:\\Users\\cloud.vdb\"", "a backslash is an escape"},
      {"title = \xe2\x80\x9cslab\xe2\x80\x9d", "quotes of TOML are straight"},
      {"zenith_deg = 60 deg", "a number stands alone"},
      {"zenith_deg = 60\xc2\xb0", "a number stands alone"},
      {"zenith_deg = 60,5", "a number stands alone"},
      {"zenith_deg = .5", "digits on both sides"},
      {"zenith_deg = 5.", "digits on both sides"},
      {"wavelengths_um = 0.5 0.6", "[0.5, 0.6]"},
      {"error_estimate = True", "small letters: true"},
      {"zenith_deg =", "the value is missing"},
      {"zenith_deg: 60", "a line is KEY = VALUE"},
      {"zenith_deg = = 60", "a line is KEY = VALUE"},
      {"[sun", "in brackets: [sun]"},
      {"[&]", "in brackets: [sun]"},
      {"[[!a]]", "in brackets: [sun]"},
      {"a = 1\na = 2", "stands once"}};
  const TemporaryFolder folder;
  for (const auto& [text, way_out] : lines) {
    const auto file = folder.write("scene.toml", text + "\n");
    EXPECT_THAT([&] { read_scene(file); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("scene.toml:"), HasSubstr("not valid TOML"),
                                                HasSubstr(way_out), Not(HasSubstr("\n")))))
        << text;
  }
}

}  // namespace
}  // namespace cloudbow

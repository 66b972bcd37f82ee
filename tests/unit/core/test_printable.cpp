// Truth: the ranges of control characters in ASCII and Unicode, and the definition of UTF-8.
#include <gtest/gtest.h>

#include "cloudbow/core/printable.hpp"

namespace cloudbow {
namespace {

TEST(Printable, TextStaysAsItIs) {
  EXPECT_EQ(printable("grid \"density\" [g/m3]"), "grid \"density\" [g/m3]");
  EXPECT_EQ(printable("Wolke \u00fc \u4e91 \U0001F325"), "Wolke \u00fc \u4e91 \U0001F325");
  EXPECT_EQ(printable(""), "");
}

TEST(Printable, ControlCharactersAreEscaped) {
  EXPECT_EQ(printable("a\x1b[2Jb\n\r\t\x7f"), "a\\x1b[2Jb\\x0a\\x0d\\x09\\x7f");
  EXPECT_EQ(printable(std::string_view("\0x", 2)), "\\x00x");
  EXPECT_EQ(printable("\u009b31m"), "\\xc2\\x9b31m") << "C1's control sequence introducer";
  EXPECT_EQ(printable("\u00a0"), "\u00a0");
}

TEST(Printable, WhatIsNoUtf8IsEscaped) {
  EXPECT_EQ(printable("\x9b"
                      "31m"),
            "\\x9b31m");
  EXPECT_EQ(printable("\xff\xfe"), "\\xff\\xfe");
  EXPECT_EQ(printable("\xc0\x80"), "\\xc0\\x80") << "an overlong zero";
  EXPECT_EQ(printable("\xe4\xba"), "\\xe4\\xba") << "cut off";
  EXPECT_EQ(printable("\xe4z"), "\\xe4z");
}

}  // namespace
}  // namespace cloudbow

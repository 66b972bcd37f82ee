// Functions that subcommands share: checks of numbers, lists of words.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>

namespace cloudbow {

/// Checks on the text itself: conversions further on take "nan" for a number and wrap "-1" to a huge one. A
/// number so small that it has lost digits (1e-320) is a slip, and its inverse is infinite.
inline CLI::Validator finite_number(double low, const std::string& allowed) {
  return CLI::Validator(
      [low, allowed](std::string& text) {
        double value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        const bool good =
            error == std::errc() && end == text.data() + text.size() && std::isfinite(value) && value >= low;
        if (good && std::fpclassify(value) == FP_SUBNORMAL)
          return fmt::format("found {}, allowed {}, 0 or from 2.3e-308 on", text, allowed);
        return good ? std::string() : fmt::format("found {}, allowed {}", text, allowed);
      },
      "NUMBER");
}

inline CLI::Validator whole_number(std::uint64_t low, std::uint64_t high) {
  return CLI::Validator(
      [low, high](std::string& text) {
        std::uint64_t value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        const bool good = error == std::errc() && end == text.data() + text.size() && value >= low && value <= high;
        return good ? std::string() : fmt::format("found {}, allowed a whole number from {} to {}", text, low, high);
      },
      "N");
}

template <class Container>
std::string joined(const Container& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace cloudbow

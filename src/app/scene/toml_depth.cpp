#include "app/scene/toml_depth.hpp"

#include <algorithm>
#include <vector>

namespace cloudbow {
namespace {

/// End of the string that begins with the quote at `begin`. Without closing quote it extends to the end of its line, if
/// multi-line to the end of the text.
std::size_t after_string(std::string_view text, std::size_t begin) {
  const char quote = text[begin];
  const auto quotes_at = [&](std::size_t at, std::size_t most) {
    std::size_t count = 0;
    while (count < most && at + count < text.size() && text[at + count] == quote) ++count;
    return count;
  };
  const bool many_lines = quotes_at(begin, 3) == 3;
  std::size_t at = begin + (many_lines ? 3 : 1);
  while (at < text.size()) {
    if (text[at] == '\\' && quote == '"') {
      at += 2;
    } else if (text[at] == quote) {
      // Three quotes end a string of many lines; one or two before them are part of it.
      const std::size_t quotes = many_lines ? quotes_at(at, 5) : 1;
      at += quotes;
      if (!many_lines || quotes >= 3) return at;
    } else if (text[at] == '\n' && !many_lines) {
      return at;
    } else {
      ++at;
    }
  }
  return text.size();
}

/// Counts levels token by token.
class DepthCounter {
 public:
  bool too_deep() const { return above_ + parts_ > max_toml_depth; }

  /// A bare word or a string: part of a key, or a value.
  void word() {
    parts_ = after_dot_ ? parts_ + 1 : 1;
    after_dot_ = at_line_start_ = false;
  }

  void mark(char c) {
    if (c == '.') {
      after_dot_ = true;
      return;
    }
    after_dot_ = false;
    if (c == '[' && at_line_start_ && outer_.empty()) {
      in_header_ = true;
      above_ = parts_ = 0;
    } else if ((c == '[' || c == '{') && !in_header_) {
      outer_.push_back(above_);
      // A list or table in a list has no key of its own.
      above_ += std::max(parts_, 1);
      parts_ = 0;
    } else if ((c == ']' || c == '}') && !outer_.empty()) {
      above_ = outer_.back();
      outer_.pop_back();
      parts_ = 0;
    } else if (c == ',') {
      parts_ = 0;
    }
    at_line_start_ = false;
  }

  void line_end() {
    after_dot_ = false;
    if (!outer_.empty()) return;
    if (in_header_) above_ = parts_;
    in_header_ = false;
    parts_ = 0;
    at_line_start_ = true;
  }

 private:
  std::vector<int> outer_;  // of each open bracket: levels above its key
  int above_ = 0;           // levels above the key that is read
  int parts_ = 0;           // of that key
  bool after_dot_ = false;
  bool at_line_start_ = true;
  bool in_header_ = false;
};

}  // namespace

std::optional<int> first_line_too_deep(std::string_view text) {
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf", marks = ".,=[]{}", blanks = " \t\r";
  constexpr std::string_view ends_of_words = ".,=[]{} \t\r\n#\"'";
  DepthCounter depth;
  int line = 1;
  std::size_t at = text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0;
  while (at < text.size()) {
    const char c = text[at];
    std::size_t end = at + 1;
    if (c == '\n') {
      depth.line_end();
    } else if (c == '#') {
      end = std::min(text.find('\n', at), text.size());
    } else if (c == '"' || c == '\'') {
      end = std::min(after_string(text, at), text.size());
      depth.word();
    } else if (marks.find(c) != std::string_view::npos) {
      depth.mark(c);
    } else if (blanks.find(c) == std::string_view::npos) {
      end = std::min(text.find_first_of(ends_of_words, at), text.size());
      depth.word();
    }
    if (depth.too_deep()) return line;
    line += static_cast<int>(std::count(text.begin() + static_cast<std::ptrdiff_t>(at),
                                        text.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
    at = end;
  }
  return std::nullopt;
}

}  // namespace cloudbow

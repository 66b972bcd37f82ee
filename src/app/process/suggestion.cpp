#include "app/process/suggestion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

namespace cloudbow {
namespace {

/// Levenshtein's distance: single letters inserted, removed or changed.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, changed});
    }
  }
  return row.back();
}

}  // namespace

std::string candidates_for(std::string_view word, const std::vector<std::string>& candidates) {
  std::string suggestion;
  std::size_t nearest = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    // A word cut short is one slip.
    const std::size_t distance =
        word.size() > 2 && candidate.starts_with(word) ? std::size_t{1} : edit_distance(word, candidate);
    if (distance < nearest) {
      nearest = distance;
      suggestion = fmt::format("; did you mean {}?", candidate);
    }
  }
  return fmt::format("{}{}", fmt::join(candidates, ", "), suggestion);
}

}  // namespace cloudbow

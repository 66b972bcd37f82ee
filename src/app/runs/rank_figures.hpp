// Cost of a run by each of the processes that shared it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cloudbow/core/ranks.hpp"

namespace cloudbow {

struct RankFigures {
  std::uint64_t bytes_sent = 0;         ///< to other ranks
  std::uint64_t peak_memory_bytes = 0;  ///< resident
};

/// Figures of all ranks at the first, none at the others. Collective.
std::vector<RankFigures> rank_figures(Ranks& ranks);

/// A line for the summary, which ends with a newline.
std::string rank_figures_line(const std::vector<RankFigures>& figures);

}  // namespace cloudbow

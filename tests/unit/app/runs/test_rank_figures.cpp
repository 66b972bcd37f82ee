// Truth: the bytes that were sent.
#include <gtest/gtest.h>

#include "../../thread_ranks.hpp"
#include "app/runs/rank_figures.hpp"

namespace cloudbow {
namespace {

TEST(RankFigures, AreThoseOfEveryRankAtTheFirst) {
  ThreadRanks::run(3, [](Ranks& ranks) {
    const std::vector<std::byte> bytes(100);
    if (ranks.rank() == 2) send_bytes(ranks, 1, bytes);
    if (ranks.rank() == 1) receive_bytes(ranks, 2);
    const std::vector<RankFigures> figures = rank_figures(ranks);
    ASSERT_EQ(figures.size(), ranks.is_first() ? 3U : 0U);
    if (!ranks.is_first()) return;
    EXPECT_EQ(figures[1].bytes_sent, 0U);
    EXPECT_EQ(figures[2].bytes_sent, 108U) << "with their number";
    EXPECT_GT(figures[2].peak_memory_bytes, 0U);
  });
  EXPECT_EQ(rank_figures_line({{1'000'000, 20'000'000}, {2'500, 30'000'000}}),
            "processes            2: sent 1.000, 0.003 MB, memory 20, 30 MB\n");
}

}  // namespace
}  // namespace cloudbow

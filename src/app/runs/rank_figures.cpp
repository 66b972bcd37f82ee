#include "app/runs/rank_figures.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/resource.h>

#include <array>

namespace cloudbow {
namespace {

RankFigures own_figures(const Ranks& ranks) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return {ranks.bytes_sent(), static_cast<std::uint64_t>(usage.ru_maxrss) * 1024};
}

}  // namespace

std::vector<RankFigures> rank_figures(Ranks& ranks) {
  const RankFigures own = own_figures(ranks);
  std::vector<std::array<std::uint64_t, 2>> numbers(static_cast<std::size_t>(ranks.size()));
  numbers[static_cast<std::size_t>(ranks.rank())] = {own.bytes_sent, own.peak_memory_bytes};
  std::vector<Ranks::Outgoing> outgoing;
  std::vector<Ranks::Incoming> incoming;
  if (!ranks.is_first())
    outgoing.push_back({0, std::as_bytes(std::span(numbers[static_cast<std::size_t>(ranks.rank())]))});
  for (int rank = 1; ranks.is_first() && rank < ranks.size(); ++rank)
    incoming.push_back({rank, std::as_writable_bytes(std::span(numbers[static_cast<std::size_t>(rank)]))});
  ranks.exchange(outgoing, incoming);
  std::vector<RankFigures> figures;
  for (const auto& [sent, memory] : numbers) {
    if (ranks.is_first()) figures.push_back({sent, memory});
  }
  return figures;
}

std::string rank_figures_line(const std::vector<RankFigures>& figures) {
  constexpr double megabyte = 1e6;
  std::vector<std::string> sent, memory;
  for (const RankFigures& of : figures) {
    sent.push_back(fmt::format("{:.3f}", static_cast<double>(of.bytes_sent) / megabyte));
    memory.push_back(fmt::format("{:.0f}", static_cast<double>(of.peak_memory_bytes) / megabyte));
  }
  return fmt::format("{:<21}{}: sent {} MB, memory {} MB\n", "processes", figures.size(), fmt::join(sent, ", "),
                     fmt::join(memory, ", "));
}

}  // namespace cloudbow

#include "app/planning/solve_share.hpp"

#include <exception>
#include <stdexcept>

#include "app/process/interrupt.hpp"
#include "app/process/rank_messages.hpp"
#include "cloudbow/io/solution_bytes.hpp"

namespace cloudbow {

template <class Archive>
void visit_members(Archive& archive, PhaseClassReport& report) {
  auto& [functions, classes, estimated_error] = report;
  archive(functions, classes, estimated_error);
}

template <class Archive>
void visit_members(Archive& archive, ColumnFigures& figures) {
  auto& [sum, largest] = figures;
  archive(sum, largest);
}

template <class Archive>
void visit_members(Archive& archive, CloudFigures& figures) {
  auto& [name, optical_depth, optical_depth_um, water_path, largest_content, radius, temperature] = figures;
  archive(name, optical_depth, optical_depth_um, water_path, largest_content, radius, temperature);
}

template <class Archive>
void visit_members(Archive& archive, SolveResult& result) {
  auto& [solution, independent_columns, phase_classes, clouds, error, cloud_optical_depth, cloud_extinction] = result;
  archive(solution, independent_columns, phase_classes, clouds, error, cloud_optical_depth, cloud_extinction);
}

std::vector<std::byte> bytes_of(const SolveResult& result) {
  ByteWriter writer;
  writer(result);
  return writer.take();
}

SolveResult solve_result(std::span<const std::byte> bytes) {
  SolveResult result;
  ByteReader reader(bytes);
  reader(result);
  return result;
}

void SharedByRanks::give(std::size_t, const SolveResult& result) { send_result(ranks_, bytes_of(result)); }

SolveResult SharedByRanks::take(std::size_t solve) { return solve_result(receive_result(ranks_, owner(solve))); }

void SharedByRanks::fail(std::size_t) { send_error(ranks_); }

SolveResult SolvedTogether::take(std::size_t) { throw std::logic_error("every solve is made here too"); }

std::optional<SolveResult> shared_solve(SolveShare* share, std::size_t solve,
                                        const std::function<SolveResult()>& make) {
  if (share == nullptr) return make();
  if (!share->has(solve)) return share->collects() ? std::optional(share->take(solve)) : std::nullopt;
  if (share->collects()) return make();
  try {
    share->give(solve, make());
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception&) {
    share->fail(solve);
  }
  return std::nullopt;
}

}  // namespace cloudbow

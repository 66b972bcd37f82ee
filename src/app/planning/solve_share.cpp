#include "app/planning/solve_share.hpp"

#include <cstdint>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "app/process/exit_codes.hpp"
#include "app/process/interrupt.hpp"
#include "cloudbow/core/error.hpp"
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
  auto& [solution, independent_columns, phase_classes, clouds, error, cloud_optical_depth] = result;
  archive(solution, independent_columns, phase_classes, clouds, error, cloud_optical_depth);
}

namespace {

/// The end of a solve at another rank.
struct RemoteEnd {
  int exit_code = exit_done;
  std::string message{};
};

template <class Archive>
void visit_members(Archive& archive, RemoteEnd& end) {
  archive(end.exit_code, end.message);
}

RemoteEnd end_of_current_exception() {
  try {
    throw;
  } catch (const InputError& error) {
    return {exit_input_error, error.what()};
  } catch (const std::bad_alloc&) {
    return {exit_input_error, "out of memory (a smaller domain, a lower solver.accuracy or fewer --threads need less)"};
  } catch (const std::exception& error) {
    return {exit_internal_error, error.what()};
  }
}

}  // namespace

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

void SharedByRanks::give(std::size_t, const SolveResult& result) {
  ByteWriter writer;
  writer(RemoteEnd{}, result);
  send_bytes(ranks_, 0, writer.take());
}

SolveResult SharedByRanks::take(std::size_t solve) {
  const std::vector<std::byte> bytes = receive_bytes(ranks_, owner(solve));
  ByteReader reader(bytes);
  RemoteEnd end;
  reader(end);
  if (end.exit_code == exit_input_error) throw InputError(end.message);
  if (end.exit_code != exit_done) throw std::runtime_error(end.message);
  SolveResult result;
  reader(result);
  return result;
}

void SharedByRanks::fail(std::size_t) {
  ByteWriter writer;
  writer(end_of_current_exception());
  send_bytes(ranks_, 0, writer.take());
}

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

// The independent solves of a run (wavelengths, g-points), shared out over processes or over jobs of a batch system.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "app/planning/solve_scenes.hpp"
#include "cloudbow/core/ranks.hpp"

namespace cloudbow {

/// The outcome of one solve of a run.
struct SolveResult {
  Solution solution;
  std::optional<Solution> independent_columns{};
  std::optional<PhaseClassReport> phase_classes{};
  std::vector<CloudFigures> clouds{};
  std::optional<ErrorEstimate> error{};
  std::vector<float> cloud_optical_depth{};
  std::vector<float> cloud_extinction{};
};

std::vector<std::byte> bytes_of(const SolveResult& result);
/// @throws InputError if the bytes end too early.
SolveResult solve_result(std::span<const std::byte> bytes);

/// The solves that this process makes, and the source of the others. They are given and taken in ascending order.
class SolveShare {
 public:
  virtual ~SolveShare() = default;
  /// Whether the solve is made here.
  virtual bool has(std::size_t solve) const = 0;
  /// Whether this process collects the results of all solves and goes on with the run.
  virtual bool collects() const = 0;
  /// Hands on the result of a solve made here. Not called if this process collects.
  virtual void give(std::size_t solve, const SolveResult& result) = 0;
  /// The result of a solve made elsewhere. @throws InputError, std::runtime_error as the solve did there.
  virtual SolveResult take(std::size_t solve) = 0;
  /// Called in the handler of a solve that failed here. Rethrows, or sends the error to the process that collects,
  /// which then ends the run.
  virtual void fail(std::size_t solve) = 0;
  /// Ranks that make each solve together; null: one process does.
  virtual Ranks* together() const { return nullptr; }
};

/// Every size()th solve is made by the same rank; rank 0 collects.
class SharedByRanks : public SolveShare {
 public:
  explicit SharedByRanks(Ranks& ranks) : ranks_(ranks) {}
  bool has(std::size_t solve) const override { return owner(solve) == ranks_.rank(); }
  bool collects() const override { return ranks_.is_first(); }
  void give(std::size_t solve, const SolveResult& result) override;
  SolveResult take(std::size_t solve) override;
  void fail(std::size_t solve) override;

 private:
  int owner(std::size_t solve) const { return static_cast<int>(solve % static_cast<std::size_t>(ranks_.size())); }

  Ranks& ranks_;
};

/// All ranks make every solve together; rank 0 has its result.
class SolvedTogether : public SolveShare {
 public:
  explicit SolvedTogether(Ranks& ranks) : ranks_(ranks) {}
  bool has(std::size_t) const override { return true; }
  bool collects() const override { return ranks_.is_first(); }
  void give(std::size_t, const SolveResult&) override {}
  SolveResult take(std::size_t solve) override;
  void fail(std::size_t) override { throw; }
  Ranks* together() const override { return &ranks_; }

 private:
  Ranks& ranks_;
};

/// The result of a solve, made here or elsewhere; nothing if another process collects.
/// @param share null: all solves are made here
std::optional<SolveResult> shared_solve(SolveShare* share, std::size_t solve, const std::function<SolveResult()>& make);

/// Whether this process goes on with the results of all solves. @param share null: it does
inline bool collects(const SolveShare* share) { return share == nullptr || share->collects(); }

}  // namespace cloudbow

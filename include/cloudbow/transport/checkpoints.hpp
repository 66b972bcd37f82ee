// The state of an iteration outside of its process, so that another one can go on from there. Implementations decide on
// the storage.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace cloudbow {

/// One array of a state: rows of equal length.
struct StateArray {
  std::string name;
  std::size_t value_bytes;  ///< 2 (half precision, as it is), 4 (float) or 8 (double)
  std::size_t length;       ///< of each row
  std::vector<void*> rows;
};

/// Identifies the solve to which a state belongs.
struct StateKey {
  std::uint64_t layout = 0;   ///< cells, ordinates and precision: arrays of another layout mean something else
  std::uint64_t problem = 0;  ///< all that the iteration depends on

  bool operator==(const StateKey&) const = default;
};

class Checkpoints {
 public:
  virtual ~Checkpoints() = default;

  enum class Found { nothing, same_layout, same_problem };
  /// Whether there is a state to begin with. @throws InputError if it is of another layout.
  virtual Found find(const StateKey& key) = 0;
  /// Fills an array of the state that was found. @throws InputError if it is missing or has another shape.
  virtual void load(const StateArray& array) = 0;
  /// Refuses a loaded state that makes no sense. @throws InputError
  [[noreturn]] virtual void refuse(const std::string& problem) = 0;
  /// How the iteration begins: after that many sweeps of the same one, or (0) with the light of another.
  virtual void loaded(int sweeps) = 0;

  /// Asked between two sweeps: whether the state is to be saved now.
  virtual bool due() = 0;
  virtual void save(const StateKey& key, std::span<const StateArray> state) = 0;
};

}  // namespace cloudbow

// Processes that solve together: their numbers, and exchange of bytes between them. The implementation with MPI is the
// module cloudbow_mpi. It is loaded only if a launcher such as mpirun has started several processes.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace cloudbow {

/// Calls are collective unless stated otherwise, and come from one thread at a time.
class Ranks {
 public:
  struct Outgoing {
    int to;
    std::span<const std::byte> bytes;
  };
  struct Incoming {
    int from;
    std::span<std::byte> bytes;
  };

  virtual ~Ranks() = default;

  virtual int rank() const = 0;             ///< of this process, 0 to size() - 1
  virtual int size() const = 0;             ///< number of processes, >= 1
  virtual int on_this_machine() const = 0;  ///< how many of them share its memory, >= 1
  bool is_first() const { return rank() == 0; }

  /// Sends and receives, and returns when both are done. Only the ranks that are named take part. Pieces
  /// from one rank to another are received in the order in which they are sent, with their sizes. Pieces to itself are
  /// copied.
  virtual void exchange(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) = 0;
  /// Bytes that this rank has sent to others.
  virtual std::uint64_t bytes_sent() const = 0;
  /// The end of the work: waits until all ranks call this or their destructor, for no longer than `patience`. To be
  /// called once at most. @returns whether all did; if not, only abort() may follow.
  virtual bool all_arrive(std::chrono::milliseconds patience) = 0;
  /// Ends all processes at once, not collectively. @param exit_code 1 to 255
  [[noreturn]] virtual void abort(int exit_code) = 0;
  /// Called now and then while exchange() waits; may throw, after which only abort() may be called.
  std::function<void()> while_waiting;
};

/// Number of processes that a launcher has started together with this one, by its environment variables (Open MPI,
/// MPICH, PMIx); 1 without a launcher.
int launched_processes();

/// All launched processes; null if this is the only one. To be called once, before threads are started.
/// @throws InputError if there are several and this build has no MPI, or they were started for another MPI.
std::unique_ptr<Ranks> start_ranks();

/// Sends bytes of any number; the other rank receives them by receive_bytes.
void send_bytes(Ranks& ranks, int to, std::span<const std::byte> bytes);
std::vector<std::byte> receive_bytes(Ranks& ranks, int from);

/// Elements of which each rank holds the range [begin[r], begin[r + 1]) become known to all.
/// @param begin size() + 1 bounds, ascending
template <class Value>
void gather_ranges(Ranks& ranks, std::span<const std::size_t> begin, Value* values) {
  static_assert(std::is_trivially_copyable_v<Value>);
  std::vector<Ranks::Outgoing> outgoing;
  std::vector<Ranks::Incoming> incoming;
  const auto range = [&](int r) { return std::span(values + begin[r], begin[r + 1] - begin[r]); };
  for (int r = 0; r < ranks.size(); ++r) {
    if (r == ranks.rank()) continue;
    outgoing.push_back({r, std::as_bytes(range(ranks.rank()))});
    incoming.push_back({r, std::as_writable_bytes(range(r))});
  }
  ranks.exchange(outgoing, incoming);
}

}  // namespace cloudbow

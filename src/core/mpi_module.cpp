// The only source that includes MPI.
#include "core/mpi_module.hpp"

#include <mpi.h>

#include <algorithm>
#include <cstring>
#include <thread>

namespace cloudbow {
namespace {

constexpr std::size_t most_bytes_at_once = std::size_t{1} << 30;  // counts of MPI are int

/// Waits for `done`, after some looks with pauses: waiting ranks leave the processors to those that work.
template <class Done, class Pause>
void wait_until(const Done& done, const Pause& pause) {
  constexpr int eager_looks = 200;
  constexpr std::chrono::microseconds shortest{20}, longest{1000};
  std::chrono::microseconds nap = shortest;
  for (int looks = 0; !done(); ++looks) {
    if (looks < eager_looks) continue;
    pause();
    std::this_thread::sleep_for(nap);
    nap = std::min(2 * nap, longest);
  }
}

class MpiRanks : public Ranks {
 public:
  MpiRanks() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
    MPI_Comm_dup(MPI_COMM_WORLD, &arrivals_);
    MPI_Comm machine = MPI_COMM_NULL;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &machine);
    MPI_Comm_size(machine, &on_this_machine_);
    MPI_Comm_free(&machine);
  }
  ~MpiRanks() override {
    // Ranks that meet here have ended without an error, or have met after one.
    if (!arrived_) MpiRanks::all_arrive(std::chrono::hours(24 * 365));
    MPI_Comm_free(&arrivals_);
    MPI_Finalize();
  }
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  int on_this_machine() const override { return on_this_machine_; }
  std::uint64_t bytes_sent() const override { return bytes_sent_; }

  void exchange(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) override {
    copy_own(outgoing, incoming);
    std::vector<MPI_Request> requests;
    const auto by_part = [&](std::size_t bytes, const auto& start) {
      for (std::size_t first = 0; first < bytes; first += most_bytes_at_once)
        start(first, static_cast<int>(std::min(most_bytes_at_once, bytes - first)), &requests.emplace_back());
    };
    for (const Incoming& piece : incoming) {
      if (piece.from == rank_) continue;
      by_part(piece.bytes.size(), [&](std::size_t first, int count, MPI_Request* request) {
        MPI_Irecv(piece.bytes.data() + first, count, MPI_BYTE, piece.from, 0, MPI_COMM_WORLD, request);
      });
    }
    for (const Outgoing& piece : outgoing) {
      if (piece.to == rank_) continue;
      bytes_sent_ += piece.bytes.size();
      by_part(piece.bytes.size(), [&](std::size_t first, int count, MPI_Request* request) {
        MPI_Isend(piece.bytes.data() + first, count, MPI_BYTE, piece.to, 0, MPI_COMM_WORLD, request);
      });
    }
    wait_until(
        [&requests] {
          int done = 0;
          MPI_Testall(static_cast<int>(requests.size()), requests.data(), &done, MPI_STATUSES_IGNORE);
          return done != 0;
        },
        [this] {
          if (while_waiting) while_waiting();
        });
  }

  bool all_arrive(std::chrono::milliseconds patience) override {
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Ibarrier(arrivals_, &request);
    const auto start = std::chrono::steady_clock::now();
    wait_until(
        [&] {
          int done = 0;
          MPI_Test(&request, &done, MPI_STATUS_IGNORE);
          arrived_ = done != 0;
          return arrived_ || std::chrono::steady_clock::now() - start >= patience;
        },
        [] {});
    return arrived_;
  }

  [[noreturn]] void abort(int exit_code) override {
    MPI_Abort(MPI_COMM_WORLD, exit_code);
    std::abort();
  }

 private:
  void copy_own(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) const {
    auto to = incoming.begin();
    for (const Outgoing& piece : outgoing) {
      if (piece.to != rank_) continue;
      to = std::find_if(to, incoming.end(), [this](const Incoming& in) { return in.from == rank_; });
      if (!piece.bytes.empty()) std::memcpy(to->bytes.data(), piece.bytes.data(), piece.bytes.size());
      ++to;
    }
  }

  int rank_ = 0, size_ = 1, on_this_machine_ = 1;
  MPI_Comm arrivals_ = MPI_COMM_NULL;  ///< apart from exchanges that an error has cut short
  bool arrived_ = false;               ///< all have met, for the end
  std::uint64_t bytes_sent_ = 0;
};

std::unique_ptr<Ranks> start() { return std::make_unique<MpiRanks>(); }

}  // namespace
}  // namespace cloudbow

extern "C" const cloudbow::MpiModule cloudbow_mpi_module{&cloudbow::start};

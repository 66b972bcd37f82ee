// Ranks that are threads of one process, for tests without MPI.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "cloudbow/core/ranks.hpp"

namespace cloudbow {

class ThreadRanks : public Ranks {
 public:
  /// Calls `work` with each of `size` ranks at the same time. Rethrows what the first of them throws.
  static void run(int size, const std::function<void(Ranks&)>& work) {
    Mail mail;
    std::vector<std::thread> threads;
    std::vector<std::exception_ptr> errors(static_cast<std::size_t>(size));
    for (int rank = 0; rank < size; ++rank) {
      threads.emplace_back([&, rank] {
        ThreadRanks ranks(mail, rank, size);
        try {
          work(ranks);
        } catch (...) {
          errors[static_cast<std::size_t>(rank)] = std::current_exception();
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    for (const std::exception_ptr& error : errors) {
      if (error) std::rethrow_exception(error);
    }
  }

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  int on_this_machine() const override { return size_; }

  void exchange(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) override {
    for (const Outgoing& piece : outgoing) {
      if (piece.to != rank_) sent_ += piece.bytes.size();
      const std::lock_guard lock(mail_.mutex);
      mail_.pieces[{rank_, piece.to}].emplace_back(piece.bytes.begin(), piece.bytes.end());
      mail_.changed.notify_all();
    }
    for (const Incoming& piece : incoming) {
      std::unique_lock lock(mail_.mutex);
      auto& pieces = mail_.pieces[{piece.from, rank_}];
      mail_.changed.wait(lock, [&] { return !pieces.empty(); });
      if (pieces.front().size() != piece.bytes.size()) throw std::logic_error("a piece of another size");
      std::copy(pieces.front().begin(), pieces.front().end(), piece.bytes.begin());
      pieces.pop_front();
    }
  }
  std::uint64_t bytes_sent() const override { return sent_; }
  bool all_arrive(std::chrono::milliseconds) override { return true; }
  [[noreturn]] void abort(int exit_code) override { std::exit(exit_code); }

 private:
  struct Mail {
    std::mutex mutex;
    std::condition_variable changed;
    std::map<std::pair<int, int>, std::deque<std::vector<std::byte>>> pieces;  // by sender and receiver
  };
  ThreadRanks(Mail& mail, int rank, int size) : mail_(mail), rank_(rank), size_(size) {}

  Mail& mail_;
  int rank_, size_;
  std::uint64_t sent_ = 0;
};

}  // namespace cloudbow

// SIGINT and SIGTERM end a run between two sweeps, with nothing half done.
#pragma once

#include <array>
#include <csignal>

namespace cloudbow {

/// Thrown when a signal ends a run. The program exits with 128 + signal.
struct Interrupted {
  int signal;
};

/// While an object exists, the first SIGINT or SIGTERM is only noted; a second one ends the process at once. Within a
/// HostScope signals are the host's, and check() calls its function.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  /// Whether a signal has arrived.
  static bool noted();
  /// @throws Interrupted if one has.
  static void check();

 private:
  const bool of_host_;
  std::array<struct sigaction, 2> previous_{};
};

}  // namespace cloudbow

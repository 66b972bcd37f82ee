#include "app/process/interrupt.hpp"

#include "app/process/host.hpp"

namespace cloudbow {
namespace {

constexpr std::array<int, 2> signals{SIGINT, SIGTERM};
// A handler can reach nothing but this.
volatile std::sig_atomic_t noted_signal = 0;

void note_signal(int signal) { noted_signal = signal; }

}  // namespace

InterruptGuard::InterruptGuard() : of_host_(HostScope::calls() != nullptr) {
  if (of_host_) return;
  noted_signal = 0;
  struct sigaction action {};
  action.sa_handler = note_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigemptyset(&action.sa_mask);
  for (std::size_t n = 0; n < signals.size(); ++n) {
    sigaction(signals[n], &action, &previous_[n]);
    // A parent that made the signal ignored (nohup, background jobs) meant it.
    if (previous_[n].sa_handler == SIG_IGN) sigaction(signals[n], &previous_[n], nullptr);
  }
}

InterruptGuard::~InterruptGuard() {
  if (of_host_) return;
  for (std::size_t n = 0; n < signals.size(); ++n) sigaction(signals[n], &previous_[n], nullptr);
}

bool InterruptGuard::noted() { return HostScope::calls() == nullptr && noted_signal != 0; }

void InterruptGuard::check() {
  if (const HostCalls* host = HostScope::calls()) return host->check_interrupt();
  if (noted_signal != 0) throw Interrupted{noted_signal};
}

}  // namespace cloudbow

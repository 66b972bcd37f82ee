#include "app/process/interrupt.hpp"

namespace cloudbow {
namespace {

constexpr std::array<int, 2> signals{SIGINT, SIGTERM};
// A handler can reach nothing but this.
volatile std::sig_atomic_t noted_signal = 0;

void note_signal(int signal) { noted_signal = signal; }

}  // namespace

InterruptGuard::InterruptGuard() {
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
  for (std::size_t n = 0; n < signals.size(); ++n) sigaction(signals[n], &previous_[n], nullptr);
}

bool InterruptGuard::noted() { return noted_signal != 0; }

void InterruptGuard::check() {
  if (noted_signal != 0) throw Interrupted{noted_signal};
}

}  // namespace cloudbow

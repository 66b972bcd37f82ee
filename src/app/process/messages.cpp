#include "app/process/messages.hpp"

#include <cstdio>

#include "app/process/host.hpp"

namespace cloudbow {

namespace {

bool muted = false;

}  // namespace

void mute_messages(bool mute) { muted = mute; }

void tell_text(const std::string& text) {
  if (muted) return;
  if (const HostCalls* host = HostScope::calls()) {
    host->message(text);
  } else {
    std::fputs(text.c_str(), stderr);
  }
}

std::string percent(double fraction) { return fmt::format("{:.2g} %", 100 * fraction); }

}  // namespace cloudbow

#include "app/process/messages.hpp"

#include <cstdio>

#include "app/process/host.hpp"

namespace cloudbow {

void tell_text(const std::string& text) {
  if (const HostCalls* host = HostScope::calls()) {
    host->message(text);
  } else {
    std::fputs(text.c_str(), stderr);
  }
}

}  // namespace cloudbow

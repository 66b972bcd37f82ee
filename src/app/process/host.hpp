// A program that has loaded cloudbow as a library, such as Python, and the calls of one of its threads.
#pragma once

#include <functional>
#include <string>

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

struct HostCalls {
  std::function<void()> check_interrupt;                  ///< throws to end the work
  std::function<void(const std::string&)> message;        ///< in place of stderr; ends with a newline
  std::function<void(const SolverProgress&)> progress{};  ///< after each sweep and phase of a solve; may be empty
};

/// While an object exists, the work of its thread calls these functions. Signals and stderr are left to the host.
class HostScope {
 public:
  explicit HostScope(HostCalls calls);
  ~HostScope();
  HostScope(const HostScope&) = delete;
  HostScope& operator=(const HostScope&) = delete;

  /// Calls of this thread's host; null in the program itself.
  static const HostCalls* calls();

 private:
  const HostCalls calls_;
  const HostCalls* const outer_;  ///< of a call within a call
};

}  // namespace cloudbow

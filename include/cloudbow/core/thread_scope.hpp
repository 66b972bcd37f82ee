// How many threads OpenMP's regions have.
#pragma once

namespace cloudbow {

/// That many threads in this scope, or as many as can be started where memory or a limit keeps some from it. Afterwards
/// as before.
class ThreadScope {
 public:
  /// @param threads 0: as many as before.
  explicit ThreadScope(int threads);
  ~ThreadScope();
  ThreadScope(const ThreadScope&) = delete;
  ThreadScope& operator=(const ThreadScope&) = delete;

 private:
  int before_;
};

}  // namespace cloudbow

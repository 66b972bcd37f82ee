// Number of threads of OpenMP's regions.
#pragma once

namespace cloudbow {

/// Sets the number of threads in this scope, and restores the previous one afterwards. If memory or a limit prevents
/// some threads from starting, the number is that of those that can.
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

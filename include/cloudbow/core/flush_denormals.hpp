// Numbers below the normal range of float and double, as zero.
#pragma once

#include <vector>

namespace cloudbow {

/// In this scope, numbers below the normal range (float: 1.2e-38) are 0 in the calling thread and in those of OpenMP's
/// next regions. Processors take some hundred cycles for each, and strong absorption leaves such light in every cell.
/// The scope ends with as many threads as it began with, and restores what was. No effect on processors other than x86.
class FlushDenormals {
 public:
  FlushDenormals();
  ~FlushDenormals();
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  std::vector<unsigned> before_;  // [threads] control words
};

}  // namespace cloudbow

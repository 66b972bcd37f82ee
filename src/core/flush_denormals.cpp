#include "cloudbow/core/flush_denormals.hpp"

#include <omp.h>
#ifdef __SSE2__
#include <immintrin.h>
#endif

namespace cloudbow {
namespace {

#ifdef __SSE2__
unsigned control_word() { return _mm_getcsr(); }
void set_control_word(unsigned word) { _mm_setcsr(word); }
#else
unsigned control_word() { return 0; }
void set_control_word(unsigned) {}
#endif

constexpr unsigned results_and_operands = 0x8040;  // flush to zero, denormals are zero

}  // namespace

FlushDenormals::FlushDenormals() : before_(static_cast<std::size_t>(omp_get_max_threads())) {
  // Nothing throws here.
#pragma omp parallel
  {
    const auto thread = static_cast<std::size_t>(omp_get_thread_num());
    before_[thread] = control_word();
    set_control_word(before_[thread] | results_and_operands);
  }
}

FlushDenormals::~FlushDenormals() {
  // Nothing throws here.
#pragma omp parallel
  {
    const auto thread = static_cast<std::size_t>(omp_get_thread_num());
    if (thread < before_.size()) set_control_word(before_[thread]);
  }
}

}  // namespace cloudbow

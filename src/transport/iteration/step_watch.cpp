#include "transport/iteration/step_watch.hpp"

#include <algorithm>
#include <limits>

namespace cloudbow {

StepWatch StepWatch::of(std::span<const double> steps, double rounding, int changed, int change) {
  constexpr double progress = .9;
  constexpr double growth = 10;  // a plateau of mixing rises less
  StepWatch watch;
  double mark = std::numeric_limits<double>::infinity();  // the next step of progress is below this
  int since = 0;
  watch.least = mark;
  int index = -1;
  for (const double step : steps) {
    ++index;
    if (changed >= 0 && index >= changed && index < changed + change) {
      watch.restart_now = watch.stuck = false;
      watch.least = mark = std::numeric_limits<double>::infinity();
      since = 0;
      continue;
    }
    watch.least = std::min(watch.least, step);
    watch.restart_now = watch.stuck = false;
    if (step < mark) {
      mark = progress * step;
      since = 0;
      continue;
    }
    if (++since < patience) continue;
    if (watch.restarted || watch.least < rounding) {
      watch.stuck = true;
    } else {
      watch.restarted = watch.restart_now = true;
      watch.diverges = step > large || step > growth * watch.least;
      watch.least = mark = std::numeric_limits<double>::infinity();
      since = 0;
    }
  }
  return watch;
}

}  // namespace cloudbow

#include "app/planning/error_calibration.hpp"

#include <algorithm>
#include <array>
#include <cassert>

namespace cloudbow {
namespace {

struct Calibration {
  const char* accuracy;
  ErrorWeights weights;
  ByFlux ratio_to_draft;
};

// Each row: weights of the angular and of the spatial distance and the least, of domain, columns up, columns down.
// Then follows the expected error of the level as a share of the draft's estimate. Fitted by
// tests/validation/error_estimates.py --fit to half of its scenes: plane-parallel cases, step cloud, RICO, isolated
// clouds, thick voxels. For thick voxels of the other half, spatial weights of the domain's fluxes in fields were
// then raised by hand, at `draft` and `balanced`. All 234 estimates of fields are no less than the true error.
// Fields at `reference` were not examined. They have angular weights no smaller than those of `fine`, and spatial
// weights no smaller either. Columns at `reference` were not examined and have the weights of `fine`. No level is
// expected to be worse than the one before.
constexpr std::array<Calibration, 4> field_calibration{{
    {"draft", {{.62, .98, 2.1}, {.5, .98, .62}, {0, 0, 0}}, {1, 1, 1}},
    {"balanced", {{.2, .4, .56}, {.6, .79, .56}, {0, 0, 0}}, {.48, .5, .3}},
    {"fine", {{.091, .18, .43}, {.73, 1.4, .13}, {0, 0, 0}}, {.36, .39, .22}},
    {"reference", {{.34, .26, .43}, {.73, 1.4, .32}, {0, 0, 0}}, {.34, .37, .21}},
}};
constexpr std::array<Calibration, 4> column_calibration{{
    {"draft", {{1.3, 1.3, 1.8}, {0, 0, 0}, {3e-6, 1e-4, 0}}, {1, 1, 1}},
    {"balanced", {{1.5, 4.4, 4.6}, {0, 0, 0}, {0, 3e-4, 3e-4}}, {.16, .55, .62}},
    {"fine", {{.64, 1.7, 6.4}, {0, 0, 0}, {3e-5, 3e-5, 1e-4}}, {.027, .15, .41}},
    {"reference", {{.64, 1.7, 6.4}, {0, 0, 0}, {3e-5, 3e-5, 1e-4}}, {.026, .14, .4}},
}};

// Coarse solves have more streams, so that distances are errors, with a third in reserve. Those of `fine` have few
// more, which show half of the error. `reference` is held against three quarters of its streams, whose distance is more
// than its error.
constexpr std::array<Calibration, 4> stream_calibration{{
    {"draft", {{1.3, 1.3, 1.3}, {0, 0, 0}, {1e-5, 1e-4, 3e-5}}, {1, 1, 1}},
    {"balanced", {{1.3, 1.7, 1.3}, {0, 0, 0}, {3e-6, 3e-5, 1e-5}}, {.019, .03, .03}},
    {"fine", {{2.6, 3.4, 2.6}, {0, 0, 0}, {3e-6, 3e-5, 1e-5}}, {.013, .018, .018}},
    {"reference", {{.3, .7, .3}, {0, 0, 0}, {3e-6, 1e-5, 1e-5}}, {.009, .01, .01}},
}};

// Compared with the solution of most streams.
constexpr ErrorWeights weights_beside_streams{{1.3, 1.3, 1.3}, {0, 0, 0}, {3e-6, 1e-5, 1e-5}};

const Calibration& calibration(const std::string& accuracy, SolvedAs as) {
  const auto& table = as == SolvedAs::field                   ? field_calibration
                      : as == SolvedAs::column_by_its_streams ? stream_calibration
                                                              : column_calibration;
  const auto* const found =
      std::find_if(table.begin(), table.end(), [&](const Calibration& c) { return accuracy == c.accuracy; });
  assert(found != table.end());
  return *found;
}

}  // namespace

SolvedAs solved_as(const SolvePlan& plan, bool one_column) {
  if (!one_column && !plan.is_one_column()) return SolvedAs::field;
  if (plan.by_polar_streams()) return SolvedAs::column_by_its_streams;
  return plan.whole().surface.brdf ? SolvedAs::column : SolvedAs::column_beside_streams;
}

ErrorWeights error_weights(const std::string& accuracy, SolvedAs as) {
  return as == SolvedAs::column_beside_streams ? weights_beside_streams : calibration(accuracy, as).weights;
}

ByFlux error_ratio_to_draft(const std::string& accuracy, SolvedAs as) {
  return calibration(accuracy, as).ratio_to_draft;
}

}  // namespace cloudbow

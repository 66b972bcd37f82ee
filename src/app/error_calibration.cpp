#include "cloudbow/app/error_calibration.hpp"

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

constexpr std::array<Calibration, 4> kFields{{
    {"draft", {{1, 1, 1}, {1, 1, 1}, {0, 0, 0}}, {1, 1, 1}},
    {"balanced", {{1, 1, 1}, {1, 1, 1}, {0, 0, 0}}, {.4, .4, .4}},
    {"fine", {{1, 1, 1}, {1, 1, 1}, {0, 0, 0}}, {.2, .2, .2}},
    {"reference", {{1, 1, 1}, {1, 1, 1}, {0, 0, 0}}, {.15, .15, .15}},
}};
constexpr std::array<Calibration, 4> kColumns{kFields};

const Calibration& calibration(const std::string& accuracy, bool one_column) {
  const auto& table = one_column ? kColumns : kFields;
  const auto* const found =
      std::find_if(table.begin(), table.end(), [&](const Calibration& c) { return accuracy == c.accuracy; });
  assert(found != table.end());
  return *found;
}

}  // namespace

ErrorWeights error_weights(const std::string& accuracy, bool one_column) {
  return calibration(accuracy, one_column).weights;
}

ByFlux error_ratio_to_draft(const std::string& accuracy, bool one_column) {
  return calibration(accuracy, one_column).ratio_to_draft;
}

}  // namespace cloudbow

// A small k-distribution for tests.
#pragma once

#include <utility>
#include <vector>

#include "cloudbow/medium/gas_model.hpp"

namespace cloudbow {

/// A spectrum and shares of its intervals; no gas.
class FakeGasModel : public GasModel {
 public:
  /// @param share [points][intervals]
  FakeGasModel(Light light, Spectrum spectrum, std::vector<std::vector<double>> share)
      : light_(light), spectrum_(std::move(spectrum)), share_(std::move(share)) {}

  Light light() const override { return light_; }
  int points() const override { return static_cast<int>(share_.size()); }
  std::vector<std::string> gases() const override { return {}; }
  LayerOptics optics(std::span<const double>, std::span<const double>,
                     std::span<const std::vector<double>>) const override {
    return {};
  }
  double planck(int, double) const override { return 0; }
  double solar_share(int) const override { return 1.0 / points(); }
  const Spectrum& spectrum() const override { return spectrum_; }
  double share_of_interval(int point, std::size_t interval) const override {
    return share_[static_cast<std::size_t>(point)][interval];
  }

 private:
  Light light_;
  Spectrum spectrum_;
  std::vector<std::vector<double>> share_;
};

}  // namespace cloudbow

// Gas optics by g-points: a k-distribution, in which each g-point is one wavelength to the solver.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cloudbow/medium/atmosphere.hpp"

namespace cloudbow {

/// A k-distribution. Readers of file formats stand behind it.
class GasModel {
 public:
  enum class Light { solar, longwave };

  virtual ~GasModel() = default;

  virtual Light light() const = 0;
  virtual int points() const = 0;
  /// Gases whose mole fractions it needs by height, by their names in Atmosphere::mole_fraction.
  virtual std::vector<std::string> gases() const = 0;

  /// Vertical optical depths of layers of air at all g-points.
  struct LayerOptics {
    std::vector<std::vector<double>> absorption;  ///< [points][layers]
    std::vector<std::vector<double>> rayleigh;    ///< [points][layers] scattering; solar models alone, else empty
  };
  /// @param pressure_pa [layers + 1] at the interfaces, in the order of the layers, from either end.
  /// @param temperature_k [layers] @param mole_fraction [gases()][layers]
  virtual LayerOptics optics(std::span<const double> pressure_pa, std::span<const double> temperature_k,
                             std::span<const std::vector<double>> mole_fraction) const = 0;

  /// Longwave: Planck radiance at a g-point, W m-2 sr-1. Their sum over the g-points is sigma T^4 / pi nearly.
  virtual double planck(int point, double temperature_k) const = 0;
  /// Solar: share of the total solar irradiance at a g-point; the shares sum to 1.
  virtual double solar_share(int point) const = 0;

  /// Wavenumber intervals [cm-1], ascending.
  struct Spectrum {
    std::vector<double> lower, upper;  ///< [intervals]
    std::vector<double> solar;         ///< [intervals] solar irradiance in each, any unit; solar models alone
  };
  virtual const Spectrum& spectrum() const = 0;
  /// Share of an interval that a g-point has: sums to 1 over the g-points.
  virtual double share_of_interval(int point, std::size_t interval) const = 0;

  /// Wide wavenumber intervals [cm-1]. Each g-point belongs to one of them.
  struct Bands {
    std::vector<double> lower, upper;  ///< [bands]
    std::vector<int> of_point;         ///< [points] index of its band
  };
  /// One band, the whole spectrum, unless the model has others.
  virtual Bands bands() const;
};

/// Reads a gas model: ecCKD definition files (netCDF). @throws InputError that names the file, what was found, what is
/// allowed and what to do.
std::unique_ptr<GasModel> read_gas_model(const std::filesystem::path& file);

/// Optics of the air between heights. Temperature of a layer is weighted by pressure, (T1 p1 + T2 p2)/(p1 + p2); mole
/// fractions are those at its mean pressure. @param edges_m [layers + 1] ascending.
/// @throws InputError if the atmosphere lacks a gas of the model; the message names all of them.
GasModel::LayerOptics gas_optics(const GasModel& model, const Atmosphere& atmosphere, std::span<const double> edges_m);

}  // namespace cloudbow

// Optical depths and Planck radiances by the tables of an ecCKD gas model.
#include "ecckd_model.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "cloudbow/optics/planck.hpp"

namespace cloudbow {
namespace {

constexpr double gravity = 9.80665;           // m s-2
constexpr double air_molar_mass = 28.970e-3;  // kg mol-1, with which ecCKD's tables were made

/// Position between two entries of a table.
struct Location {
  std::size_t below = 0;
  double share = 0;  ///< of the entry above

  template <class Of>
  double mean(const Of& of) const {
    return (1 - share) * of(below) + share * of(below + 1);
  }
};

/// At an index that need not be whole. The last interval ends just short of its end, as in ecCKD's own programs.
Location locate(double index, std::size_t count) {
  constexpr double end = 1.0001;
  const double inside = std::clamp(index, 0., static_cast<double>(count) - end);
  const auto below = static_cast<std::size_t>(inside);
  return {below, inside - static_cast<double>(below)};
}

Location locate(double value, const EvenAxis& axis) { return locate((value - axis.first) / axis.step, axis.count); }

/// Share of each interval of wavenumbers that a g-point has. The file has the reverse: the fraction of each g-point's
/// wavenumbers that lies in an interval. The widths of the g-points W follow by least squares, for their wavenumbers
/// fill the intervals: sum_g fraction(g, i) W_g = width(i).
std::vector<double> shares_of_intervals(const EcckdTables& tables) {
  const std::size_t intervals = tables.spectrum.lower.size();
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Map<const Rows> fraction(tables.fraction.data(), static_cast<Eigen::Index>(tables.points),
                                        static_cast<Eigen::Index>(intervals));
  Eigen::VectorXd width(static_cast<Eigen::Index>(intervals));
  for (std::size_t i = 0; i < intervals; ++i)
    width[static_cast<Eigen::Index>(i)] = tables.spectrum.upper[i] - tables.spectrum.lower[i];
  // G-points with equal fractions make this degenerate; the decomposition then gives the shortest solution.
  const Eigen::VectorXd of_points =
      (fraction * fraction.transpose()).completeOrthogonalDecomposition().solve(fraction * width).cwiseMax(0.);

  std::vector<double> share(tables.points * intervals);
  for (std::size_t i = 0; i < intervals; ++i) {
    double sum = 0;
    for (std::size_t g = 0; g < tables.points; ++g) {
      share[g * intervals + i] = tables.fraction[g * intervals + i] * of_points[static_cast<Eigen::Index>(g)];
      sum += share[g * intervals + i];
    }
    for (std::size_t g = 0; g < tables.points && sum > 0; ++g) share[g * intervals + i] /= sum;
  }
  return share;
}

PlanckFunction planck_of_wavenumbers(double lower_cm, double upper_cm) {
  constexpr double um_per_cm = 1e4;
  return PlanckFunction::over(
      {um_per_cm / upper_cm, lower_cm > 0 ? um_per_cm / lower_cm : std::numeric_limits<double>::infinity()});
}

class EcckdModel : public GasModel {
 public:
  explicit EcckdModel(EcckdTables tables) : tables_(std::move(tables)), share_(shares_of_intervals(tables_)) {
    for (const EcckdGas& gas : tables_.gas) {
      if (gas.dependence != EcckdDependence::none) gases_.push_back(gas.name);
    }
    for (std::size_t i = 0; i < tables_.spectrum.lower.size(); ++i)
      band_.push_back(planck_of_wavenumbers(tables_.spectrum.lower[i], tables_.spectrum.upper[i]));
    if (tables_.light == Light::solar) set_sun();
  }

  Light light() const override { return tables_.light; }
  int points() const override { return static_cast<int>(tables_.points); }
  Bands bands() const override { return tables_.bands.lower.empty() ? GasModel::bands() : tables_.bands; }
  std::vector<std::string> gases() const override { return gases_; }

  LayerOptics optics(std::span<const double> pressure_pa, std::span<const double> temperature_k,
                     std::span<const std::vector<double>> mole_fraction) const override {
    const std::size_t layers = temperature_k.size();
    assert(pressure_pa.size() == layers + 1 && mole_fraction.size() == gases_.size());
    LayerOptics optics;
    optics.absorption.assign(tables_.points, std::vector<double>(layers));
    if (light() == Light::solar) optics.rayleigh = optics.absorption;
    std::vector<double> depth(tables_.points), fraction(gases_.size());
    for (std::size_t n = 0; n < layers; ++n) {
      const double air = std::abs(pressure_pa[n + 1] - pressure_pa[n]) / (gravity * air_molar_mass);  // mol m-2
      for (std::size_t gas = 0; gas < gases_.size(); ++gas) fraction[gas] = mole_fraction[gas][n];
      absorb((pressure_pa[n] + pressure_pa[n + 1]) / 2, temperature_k[n], air, fraction, depth);
      for (std::size_t g = 0; g < tables_.points; ++g) {
        // A gas below its reference counts as negative absorption.
        optics.absorption[g][n] = std::max(0., depth[g]);
        if (light() == Light::solar) optics.rayleigh[g][n] = air * tables_.rayleigh[g];
      }
    }
    return optics;
  }

  double planck(int point, double temperature_k) const override {
    if (light() == Light::solar) return 0;
    const auto g = static_cast<std::size_t>(point);
    const EvenAxis& axis = tables_.planck_temperature;
    const auto of_table = [&](std::size_t n) { return tables_.planck_flux[n * tables_.points + g] / std::numbers::pi; };
    const double last = static_cast<double>(axis.count - 1);
    const double index = (temperature_k - axis.first) / axis.step;
    if (index >= 0 && index <= last) {
      const std::size_t below = std::min(static_cast<std::size_t>(index), axis.count - 2);
      return Location{below, index - static_cast<double>(below)}.mean(of_table);
    }
    // Tables end at 120 and 350 K, the ground need not. There the law itself takes over, scaled to the table's end.
    const std::size_t end = index < 0 ? 0 : axis.count - 1;
    const double of_law = planck_law(g, axis.first + axis.step * static_cast<double>(end));
    return of_law > 0 ? of_table(end) / of_law * planck_law(g, temperature_k) : of_table(end);
  }

  double solar_share(int point) const override {
    return light() == Light::solar ? tables_.solar_irradiance[static_cast<std::size_t>(point)] : 0;
  }

  const Spectrum& spectrum() const override { return tables_.spectrum; }
  double share_of_interval(int point, std::size_t interval) const override {
    return share_[static_cast<std::size_t>(point) * tables_.spectrum.lower.size() + interval];
  }

 private:
  /// Optical depths of a layer at all g-points; may be negative. @param air mol m-2
  void absorb(double pressure_pa, double temperature_k, double air, std::span<const double> fraction,
              std::vector<double>& depth) const {
    std::fill(depth.begin(), depth.end(), 0.);
    const Location pressure = locate(std::log(pressure_pa), tables_.log_pressure);
    const double first = pressure.mean([&](std::size_t n) { return tables_.first_temperature[n]; });
    const Location temperature = locate((temperature_k - first) / tables_.temperature.step, tables_.temperature.count);
    std::size_t next = 0;
    for (const EcckdGas& gas : tables_.gas) {
      const double x = gas.dependence == EcckdDependence::none ? 1 : fraction[next++];
      if (gas.dependence == EcckdDependence::lookup) {
        const EvenAxis& axis = gas.log_mole_fraction;
        const Location of_fraction = locate(x > 0 ? std::log(x) : axis.first, axis);
        add(gas, of_fraction.below, temperature, pressure, (1 - of_fraction.share) * air * x, depth);
        add(gas, of_fraction.below + 1, temperature, pressure, of_fraction.share * air * x, depth);
      } else {
        add(gas, 0, temperature, pressure, air * (x - gas.reference_fraction), depth);
      }
    }
  }

  /// Adds moles times the bilinear mean of one table of the gas.
  void add(const EcckdGas& gas, std::size_t table, const Location& temperature, const Location& pressure, double moles,
           std::vector<double>& depth) const {
    const std::size_t row = tables_.points, slab = row * tables_.log_pressure.count;
    const double* corner =
        gas.absorption.data() + (table * tables_.temperature.count + temperature.below) * slab + pressure.below * row;
    const double cold = moles * (1 - temperature.share), warm = moles * temperature.share;
    const double high = 1 - pressure.share, low = pressure.share;
    for (std::size_t g = 0; g < row; ++g) {
      depth[g] += cold * (high * corner[g] + low * corner[row + g]) +
                  warm * (high * corner[slab + g] + low * corner[slab + row + g]);
    }
  }

  /// Planck's law over the wavenumbers of a g-point, W m-2 sr-1.
  double planck_law(std::size_t point, double temperature_k) const {
    double sum = 0;
    for (std::size_t i = 0; i < band_.size(); ++i) sum += share_[point * band_.size() + i] * band_[i](temperature_k);
    return sum;
  }

  void set_sun() {
    double sum = 0;
    for (const double irradiance : tables_.solar_irradiance) sum += irradiance;
    for (double& irradiance : tables_.solar_irradiance) irradiance /= sum;
    // Files before version 1.4 lack the solar spectrum; a black body has nearly its form.
    constexpr double sun_k = 5777;
    std::vector<double>& solar = tables_.spectrum.solar;
    for (std::size_t i = solar.size(); i < band_.size(); ++i) solar.push_back(band_[i](sun_k));
  }

  EcckdTables tables_;
  std::vector<double> share_;         ///< [points][intervals]
  std::vector<PlanckFunction> band_;  ///< [intervals]
  std::vector<std::string> gases_;
};

}  // namespace

std::unique_ptr<GasModel> make_ecckd_model(EcckdTables tables) {
  return std::make_unique<EcckdModel>(std::move(tables));
}

}  // namespace cloudbow

// ecCKD gas models: look-up tables of molar absorption (Hogan and Matricardi 2022, J. Adv. Model. Earth Syst. 14,
// e2022MS003033).
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cloudbow/medium/gas_model.hpp"

namespace cloudbow {

/// Dependence of a gas's optical depth on its mole fraction x, by the codes of the file.
enum class EcckdDependence { none = 0, linear = 1, lookup = 2, relative_linear = 3 };

/// Numbers at equal steps.
struct EvenAxis {
  double first = 0;
  double step = 1;
  std::size_t count = 0;
};

struct EcckdGas {
  std::string name;
  EcckdDependence dependence = EcckdDependence::none;
  EvenAxis log_mole_fraction{};    ///< of look-up tables
  double reference_fraction = 0;   ///< of relative ones
  std::vector<double> absorption;  ///< [mole fractions, or 1][temperatures][pressures][points] m2 mol-1
};

/// Content of a definition file. Reading checks it: lengths agree, numbers are finite and within their ranges.
struct EcckdTables {
  GasModel::Light light = GasModel::Light::longwave;
  std::size_t points = 0;
  EvenAxis log_pressure;                  ///< ln Pa
  std::vector<double> first_temperature;  ///< [pressures] K
  EvenAxis temperature;                   ///< step and count; the first depends on the pressure
  std::vector<EcckdGas> gas;
  std::vector<double> rayleigh;          ///< [points] m2 mol-1, of air; solar models
  std::vector<double> solar_irradiance;  ///< [points] W m-2; solar models
  EvenAxis planck_temperature;           ///< K; longwave models
  std::vector<double> planck_flux;       ///< [temperatures][points] W m-2; longwave models
  GasModel::Spectrum spectrum;
  GasModel::Bands bands;         ///< none if the file names none
  std::vector<double> fraction;  ///< [points][intervals] of the g-point's wavenumbers that lie in the interval
};

/// @throws InputError
EcckdTables read_ecckd(const std::filesystem::path& file);

std::unique_ptr<GasModel> make_ecckd_model(EcckdTables tables);

}  // namespace cloudbow

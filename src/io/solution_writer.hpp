// Variables and attributes of one solution, or of those of several wavelengths on the same grid with a dimension more.
#pragma once

#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "cloudbow/io/result_file.hpp"
#include "cloudbow/transport/output_fields.hpp"
#include "io/netcdf4_file.hpp"

namespace cloudbow {

class SolutionWriter {
 public:
  /// All of them must last as long as the writer.
  SolutionWriter(std::span<const Solution> solutions, const ResultInfo& info)
      : solutions_(solutions), first_(solutions.front()), info_(info), spectral_(!info.wavelengths_um.empty()) {}

  const Solution& first() const { return first_; }
  const ResultInfo& info() const { return info_; }
  bool spectral() const { return spectral_; }
  bool emits() const { return first_.emits; }
  SpectralUnit unit() const {
    return !info_.thermal.empty() && info_.thermal.front().wavelength_um ? SpectralUnit::wavelength
                                                                         : SpectralUnit::band;
  }
  /// Units over a band, in the spectral unit of the scene.
  std::string units(const std::string& of_band) const { return with_spectral_unit(of_band, unit()); }
  FieldNames names(const OutputField& field) const { return names_of(field, first_, unit()); }
  std::size_t index_of(const Solution& solution) const { return static_cast<std::size_t>(&solution - &first_); }

  /// @param values_of returns the values of one solution, a vector
  template <class Values>
  void write_variable(hid_t group, const std::string& name, std::vector<std::string> dimensions,
                      const Values& values_of, const std::vector<netcdf4::Attribute>& attributes) const {
    using Vector = std::decay_t<decltype(values_of(first_))>;
    using Number = const typename Vector::value_type;
    if (!spectral_) {
      const auto& values = values_of(first_);
      netcdf4::write_variable(group, name.c_str(), dimensions, std::span<Number>(values), attributes);
      return;
    }
    Vector all;
    for (const Solution& solution : solutions_) {
      const auto& values = values_of(solution);
      all.insert(all.end(), values.begin(), values.end());
    }
    dimensions.insert(dimensions.begin(), "wavelength");
    netcdf4::write_variable(group, name.c_str(), dimensions, std::span<Number>(all), attributes);
  }

  /// A number, or one for each wavelength.
  template <class Number>
  netcdf4::AttributeValue each(const Number& number_of) const {
    return each(number_of, solutions_);
  }

  template <class Number>
  netcdf4::AttributeValue each(const Number& number_of, std::span<const Solution> solutions) const {
    using Value = std::decay_t<decltype(number_of(first_))>;
    if (!spectral_) return number_of(solutions.front());
    std::vector<Value> all;
    for (const Solution& solution : solutions) all.push_back(number_of(solution));
    return all;
  }

  template <class Number>
  netcdf4::AttributeValue each(const std::vector<Number>& numbers) const {
    if (spectral_) return numbers;
    return numbers.front();
  }

  void write_wavelength(hid_t group) const {
    if (!spectral_) return;
    netcdf4::write_coordinate(
        group, "wavelength", info_.wavelengths_um,
        {{"units", "um"}, {"long_name", "wavelength"}, {"standard_name", "radiation_wavelength"}});
  }

 private:
  std::span<const Solution> solutions_;
  const Solution& first_;
  const ResultInfo& info_;
  bool spectral_;
};

}  // namespace cloudbow

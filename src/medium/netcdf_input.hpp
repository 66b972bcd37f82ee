// A netCDF file, classic or netCDF-4, read variable by variable.
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace cloudbow {

struct NetcdfVariable {
  int id = 0;
  std::string name;
  std::vector<std::string> dimension;  ///< slowest first
  std::vector<std::size_t> length;     ///< of the dimensions
  std::string units;                   ///< empty where the file does not say
};

class NetcdfInput {
 public:
  /// @throws InputError where the file is not netCDF, or damaged.
  explicit NetcdfInput(const std::filesystem::path& path);
  ~NetcdfInput();
  NetcdfInput(const NetcdfInput&) = delete;
  NetcdfInput& operator=(const NetcdfInput&) = delete;

  const std::vector<NetcdfVariable>& variables() const { return variables_; }
  const NetcdfVariable* find(const std::string& name) const;
  /// Empty where there is none, or it is no text.
  std::string text_attribute(const NetcdfVariable& variable, const char* name) const;

  /// A part of a numeric variable, scale_factor and add_offset applied; fill and missing values and
  /// those outside valid_range become NaN.
  /// @throws InputError naming the variable.
  std::vector<double> read(const NetcdfVariable& variable, const std::vector<std::size_t>& start,
                           const std::vector<std::size_t>& count) const;
  std::vector<double> read(const NetcdfVariable& variable) const;

 private:
  void check(int status, const std::string& what) const;
  std::optional<double> number_attribute(const NetcdfVariable& variable, const char* name) const;
  /// Of the numbers as they are stored; beyond it they are missing.
  struct NumberRange {
    double least = -std::numeric_limits<double>::infinity();
    double largest = std::numeric_limits<double>::infinity();
  };
  NumberRange valid_range(const NetcdfVariable& variable) const;
  void list_variables();
  double attribute_bytes(int variable) const;
  void check_length() const;

  std::filesystem::path path_;
  int id_ = 0;
  std::vector<NetcdfVariable> variables_;
};

}  // namespace cloudbow

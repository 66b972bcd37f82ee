// The netCDF file of a large-eddy simulation: variables by their names, meanings and units.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "import_parts.hpp"
#include "les_models.hpp"
#include "les_vocabulary.hpp"
#include "netcdf_input.hpp"

namespace cloudbow {

class LesFile {
 public:
  explicit LesFile(const CloudImportOptions& import_options);

  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    fail_import(options.file, text, std::forward<Args>(args)...);
  }
  template <class... Args>
  void note(fmt::format_string<Args...> text, Args&&... args) {
    notes.push_back(fmt::format(text, std::forward<Args>(args)...));
  }

  /// Name, shape and unit, for notes.
  static std::string described(const NetcdfVariable& variable, const std::string& units);
  /// The fields of the file, for messages.
  std::string fields_there() const;

  /// The variable that the user names with an option. @throws InputError if there is none.
  const NetcdfVariable& named(const std::string& name, const std::string& option) const;
  /// All variables with these names, in their order, else all with one of the standard names; scalars do not count. The
  /// names of the model come first. Names that mean something else in it are left out.
  std::vector<const NetcdfVariable*> candidates(const Words& words) const;
  const NetcdfVariable* first_of(const Words& words) const;
  /// The variable that the user names, else the first candidate, else null.
  const NetcdfVariable* find(const std::string& given, const Words& words, const std::string& option) const;

  /// Words of the attributes about a variable, in lower case.
  std::string meaning(const NetcdfVariable& variable) const;
  bool is_perturbation(const NetcdfVariable& variable) const;

  /// The size of the unit in the file; guessed only if the file does not say it.
  double factor(const NetcdfVariable& variable, const UnitTable& table, double guess, const char* guessed_unit);

  const CloudImportOptions& options;
  NetcdfInput input;                ///< the file, and others for what it lacks
  const LesModel* model = nullptr;  ///< null: none is recognised
  std::vector<std::string> notes;
};

}  // namespace cloudbow

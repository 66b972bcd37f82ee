// The netCDF file of a large-eddy simulation: variables by their names, meanings and units.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "import_parts.hpp"
#include "les_models.hpp"
#include "les_vocabulary.hpp"
#include "netcdf_input.hpp"

namespace cloudbow {

/// A file, and others for what it lacks: of variables with one name the first file's counts.
class LesInputs {
 public:
  LesInputs(const std::filesystem::path& first, const std::vector<std::filesystem::path>& others);

  const std::vector<NetcdfVariable>& variables() const { return variables_; }
  std::size_t files() const { return inputs_.size(); }
  const NetcdfVariable* find(const std::string& name) const;
  const NetcdfVariable* find_in(std::size_t file, const std::string& name) const;
  std::string text_attribute(const NetcdfVariable& variable, const char* name) const;
  std::string global_text(const char* name) const;
  std::optional<double> global_number(const char* name) const;
  double packing_step(const NetcdfVariable& variable) const;
  std::size_t chunk_length(const NetcdfVariable& variable, std::size_t dimension) const;
  std::vector<double> read(const NetcdfVariable& variable, const std::vector<std::size_t>& start,
                           const std::vector<std::size_t>& count) const;
  std::vector<double> read(const NetcdfVariable& variable) const;

 private:
  std::vector<std::unique_ptr<NetcdfInput>> inputs_;
  std::vector<NetcdfVariable> variables_;
};

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
  LesInputs input;
  const LesModel* model = nullptr;  ///< null: none is recognised
  std::vector<std::string> notes;
};

}  // namespace cloudbow

// netCDF files, classic or netCDF-4, read variable by variable.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace cloudbow {

struct NetcdfVariable {
  int id = 0;
  std::string name;                    ///< in a group, if the name is there before: "group/name"
  std::vector<std::string> dimension;  ///< slowest first
  std::vector<std::size_t> length;     ///< of the dimensions
  std::string units;                   ///< empty if the file does not say
  bool is_float32 = false;
  int group = 0;         ///< the library's number of the file, or of a group in it
  std::size_t file = 0;  ///< index of the file, if several are open
};

/// Whether the first bytes are those of netCDF, classic or netCDF-4; such a file may still be damaged. Loads the
/// library if they are, so that the sandbox in which the file is read first has it.
/// @param allowed what the file should be, for messages. @throws InputError if it cannot be read.
bool begins_as_netcdf(const std::filesystem::path& file, const char* allowed);

/// Which values of a variable, as they are stored, are data.
struct ValidValues;

class NetcdfInput {
 public:
  /// @throws InputError if the file is not netCDF, damaged, or locked by a program that writes it.
  /// @param has_groups variables of groups count too
  explicit NetcdfInput(const std::filesystem::path& path, bool has_groups = false);
  /// A file, and others for what it lacks. Variables of groups count.
  NetcdfInput(const std::filesystem::path& first, const std::vector<std::filesystem::path>& others);

  /// By file, those of the file itself first, then those of its groups if they count.
  const std::vector<NetcdfVariable>& variables() const { return variables_; }
  std::size_t files() const { return files_.size(); }
  /// The first variable of this name, null if there is none.
  const NetcdfVariable* find(const std::string& name) const;
  const NetcdfVariable* find_in(std::size_t file, const std::string& name) const;
  /// Empty if there is none, or it is no text.
  std::string text_attribute(const NetcdfVariable& variable, const char* name) const;
  /// A text among the attributes of the first file; empty if there is none.
  std::string global_text(const char* name) const;
  /// A number among the attributes of the first file that has it.
  std::optional<double> global_number(const char* name) const;
  /// 0 if the variable is not packed: the distance of two numbers that its integers can represent.
  double packing_step(const NetcdfVariable& variable) const;

  /// Values along a dimension that are stored together, so that reading fewer costs as much; 1 if they are not.
  std::size_t chunk_length(const NetcdfVariable& variable, std::size_t dimension) const;

  /// A part of a numeric variable, scale_factor and add_offset applied. Values that the attributes _FillValue,
  /// missing_value, valid_range, valid_min or valid_max exclude become NaN, as do values that were never written.
  /// @throws InputError naming the variable, also if one of these attributes is not what netCDF's conventions allow.
  std::vector<double> read(const NetcdfVariable& variable, const std::vector<std::size_t>& start,
                           const std::vector<std::size_t>& count) const;
  std::vector<double> read(const NetcdfVariable& variable) const;

 private:
  /// An open file, closed with the object.
  struct OpenFile {
    explicit OpenFile(const std::filesystem::path& path);
    ~OpenFile();
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;
    void check(int status, const std::string& what) const;

    std::filesystem::path path;
    int id = 0;
    int groups_left = 0;  ///< that may still be read: groups may be linked in rings
  };

  void open(const std::filesystem::path& path, bool has_groups);
  const OpenFile& file_of(const NetcdfVariable& variable) const { return *files_[variable.file]; }
  std::vector<double> numbers_of_attribute(const NetcdfVariable& variable, const char* name) const;
  std::optional<double> number_attribute(const NetcdfVariable& variable, const char* name) const;
  /// Attributes of a variable of a group, or of the file.
  static std::string text_of(const OpenFile& file, int group, int variable, const char* name);
  static std::vector<double> numbers_of(const OpenFile& file, int group, int variable, const std::string& owner,
                                        const char* name);
  ValidValues valid_values(const NetcdfVariable& variable) const;
  void list_variables(int group, const std::string& path);
  static double attribute_bytes(const OpenFile& file, int variable);
  void check_length(std::size_t file) const;

  std::vector<std::unique_ptr<OpenFile>> files_;
  std::vector<NetcdfVariable> variables_;
};

}  // namespace cloudbow

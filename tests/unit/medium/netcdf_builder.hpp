// Makes small netCDF-4 files for tests, variable by variable.
#pragma once

#include <gtest/gtest.h>
#include <netcdf.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace cloudbow {

class NetcdfBuilder {
 public:
  explicit NetcdfBuilder(const std::filesystem::path& path) : path_(path) {
    check(nc_create(path.c_str(), NC_CLOBBER | NC_NETCDF4, &file_));
    id_ = file_;
  }
  ~NetcdfBuilder() {
    if (file_ >= 0) nc_close(file_);
  }
  NetcdfBuilder(const NetcdfBuilder&) = delete;
  NetcdfBuilder& operator=(const NetcdfBuilder&) = delete;

  void dimension(const std::string& name, std::size_t length) {
    int made = 0;
    check(nc_def_dim(id_, name.c_str(), length, &made));
  }
  void variable(const std::string& name, const std::vector<std::string>& dimensions, const std::string& units,
                const std::vector<double>& values, nc_type type = NC_FLOAT) {
    std::vector<int> dimension(dimensions.size());
    for (std::size_t n = 0; n < dimensions.size(); ++n) check(nc_inq_dimid(id_, dimensions[n].c_str(), &dimension[n]));
    int made = 0;
    check(nc_def_var(id_, name.c_str(), type, static_cast<int>(dimension.size()), dimension.data(), &made));
    if (!units.empty()) text(name, "units", units);
    check(nc_put_var_double(id_, made, values.data()));
  }
  /// Further variables go into a group of this name.
  void group(const std::string& name) { check(nc_def_grp(file_, name.c_str(), &id_)); }
  void text(const std::string& name, const std::string& attribute, const std::string& value) {
    check(nc_put_att_text(id_, find(name), attribute.c_str(), value.size(), value.c_str()));
  }
  void number(const std::string& name, const std::string& attribute, const std::vector<double>& value, nc_type type) {
    check(nc_put_att_double(id_, find(name), attribute.c_str(), type, value.size(), value.data()));
  }
  std::filesystem::path close() {
    nc_close(std::exchange(file_, -1));
    return path_;
  }

 private:
  static void check(int status) { ASSERT_EQ(status, NC_NOERR) << nc_strerror(status); }
  /// The file itself by an empty name.
  int find(const std::string& name) const {
    if (name.empty()) return NC_GLOBAL;
    int variable = 0;
    check(nc_inq_varid(id_, name.c_str(), &variable));
    return variable;
  }

  std::filesystem::path path_;
  int file_ = -1;
  int id_ = -1;  ///< of the file, or of the group that variables go into
};

}  // namespace cloudbow

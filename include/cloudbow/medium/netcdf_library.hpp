// Functions of the netCDF library, which brings many others and takes longer to load than small scenes take to read.
#pragma once

#include <cstddef>

namespace cloudbow {

/// The functions nc_NAME that the program uses; netCDF documents them. Types and constants are those of <netcdf.h>.
struct NetcdfLibrary {
  int (*open)(const char* path, int mode, int* file);
  int (*close)(int file);
  const char* (*strerror)(int status);
  int (*inq_format)(int file, int* format);
  int (*inq_grps)(int group, int* count, int* groups);
  int (*inq_grpname)(int group, char* name);
  int (*inq_natts)(int group, int* count);
  int (*inq_ndims)(int group, int* count);
  int (*inq_nvars)(int group, int* count);
  int (*inq_type)(int group, int type, char* name, std::size_t* bytes);
  int (*inq_dim)(int group, int dimension, char* name, std::size_t* length);
  int (*inq_dimlen)(int group, int dimension, std::size_t* length);
  int (*inq_dimname)(int group, int dimension, char* name);
  int (*inq_varid)(int group, const char* name, int* variable);
  int (*inq_varname)(int group, int variable, char* name);
  int (*inq_vartype)(int group, int variable, int* type);
  int (*inq_varndims)(int group, int variable, int* rank);
  int (*inq_vardimid)(int group, int variable, int* dimensions);
  int (*inq_varnatts)(int group, int variable, int* count);
  int (*inq_var_chunking)(int group, int variable, int* storage, std::size_t* lengths);
  int (*inq_att)(int group, int variable, const char* name, int* type, std::size_t* length);
  int (*inq_attname)(int group, int variable, int number, char* name);
  int (*inq_atttype)(int group, int variable, const char* name, int* type);
  int (*get_att_text)(int group, int variable, const char* name, char* text);
  int (*get_att_string)(int group, int variable, const char* name, char** text);
  int (*get_att_double)(int group, int variable, const char* name, double* numbers);
  int (*get_vara_double)(int group, int variable, const std::size_t* start, const std::size_t* count, double* numbers);
  int (*free_string)(std::size_t count, char** text);
};

/// Loads the library with the first call, in the module cloudbow_netcdf. Call it before a sandbox that needs it: the
/// child then has it too. @throws InputError if it cannot be loaded.
const NetcdfLibrary& netcdf_library();

}  // namespace cloudbow

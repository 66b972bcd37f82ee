#include "netcdf_module.hpp"

#include <netcdf.h>

const cloudbow::NetcdfLibrary cloudbow_netcdf_module = {
    .open = nc_open,
    .close = nc_close,
    .strerror = nc_strerror,
    .inq_format = nc_inq_format,
    .inq_grps = nc_inq_grps,
    .inq_grpname = nc_inq_grpname,
    .inq_natts = nc_inq_natts,
    .inq_ndims = nc_inq_ndims,
    .inq_nvars = nc_inq_nvars,
    .inq_type = nc_inq_type,
    .inq_dim = nc_inq_dim,
    .inq_dimlen = nc_inq_dimlen,
    .inq_dimname = nc_inq_dimname,
    .inq_varid = nc_inq_varid,
    .inq_varname = nc_inq_varname,
    .inq_vartype = nc_inq_vartype,
    .inq_varndims = nc_inq_varndims,
    .inq_vardimid = nc_inq_vardimid,
    .inq_varnatts = nc_inq_varnatts,
    .inq_var_chunking = nc_inq_var_chunking,
    .inq_att = nc_inq_att,
    .inq_attname = nc_inq_attname,
    .inq_atttype = nc_inq_atttype,
    .get_att_text = nc_get_att_text,
    .get_att_string = nc_get_att_string,
    .get_att_double = nc_get_att_double,
    .get_vara_double = nc_get_vara_double,
    .free_string = nc_free_string,
};

# Every package the project uses; cloudbow-config.cmake.in has those that its static libraries need again. docs/architecture.md says what each is for.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt 9 REQUIRED)
find_package(OpenMP REQUIRED COMPONENTS CXX)
find_package(PNG REQUIRED)
find_package(ZLIB REQUIRED)
find_package(CLI11 REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(HDF5 REQUIRED COMPONENTS C HL)
find_package(PkgConfig REQUIRED)
pkg_check_modules(CLP REQUIRED IMPORTED_TARGET clp)
pkg_check_modules(NETCDF REQUIRED IMPORTED_TARGET netcdf)
pkg_check_modules(PANGOCAIRO REQUIRED IMPORTED_TARGET pangocairo cairo-svg cairo-pdf)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)

# Debian keeps FindOpenVDB.cmake outside CMake's own module path.
find_path(CLOUDBOW_OPENVDB_MODULE_DIR FindOpenVDB.cmake
          PATH_SUFFIXES lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB lib/cmake/OpenVDB lib64/cmake/OpenVDB)
if(CLOUDBOW_OPENVDB_MODULE_DIR)
  list(APPEND CMAKE_MODULE_PATH ${CLOUDBOW_OPENVDB_MODULE_DIR})
endif()
find_package(OpenVDB REQUIRED COMPONENTS openvdb)

# The package that find_package(cloudbow) finds: headers, libraries by layers, and what they link.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/cloudbow)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/cloudbow DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT cloudbow-targets NAMESPACE cloudbow:: DESTINATION ${package_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/cloudbow-config.cmake.in ${PROJECT_BINARY_DIR}/cloudbow-config.cmake
                              INSTALL_DESTINATION ${package_dir})
# Before 1.0 a minor version may change headers.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/cloudbow-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/cloudbow-config.cmake ${PROJECT_BINARY_DIR}/cloudbow-config-version.cmake DESTINATION ${package_dir})

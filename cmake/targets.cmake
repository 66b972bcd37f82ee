# cloudbow_layer(NAME SOURCES ... LINK ... PRIVATE_LINK ...): one static library per layer. A layer links only layers below it.
add_library(cloudbow_options INTERFACE)
target_compile_features(cloudbow_options INTERFACE cxx_std_20)
target_compile_options(cloudbow_options INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Wpedantic -Wconversion -Wno-sign-conversion)
# At -O3 GCC 12 takes text that is put before a std::string for overlapping memory (its bug 105651, mended in 13).
target_compile_options(cloudbow_options INTERFACE $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>)
if(CLOUDBOW_WARNINGS_AS_ERRORS)
  target_compile_options(cloudbow_options INTERFACE -Werror)
endif()
if(CLOUDBOW_ARCHITECTURE)
  target_compile_options(cloudbow_options INTERFACE -march=${CLOUDBOW_ARCHITECTURE})
endif()

function(cloudbow_layer name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  set(target cloudbow_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(cloudbow::${name} ALIAS ${target})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                              $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/generated>
                                              $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  # Private headers are named from src/: "transport/rays/march.hpp".
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(${target} PUBLIC ${ARG_LINK} PRIVATE $<BUILD_INTERFACE:cloudbow_options> ${ARG_PRIVATE_LINK})
  # What Eigen aligns its memory to follows from the architecture, and must be the same on both sides of a header.
  if(CLOUDBOW_ARCHITECTURE)
    target_compile_options(${target} INTERFACE $<INSTALL_INTERFACE:-march=${CLOUDBOW_ARCHITECTURE}>)
  endif()
  # Eigen must not thread by itself: threads split voxels and directions in fixed tiles, so that results do not depend on their number.
  target_compile_definitions(${target} PUBLIC EIGEN_DONT_PARALLELIZE)
  # Plugins and modules of other languages, which are shared objects, link these libraries too. Nobody replaces their
  # functions at load time, so calls within them stay direct.
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_compile_options(${target} PRIVATE -fno-semantic-interposition)
  # Up to eight sources of layers without kernels are compiled at a time. Names in unnamed namespaces have to differ
  # among the sources of such a layer.
  if(CLOUDBOW_PRECOMPILED_HEADERS AND name MATCHES "^(app|io|medium)$")
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
  endif()
  # What most sources read, compiled once per layer: half of a compiler's time is the reading of headers.
  if(CLOUDBOW_PRECOMPILED_HEADERS AND NOT name STREQUAL core)
    target_precompile_headers(${target} PRIVATE <Eigen/Core> <Eigen/Geometry> <fmt/format.h>
      <algorithm> <array> <cmath> <filesystem> <functional> <limits> <memory> <numbers> <optional> <span> <string> <utility> <vector>)
  endif()
  install(TARGETS ${target} EXPORT cloudbow-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/cloudbow)
endfunction()

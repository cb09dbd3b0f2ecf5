# Flags that every target of the project shares, and the two ways to declare one.

option(LAMELLA_WERROR "Treat warnings as errors" OFF)
set(LAMELLA_SANITIZE "" CACHE STRING "Sanitizers, as for -fsanitize=")

if(LAMELLA_CCACHE)
  find_program(LAMELLA_CCACHE_PROGRAM ccache)
  if(LAMELLA_CCACHE_PROGRAM)
    # A first build need not preprocess everything twice, and precompiled headers are cached too.
    set(CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_DEPEND=1 CCACHE_SLOPPINESS=pch_defines,time_macros
        "${LAMELLA_CCACHE_PROGRAM}")
  endif()
endif()

add_library(lamella_flags INTERFACE)
target_compile_features(lamella_flags INTERFACE cxx_std_20)
# -ffp-contract=off: the same doubles from every compiler and CPU (docs/decisions/0002-floating-point.md).
# -fno-semantic-interposition: nothing replaces our functions at run time, so they may be inlined though the code is
# position independent.
target_compile_options(lamella_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -ffp-contract=off
                                               -fno-semantic-interposition
                                               $<$<BOOL:${LAMELLA_WERROR}>:-Werror>)
if(LAMELLA_SANITIZE)
  target_compile_options(lamella_flags INTERFACE -fsanitize=${LAMELLA_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(lamella_flags INTERFACE -fsanitize=${LAMELLA_SANITIZE})
endif()

# The headers that most sources read, compiled once for all libraries. None of our own: a change to one of those must
# not rebuild everything. The preset dev does without, so that it finds a forgotten include.
set(LAMELLA_COMMON_HEADERS <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <limits> <map>
    <memory> <optional> <set> <span> <string> <string_view> <unordered_map> <utility> <variant> <vector>
    <Eigen/Core> <Eigen/Geometry>)

# lamella_precompile(lamella_common_headers <vector> ...) declares a target whose precompiled headers others reuse. They
# need the same flags and definitions; more definitions do no harm.
function(lamella_precompile name)
  file(CONFIGURE OUTPUT "${name}.cpp" CONTENT "")
  add_library(${name} OBJECT "${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp")
  target_link_libraries(${name} PRIVATE lamella_flags Eigen3::Eigen)
  target_precompile_headers(${name} PRIVATE ${ARGN})
endfunction()

# lamella_add_library(core SOURCES a.cpp ... HEADERS a.h ...) declares lamella::core.
# Headers are included by their path in the tree, in the tree and installed alike.
function(lamella_add_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;HEADERS" ${ARGN})
  add_library(lamella_${name} STATIC ${ARG_SOURCES})
  add_library(lamella::${name} ALIAS lamella_${name})
  target_sources(lamella_${name} PUBLIC FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}" FILES ${ARG_HEADERS})
  target_compile_features(lamella_${name} PUBLIC cxx_std_20)
  target_link_libraries(lamella_${name} PRIVATE $<BUILD_INTERFACE:lamella_flags>)
  set_target_properties(lamella_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_precompile_headers(lamella_${name} REUSE_FROM lamella_common_headers)
  set_property(GLOBAL APPEND PROPERTY LAMELLA_LIBRARIES lamella_${name})
endfunction()

# lamella_add_module(vdb_reader LOADED_BY materials SOURCES a.cpp ... LIBRARIES OpenVDB::openvdb) declares a shared object
# that a library loads when it needs it (core/shared_object.h). It may use the library's headers, but none of its functions.
set(CMAKE_BUILD_RPATH "${CMAKE_BINARY_DIR}/lib")
set(LAMELLA_MODULE_DIR "${CMAKE_INSTALL_LIBDIR}/lamella")
set(LAMELLA_INSTALLED_MODULE_DIR "${LAMELLA_MODULE_DIR}")
if(NOT IS_ABSOLUTE "${LAMELLA_MODULE_DIR}")
  string(PREPEND LAMELLA_INSTALLED_MODULE_DIR "$<INSTALL_PREFIX>/")
endif()
file(RELATIVE_PATH LAMELLA_MODULES_FROM_BIN "${CMAKE_INSTALL_FULL_BINDIR}" "${CMAKE_INSTALL_FULL_LIBDIR}/lamella")
function(lamella_add_module name)
  cmake_parse_arguments(ARG "" "LOADED_BY" "SOURCES;LIBRARIES" ${ARGN})
  add_library(lamella_${name} MODULE ${ARG_SOURCES})
  target_include_directories(lamella_${name} PRIVATE "${PROJECT_SOURCE_DIR}")
  target_link_libraries(lamella_${name} PRIVATE lamella_flags Eigen3::Eigen ${ARG_LIBRARIES})
  target_link_options(lamella_${name} PRIVATE LINKER:--no-undefined)
  set_target_properties(lamella_${name} PROPERTIES LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")
  add_dependencies(lamella_${ARG_LOADED_BY} lamella_${name})
  target_link_options(lamella_${ARG_LOADED_BY} INTERFACE
                      "$<INSTALL_INTERFACE:LINKER:-rpath,${LAMELLA_INSTALLED_MODULE_DIR}>")
  install(TARGETS lamella_${name} LIBRARY DESTINATION "${LAMELLA_MODULE_DIR}")
endfunction()

# lamella_add_test(trim_test SOURCES trim_test.cpp LIBRARIES lamella::model [LABELS corpus] [TIMEOUT 300])
# declares one GoogleTest program; each of its tests becomes a CTest.
function(lamella_add_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LIBRARIES;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LIBRARIES} lamella_flags lamella_test_flags GTest::gtest_main)
  target_precompile_headers(${name} REUSE_FROM lamella_test_headers)
  # What may take long starts first.
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60
                       PROPERTIES TIMEOUT ${ARG_TIMEOUT} COST ${ARG_TIMEOUT} LABELS "${ARG_LABELS}")
endfunction()

# Third parties, found once. Debian's packages are in scripts/packages.txt.

find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(tinyxml2 REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
find_package(ZLIB REQUIRED)
find_package(PNG REQUIRED)
find_package(LibXml2 REQUIRED)
find_package(HDF5 REQUIRED COMPONENTS C)
find_package(fmt REQUIRED)
find_package(OpenCASCADE REQUIRED)
pkg_check_modules(deflate REQUIRED IMPORTED_TARGET libdeflate)

# Debian ships OpenVDB's find module, not a config file.
list(APPEND CMAKE_MODULE_PATH "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB")
find_package(OpenVDB REQUIRED COMPONENTS openvdb)

if(LAMELLA_APPS)
  find_package(spdlog REQUIRED)
  find_package(nlohmann_json REQUIRED)
  find_path(CLI11_INCLUDE_DIR CLI/CLI.hpp REQUIRED)
endif()
if(LAMELLA_TESTS)
  find_package(GTest REQUIRED)
  include(GoogleTest)
endif()

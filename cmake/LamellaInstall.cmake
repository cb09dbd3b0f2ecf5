# find_package(Lamella) for other projects: targets lamella::core ... lamella::export.

include(CMakePackageConfigHelpers)

get_property(libraries GLOBAL PROPERTY LAMELLA_LIBRARIES)
install(TARGETS ${libraries} EXPORT LamellaTargets FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/lamella")
install(EXPORT LamellaTargets NAMESPACE lamella:: DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/Lamella")
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/LamellaConfig.cmake.in"
                              "${PROJECT_BINARY_DIR}/LamellaConfig.cmake"
                              INSTALL_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/Lamella")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/LamellaConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/LamellaConfig.cmake" "${PROJECT_BINARY_DIR}/LamellaConfigVersion.cmake"
        DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/Lamella")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/schemas/" DESTINATION "${CMAKE_INSTALL_DATADIR}/lamella/schemas"
        FILES_MATCHING PATTERN "*.xsd")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/datasets/machines/" DESTINATION "${CMAKE_INSTALL_DATADIR}/lamella/machines"
        FILES_MATCHING PATTERN "*.xml")
if(LAMELLA_APPS)
  install(TARGETS lamella_command RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
endif()

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/mjcf/ DESTINATION share/mjdiag/mjcf)
install(EXPORT mjdiagTargets NAMESPACE mjdiag:: DESTINATION lib/cmake/mjdiag)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/mjdiagConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_SOURCE_DIR}/cmake/mjdiagConfig.cmake
              ${PROJECT_SOURCE_DIR}/cmake/Dependencies.cmake
              ${PROJECT_BINARY_DIR}/mjdiagConfigVersion.cmake
        DESTINATION lib/cmake/mjdiag)

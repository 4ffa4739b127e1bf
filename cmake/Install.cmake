include(CMakePackageConfigHelpers)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/mjcf/ DESTINATION share/mjdiag/mjcf
        COMPONENT mjdiag-data)
install(CODE "set(mjdiag_source \"${PROJECT_SOURCE_DIR}\")" COMPONENT libmjdiag-dev)
install(SCRIPT ${PROJECT_SOURCE_DIR}/cmake/InstallHeaders.cmake
        COMPONENT libmjdiag-dev)
foreach(part IN LISTS mjdiag_all_parts)
  install(EXPORT mjdiag_${part} FILE ${part}Targets.cmake NAMESPACE mjdiag::
          DESTINATION lib/cmake/mjdiag COMPONENT libmjdiag-dev)
endforeach()
write_basic_package_version_file(${PROJECT_BINARY_DIR}/mjdiagConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_SOURCE_DIR}/cmake/mjdiagConfig.cmake
              ${PROJECT_SOURCE_DIR}/cmake/Dependencies.cmake
              ${PROJECT_SOURCE_DIR}/cmake/Parts.cmake
              ${PROJECT_BINARY_DIR}/mjdiagConfigVersion.cmake
        DESTINATION lib/cmake/mjdiag COMPONENT libmjdiag-dev)

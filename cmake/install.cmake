# Destinations of 'cmake --install', and the package that find_package(twinchute) finds.
include(CMakePackageConfigHelpers)

install(TARGETS twinchute)
install(DIRECTORY lib rom fullsim compare study serve DESTINATION ${TWINCHUTE_INCLUDE_DIR} COMPONENT development FILES_MATCHING PATTERN "*.hpp")
install(DIRECTORY data/ DESTINATION ${TWINCHUTE_DATA_DIR}
  PATTERN "*.sh" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
install(FILES README.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES LICENSE CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT notices)  # packages have them their own way
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs COMPONENT documentation PATTERN site EXCLUDE)

set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/twinchute)
install(EXPORT twinchute NAMESPACE twinchute:: FILE twinchuteTargets.cmake DESTINATION ${config_dir} COMPONENT development)
configure_package_config_file(cmake/twinchuteConfig.cmake.in ${PROJECT_BINARY_DIR}/twinchuteConfig.cmake
  INSTALL_DESTINATION ${config_dir} PATH_VARS TWINCHUTE_DATA_DIR
  NO_CHECK_REQUIRED_COMPONENTS_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/twinchuteConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/twinchuteConfig.cmake ${PROJECT_BINARY_DIR}/twinchuteConfigVersion.cmake
  DESTINATION ${config_dir} COMPONENT development)

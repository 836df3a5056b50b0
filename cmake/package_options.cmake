# What the build itself does for packages: the same bytes from any directory and at any time.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME program)
if(NOT TWINCHUTE_PACKAGE)
  return()
endif()

set(CMAKE_BUILD_WITH_INSTALL_RPATH ON)  # none: one that is removed leaves padding behind
add_compile_options(-ffile-prefix-map=${PROJECT_SOURCE_DIR}=. -ffile-prefix-map=${PROJECT_BINARY_DIR}=build)

# The time of every date in a package: of the last commit; in an archive, which has none, of its files.
set(TWINCHUTE_SOURCE_DATE "$ENV{SOURCE_DATE_EPOCH}")
find_program(GIT git)
mark_as_advanced(GIT)
if(NOT TWINCHUTE_SOURCE_DATE AND GIT AND EXISTS ${PROJECT_SOURCE_DIR}/.git)
  execute_process(COMMAND ${GIT} -C ${PROJECT_SOURCE_DIR} log -1 --format=%ct
    OUTPUT_VARIABLE TWINCHUTE_SOURCE_DATE OUTPUT_STRIP_TRAILING_WHITESPACE)
  execute_process(COMMAND ${GIT} -C ${PROJECT_SOURCE_DIR} rev-parse --path-format=absolute --git-path logs/HEAD
    OUTPUT_VARIABLE commits OUTPUT_STRIP_TRAILING_WHITESPACE)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${commits})
endif()
if(NOT TWINCHUTE_SOURCE_DATE)
  file(TIMESTAMP ${PROJECT_SOURCE_DIR}/CMakeLists.txt TWINCHUTE_SOURCE_DATE %s UTC)
endif()

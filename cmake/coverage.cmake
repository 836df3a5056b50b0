# The target 'coverage': runs the default tests in a build that counts lines, and prints what they reached,
# module by module.
if(NOT TWINCHUTE_COVERAGE)
  return()
endif()
find_program(GCOVR gcovr)
add_custom_target(coverage
  COMMAND ${CMAKE_COMMAND} -D BUILD=${PROJECT_BINARY_DIR} -D SOURCE=${PROJECT_SOURCE_DIR} -D "GCOVR=${GCOVR}"
    -P ${PROJECT_SOURCE_DIR}/cmake/run_coverage.cmake
  USES_TERMINAL VERBATIM)

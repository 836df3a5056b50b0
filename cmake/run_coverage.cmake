# Runs the default tests, then prints the lines of each module that they reached; run by the target 'coverage'.
if(NOT GCOVR)
  message(FATAL_ERROR "gcovr was not found (Debian: apt-get install gcovr), install it and configure again")
endif()
file(GLOB_RECURSE counts ${BUILD}/*.gcda)
if(counts)
  file(REMOVE ${counts})
endif()
# The tests of the installed package are compiled without counters, by design.
execute_process(COMMAND ${CMAKE_CTEST_COMMAND} --test-dir ${BUILD} -LE "long|architecture" -j2 --timeout 1800 --output-on-failure
  RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "tests failed; no figure is drawn from them")
endif()
# Branches for exceptions stand at every call that could throw; they would hide the others.
set(counted ${BUILD}/coverage.json)
execute_process(
  COMMAND ${GCOVR} --root ${SOURCE} --filter "${SOURCE}/(lib|rom|fullsim|compare|study|serve)/" --exclude-unreachable-branches
    --exclude-throw-branches --json ${counted} ${BUILD}
  ERROR_VARIABLE error RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "gcovr failed:\n${error}")
endif()

function(pad text width)
  string(LENGTH "${text}" length)
  math(EXPR blanks "${width} - ${length}")
  string(REPEAT " " ${blanks} blanks)
  set(padded "${text}${blanks}" PARENT_SCOPE)
endfunction()

foreach(module lib/math lib/record lib/models lib/scene lib/solve lib/cli lib rom fullsim compare study serve all)
  set(filter "${SOURCE}/${module}/")
  if(module STREQUAL "all")
    set(filter "${SOURCE}/")
  endif()
  execute_process(COMMAND ${GCOVR} --root ${SOURCE} --filter "${filter}" --add-tracefile ${counted} --print-summary
    OUTPUT_VARIABLE text ERROR_VARIABLE error RESULT_VARIABLE failed)
  if(failed OR NOT text MATCHES "lines: ([0-9.]+%) \\([0-9]+ out of ([0-9]+)\\)")
    message(FATAL_ERROR "gcovr failed for ${module}:\n${error}${text}")
  endif()
  pad("${module}" 12)
  set(line "${padded}")
  pad("${CMAKE_MATCH_1} of ${CMAKE_MATCH_2} lines" 22)
  string(APPEND line "${padded}")
  if(NOT text MATCHES "branches: ([0-9.]+%) \\([0-9]+ out of ([0-9]+)\\)")
    message(FATAL_ERROR "gcovr counted no branches for ${module}:\n${error}${text}")
  endif()
  message("${line}${CMAKE_MATCH_1} of ${CMAKE_MATCH_2} branches")
endforeach()

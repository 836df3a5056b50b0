# Installs the build into an empty prefix and uses it from outside the tree.
# WHAT=program: builds the small project of docs/guide/library.md, runs it and the installed program.
# WHAT=headers: compiles every installed header alone.
function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${what} failed (${code}):\n${out}")
  endif()
  set(output "${out}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE "${WORK}")
run("installing" ${CMAKE_COMMAND} --install "${BUILD}" --prefix "${WORK}/prefix")
if(WHAT STREQUAL "program")
  set(project "${SOURCE}/tests/architecture/consumer")
else()
  set(project "${SOURCE}/tests/architecture/headers")
endif()
run("configuring ${project}" ${CMAKE_COMMAND} -S "${project}" -B "${WORK}/build" -G "${GENERATOR}"
  "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}" "-DCMAKE_CXX_FLAGS=${FLAGS}"
  "-DCMAKE_PREFIX_PATH=${WORK}/prefix")
run("building ${project}" ${CMAKE_COMMAND} --build "${WORK}/build" --parallel 2)

if(WHAT STREQUAL "program")
  run("the consumer" "${WORK}/build/consumer")
  if(NOT output MATCHES "peak force [1-9][0-9]+ N")
    message(FATAL_ERROR "the consumer printed no peak force:\n${output}")
  endif()
  run("the installed program" "${WORK}/prefix/bin/twinchute" --version)
  # The page shows the very files that were built here.
  file(READ "${SOURCE}/docs/guide/library.md" page)
  foreach(file CMakeLists.txt main.cpp)
    file(READ "${project}/${file}" text)
    string(FIND "${page}" "\n${text}```" at)
    if(at EQUAL -1)
      message(FATAL_ERROR "docs/guide/library.md does not show ${project}/${file} as it is")
    endif()
  endforeach()
endif()
file(REMOVE_RECURSE "${WORK}")

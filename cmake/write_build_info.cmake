# Writes OUTPUT, a C++ file, from VERSION, COMPILER, FLAGS and the commit of SOURCE_DIR; run by the build.

set(commit "unknown")  # a tarball, or no git on this machine
find_program(GIT git)
if(GIT)
  execute_process(COMMAND ${GIT} -C ${SOURCE_DIR} rev-parse --show-toplevel
    OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  # A tarball unpacked inside somebody else's repository has no commit of its own.
  if(NOT failed)
    file(REAL_PATH "${top}" top)
    file(REAL_PATH "${SOURCE_DIR}" source)
    if(top STREQUAL source)
      execute_process(COMMAND ${GIT} -C ${SOURCE_DIR} describe --always --dirty --abbrev=12 --exclude=*
        OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
      if(NOT failed)
        set(commit "${described}")
      endif()
    endif()
  endif()
endif()

# Warnings do not change the generated code.
string(REGEX REPLACE "(^| )-W[^ ]*" " " FLAGS "${FLAGS}")
string(REGEX REPLACE " +" " " FLAGS "${FLAGS}")
string(STRIP "${FLAGS}" FLAGS)

set(text "// Written by cmake/write_build_info.cmake at build time.
#include \"lib/record/build_info.hpp\"

namespace twinchute {

BuildInfo build_info() {
    return {R\"~(${VERSION})~\", R\"~(${commit})~\", R\"~(${COMPILER})~\", R\"~(${FLAGS})~\"};
}

}  // namespace twinchute
")
set(old "")
if(EXISTS "${OUTPUT}")
  file(READ "${OUTPUT}" old)
endif()
if(NOT old STREQUAL text)
  file(WRITE "${OUTPUT}" "${text}")
endif()

# One interface target that every module links: language, warnings, floating-point rules. It stays in this
# build; users of the installed libraries have their own.
add_library(twinchute_options INTERFACE)
# Includes start at the repository root, so that each names its module.
target_include_directories(twinchute_options INTERFACE ${PROJECT_SOURCE_DIR})
# No contraction: the same input gives the same bits on every instruction set.
target_compile_options(twinchute_options INTERFACE
  -ffp-contract=off -fno-math-errno
  -Wno-psabi -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wpedantic
  # GCC 12 sees overlaps in std::string that are not there (GCC bug 105651).
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>
  # In a batch, local names meet the constants of other sources, of which clang warns more often.
  $<$<AND:$<CXX_COMPILER_ID:Clang>,$<BOOL:${CMAKE_UNITY_BUILD}>>:-Wno-shadow>
  $<$<BOOL:${TWINCHUTE_WERROR}>:-Werror>
  $<$<BOOL:${TWINCHUTE_ARCH}>:-march=${TWINCHUTE_ARCH}>)

if(TWINCHUTE_COVERAGE)
  target_compile_options(twinchute_options INTERFACE --coverage -fprofile-update=atomic)
  target_link_options(twinchute_options INTERFACE --coverage)
endif()

find_program(CCACHE ccache)
mark_as_advanced(CCACHE)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

# twinchute_cold(TARGET): no run spends time in it (reading, writing, reports). A release then optimises it less, which
# takes a third off its compilation; without contraction the bits stay the same.
function(twinchute_cold target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# twinchute_library(NAME [COLD] SOURCES ... [PUBLIC ...] [PRIVATE ...]): a static library, exported as twinchute::NAME.
function(twinchute_library name)
  cmake_parse_arguments(ARG "COLD" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(twinchute_${name} STATIC ${ARG_SOURCES})
  add_library(twinchute::${name} ALIAS twinchute_${name})
  # Hidden: position-independent code that may take its functions to be its own costs nothing.
  set_target_properties(twinchute_${name} PROPERTIES EXPORT_NAME ${name} CXX_VISIBILITY_PRESET hidden)
  target_link_libraries(twinchute_${name} PUBLIC $<BUILD_INTERFACE:twinchute_options> ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  target_compile_features(twinchute_${name} PUBLIC cxx_std_20)
  if(ARG_COLD)
    twinchute_cold(twinchute_${name})
  endif()
  target_include_directories(twinchute_${name} INTERFACE $<INSTALL_INTERFACE:${TWINCHUTE_INCLUDE_DIR}>)
  install(TARGETS twinchute_${name} EXPORT twinchute COMPONENT development)
endfunction()

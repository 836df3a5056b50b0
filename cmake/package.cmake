# Debian packages, one a component of the installation: cmake --preset package, build, cpack --preset package.
if(NOT TWINCHUTE_PACKAGE)
  return()
endif()
if(NOT CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  message(FATAL_ERROR "TWINCHUTE_PACKAGE needs CMAKE_INSTALL_PREFIX=/usr (the program looks for its data there): use the preset 'package'")
endif()
set(TWINCHUTE_MAINTAINER "The twinchute developers <maintainers@twinchute.invalid>" CACHE STRING
  "Name and address that packages give as their maintainer's")
set(TWINCHUTE_DEBIAN_REVISION 1 CACHE STRING "Which packaging of this version it is")
set(version ${PROJECT_VERSION}-${TWINCHUTE_DEBIAN_REVISION})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME twinchute)
set(CPACK_PACKAGE_CONTACT "${TWINCHUTE_MAINTAINER}")
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
# Read by cpack. It gives its archives the modes that the umask leaves.
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_BINARY_DIR}/cpack_environment.cmake)
file(WRITE ${CPACK_PROJECT_CONFIG_FILE} "set(ENV{SOURCE_DATE_EPOCH} ${TWINCHUTE_SOURCE_DATE})
execute_process(COMMAND sh -c umask OUTPUT_VARIABLE umask OUTPUT_STRIP_TRAILING_WHITESPACE)
if(NOT umask MATCHES \"^0*22$\")
  message(FATAL_ERROR \"packages would have other modes (the umask is \${umask}): run 'umask 022', then cpack again\")
endif()
")
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE ${TWINCHUTE_DEBIAN_REVISION})
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
find_program(GZIP gzip REQUIRED)

set(ENV{SOURCE_DATE_EPOCH} ${TWINCHUTE_SOURCE_DATE})
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
set(files ${PROJECT_BINARY_DIR}/package_files)
configure_file(cmake/debian/changelog.in ${files}/changelog.Debian @ONLY)
file(READ NOTICE notice)
string(REGEX REPLACE "\n(\n|$)" "\n.\n" notice "${notice}")
string(REPLACE "\n" "\n " notice "${notice}")
configure_file(cmake/debian/copyright.in ${files}/copyright @ONLY)
configure_file(CHANGELOG.md ${files}/changelog COPYONLY)
execute_process(COMMAND ${GZIP} -9nf ${files}/changelog.Debian ${files}/changelog COMMAND_ERROR_IS_FATAL ANY)

# twinchute_debian(COMPONENT NAME [ALL] SECTION ... SUMMARY ... [DEPENDS ...] [SUGGESTS ...] TEXT ...): a package; ALL for any
# architecture.
function(twinchute_debian component name)
  cmake_parse_arguments(ARG "ALL" "SECTION;SUMMARY;DEPENDS;SUGGESTS;TEXT" "" ${ARGN})
  string(TOUPPER ${component} key)
  set(prefix CPACK_DEBIAN_${key})
  set(${prefix}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(${prefix}_PACKAGE_SECTION ${ARG_SECTION} PARENT_SCOPE)
  set(${prefix}_PACKAGE_DEPENDS "${ARG_DEPENDS}" PARENT_SCOPE)
  set(${prefix}_PACKAGE_SUGGESTS "${ARG_SUGGESTS}" PARENT_SCOPE)
  set(${prefix}_DESCRIPTION "${ARG_SUMMARY}\n${ARG_TEXT}" PARENT_SCOPE)
  if(ARG_ALL)
    set(${prefix}_PACKAGE_ARCHITECTURE all PARENT_SCOPE)
    set(${prefix}_PACKAGE_SHLIBDEPS OFF PARENT_SCOPE)
  endif()
  install(FILES ${files}/copyright ${files}/changelog.gz ${files}/changelog.Debian.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} ${component} PARENT_SCOPE)
endfunction()

# twinchute_bill(COMPONENT NAME TARGET): what the binary was made of, as the package is made.
find_package(Python3 COMPONENTS Interpreter)
if(NOT Python3_FOUND)
  message(STATUS "No bill of materials in packages: it needs Python 3 (Debian: python3)")
endif()
function(twinchute_bill component name target)
  if(Python3_FOUND)
    set(bill ${files}/${name}.cdx.json)
    install(CODE "execute_process(COMMAND \"${Python3_EXECUTABLE}\" \"${PROJECT_SOURCE_DIR}/cmake/write_sbom.py\"
      \"${PROJECT_BINARY_DIR}\" \"$<TARGET_FILE:${target}>\" ${name} ${PROJECT_VERSION} \"${bill}\" COMMAND_ERROR_IS_FATAL ANY)"
      COMPONENT ${component})
    install(FILES ${bill} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
  endif()
endfunction()

set(about "A parachute's opening at two fidelities: as a rigid trajectory with
filling time and drag-area law, and as explicit finite elements of fabric and
lines.")
set(CPACK_COMPONENTS_ALL "")
twinchute_debian(program twinchute SECTION science
  SUMMARY "parachute openings at two fidelities, and the gap between them"
  SUGGESTS "twinchute-doc, twinchute-openturns (= ${version}), twinchute-serve (= ${version}), python3-twinchute (= ${version})"
  TEXT "${about} One scene file runs both ways; the report says how far apart the
answers are, and why.

This package has the program with its manual pages and completions, scenes,
canopies, materials and reference numbers.")
twinchute_bill(program twinchute twinchute)
twinchute_debian(development libtwinchute-dev SECTION libdevel
  SUMMARY "parachute openings at two fidelities (static libraries and headers)"
  DEPENDS "twinchute (= ${version}), libboost-program-options-dev, libeigen3-dev, libfmt-dev, libgsl-dev, libhdf5-dev, libhpdf-dev, libhwy-dev, libminizip-dev, libpugixml-dev, libsundials-dev, libtomlplusplus-dev, libudunits2-dev, nlohmann-json3-dev, pkg-config, zlib1g-dev"
  TEXT "${about}

This package has static libraries, headers and what CMake's
find_package(twinchute) finds.")
twinchute_debian(documentation twinchute-doc ALL SECTION doc
  SUMMARY "parachute openings at two fidelities (documentation)"
  TEXT "${about}

This package has guides, theory, verification and validation.")
if(TWINCHUTE_PYTHON)
  math(EXPR next "${Python_VERSION_MINOR} + 1")
  twinchute_debian(python python3-twinchute SECTION python
    SUMMARY "parachute openings at two fidelities (Python 3)"
    DEPENDS "twinchute (= ${version}), python3 (>= 3.${Python_VERSION_MINOR}~), python3 (<< 3.${next}), python3-numpy"
    SUGGESTS "python3-pandas"
    TEXT "${about}

This package has the Python module, whose results are numpy arrays.")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/debian/python/postinst
    ${PROJECT_SOURCE_DIR}/cmake/debian/python/prerm)
  twinchute_bill(python python3-twinchute twinchute_python)
endif()
if(TARGET twinchute_openturns)
  twinchute_debian(rare twinchute-openturns SECTION science
    SUMMARY "parachute openings at two fidelities (rare events)"
    DEPENDS "twinchute (= ${version})"
    TEXT "${about}

This package has what campaigns need for probabilities too small to count:
subset simulation by OpenTURNS.")
  twinchute_bill(rare twinchute-openturns twinchute_openturns)
endif()
if(TARGET twinchute_http)
  twinchute_debian(serve twinchute-serve SECTION science
    SUMMARY "parachute openings at two fidelities (a local page)"
    DEPENDS "twinchute (= ${version})"
    TEXT "${about}

This package has what `twinchute serve` speaks HTTP with: a page on this
machine to change a scene in and to see its curves at once.")
  twinchute_bill(serve twinchute-serve twinchute_http)
endif()
include(CPack)

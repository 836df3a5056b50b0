# The target 'site': README and docs/ as pages with a search that needs no network, the keys of a scene as the program
# lists them, and the C++ interface.
find_program(DOXYGEN doxygen)
mark_as_advanced(DOXYGEN)
set(sphinx "")
foreach(candidate python3 /usr/bin/python3)  # see cmake/python.cmake
  execute_process(COMMAND ${candidate} -c "import sphinx, myst_parser, furo" RESULT_VARIABLE code ERROR_QUIET)
  if(code EQUAL 0)
    set(sphinx ${candidate} -m sphinx)
  endif()
endforeach()
if(NOT sphinx OR NOT DOXYGEN OR CMAKE_CROSSCOMPILING)
  message(STATUS "No target `site`: it needs Sphinx with MyST and Furo, and Doxygen (Debian: python3-sphinx python3-myst-parser furo doxygen)")
  return()
endif()

set(TWINCHUTE_SITE ${PROJECT_BINARY_DIR}/site)
set(api ${TWINCHUTE_SITE}/api)
configure_file(docs/site/Doxyfile.in Doxyfile @ONLY)
set(all "")
if(TWINCHUTE_PACKAGE)
  set(all ALL)
  set(date SOURCE_DATE_EPOCH=${TWINCHUTE_SOURCE_DATE})
  install(DIRECTORY ${TWINCHUTE_SITE}/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/html COMPONENT documentation)
endif()
add_custom_target(site ${all}
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${TWINCHUTE_SITE}
  COMMAND ${CMAKE_COMMAND} -E env ${date} TWINCHUTE=$<TARGET_FILE:twinchute>
    ${sphinx} -q -W --keep-going -b html -c docs/site -d ${PROJECT_BINARY_DIR}/doctrees . ${TWINCHUTE_SITE}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${api}
  COMMAND ${DOXYGEN} ${PROJECT_BINARY_DIR}/Doxyfile
  WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
  COMMENT "Making the site"
  VERBATIM)
add_dependencies(site twinchute)

# Style and scripts of the HTML report, and two libraries of the system, as bytes in the program: a report is one
# file that needs neither a network nor an installation.
find_file(DYGRAPHS_JS dygraph.min.js
  PATHS /usr/share/javascript/dygraphs /usr/share/javascript/dygraphs/dist /usr/local/share/javascript/dygraphs
  DOC "dygraphs, minified: the plots of the HTML report")
find_file(THREE_JS three.min.js
  PATHS /usr/share/javascript/three /usr/share/javascript/three/build /usr/local/share/javascript/three
  DOC "three.js, minified: the canopy in the HTML report")
find_file(ORBIT_CONTROLS_JS OrbitControls.js
  PATHS /usr/share/javascript/three/examples/js/controls /usr/local/share/javascript/three/examples/js/controls
  DOC "three.js: the camera of the HTML report")
foreach(wanted "DYGRAPHS_JS;dygraphs;libjs-dygraphs" "THREE_JS;three.js;libjs-three" "ORBIT_CONTROLS_JS;three.js;libjs-three")
  list(GET wanted 0 variable)
  list(GET wanted 1 name)
  list(GET wanted 2 package)
  if(NOT ${variable})
    message(FATAL_ERROR "The HTML report needs ${name}, which was not found (Debian: apt-get install ${package}).\n"
      "Elsewhere: cmake -D${variable}=/path/to/the/file.js")
  endif()
  mark_as_advanced(${variable})
endforeach()

# twinchute_embed(TARGET HEADER FILE...): adds page_files.cpp with the bytes of these files. HEADER declares it, and its first
# folder names the namespace.
function(twinchute_embed target header)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/page_files.cpp)
  string(REGEX REPLACE "/.*" "" module ${header})
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -D "FILES=${ARGN}" -D HEADER=${header} -D MODULE=${module} -D OUTPUT=${output}
      -P ${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake
    DEPENDS ${ARGN} ${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake
    COMMENT "Embedding the files of ${header}"
    VERBATIM)
  target_sources(${target} PRIVATE ${output})
endfunction()

# twinchute_page(TARGET): those of report pages, which compare/report/page_files.hpp declares.
function(twinchute_page target)
  set(page ${PROJECT_SOURCE_DIR}/compare/report/page)
  file(GLOB own CONFIGURE_DEPENDS ${page}/*.css ${page}/*.js)
  twinchute_embed(${target} compare/report/page_files.hpp
    ${own} ${PROJECT_SOURCE_DIR}/NOTICE ${PROJECT_SOURCE_DIR}/docs/glossary.md ${DYGRAPHS_JS} ${THREE_JS} ${ORBIT_CONTROLS_JS})
endfunction()

# Manual pages and completions: the program writes them from its own tables, so that they say what it does.
if(CMAKE_CROSSCOMPILING)
  message(STATUS "No manual pages and completions: the program that writes them does not run here")
  return()
endif()

set(manuals ${PROJECT_BINARY_DIR}/manuals)
find_program(GZIP gzip)
mark_as_advanced(GZIP)
if(TWINCHUTE_SOURCE_DATE)
  set(date SOURCE_DATE_EPOCH=${TWINCHUTE_SOURCE_DATE})
endif()
add_custom_command(OUTPUT ${manuals}/written
  COMMAND ${CMAKE_COMMAND} -E env ${date} ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:twinchute> -DDIRECTORY=${manuals} -DGZIP=${GZIP}
    -P ${PROJECT_SOURCE_DIR}/cmake/write_manuals.cmake
  DEPENDS twinchute ${PROJECT_SOURCE_DIR}/cmake/write_manuals.cmake
  COMMENT "Writing manual pages and completions"
  VERBATIM)
add_custom_target(manuals ALL DEPENDS ${manuals}/written)

install(DIRECTORY ${manuals}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR})
install(FILES ${manuals}/completions/twinchute.bash RENAME twinchute
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions OPTIONAL)
install(FILES ${manuals}/completions/twinchute.zsh RENAME _twinchute
  DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions OPTIONAL)
install(FILES ${manuals}/completions/twinchute.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
  OPTIONAL)

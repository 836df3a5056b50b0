# Runs the program for its pages and scripts. Pages are packed as Debian wants them: at the best level, without time.
file(REMOVE_RECURSE ${DIRECTORY})
file(MAKE_DIRECTORY ${DIRECTORY}/completions)
execute_process(COMMAND ${PROGRAM} manual --out ${DIRECTORY}/man1 COMMAND_ERROR_IS_FATAL ANY)
foreach(shell bash zsh fish)
  execute_process(COMMAND ${PROGRAM} completion ${shell} OUTPUT_FILE ${DIRECTORY}/completions/twinchute.${shell}
    COMMAND_ERROR_IS_FATAL ANY)
endforeach()
if(GZIP)
  file(GLOB pages ${DIRECTORY}/man1/*.1)
  execute_process(COMMAND ${GZIP} -9nf ${pages} COMMAND_ERROR_IS_FATAL ANY)
endif()
file(TOUCH ${DIRECTORY}/written)

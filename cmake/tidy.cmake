# The target 'tidy': clang-tidy over the whole tree, with .clang-tidy. .ci/run checks changed sources the same way.
find_program(BASH bash)
mark_as_advanced(BASH)
if(BASH)
  add_custom_target(tidy
    COMMAND ${BASH} ${PROJECT_SOURCE_DIR}/tests/architecture/tidy.sh ${PROJECT_BINARY_DIR} all
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} USES_TERMINAL VERBATIM
    COMMENT "clang-tidy over the whole tree")
  # It reads the generated sources as well.
  add_dependencies(tidy twinchute_record_build_info)
endif()

# Source, compiler and flags of a binary. The commit is looked up at every build,
# not at configure time, and the generated file is touched only when something in it has changed.
function(twinchute_build_info target)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/build_info.cpp)
  string(TOUPPER "${CMAKE_BUILD_TYPE}" config)
  string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
  add_custom_target(${target}_build_info
    COMMAND ${CMAKE_COMMAND}
      -DSOURCE_DIR=${PROJECT_SOURCE_DIR} -DOUTPUT=${output}
      -DVERSION=${PROJECT_VERSION}
      "-DCOMPILER=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}"
      "-DFLAGS=${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${type}} $<JOIN:$<TARGET_PROPERTY:twinchute_options,INTERFACE_COMPILE_OPTIONS>, >"
      -P ${PROJECT_SOURCE_DIR}/cmake/write_build_info.cmake
    BYPRODUCTS ${output}
    COMMENT "Looking up the commit"
    VERBATIM)
  add_dependencies(${target} ${target}_build_info)
  target_sources(${target} PRIVATE ${output})
endfunction()

# SUNDIALS: the libraries of ARKODE and CVODE contain the serial vectors, dense matrices and solvers that are used, which
# are libraries of their own besides.
set(TWINCHUTE_SUNDIALS "" CACHE PATH "Where ./bootstrap has unpacked Debian's libsundials-dev; empty: it is installed")
if(NOT TWINCHUTE_SUNDIALS)
  find_package(SUNDIALS 6 REQUIRED COMPONENTS arkode cvode)
  return()
endif()

# Installed, it brings all that SUNDIALS can work with, MPI, PETSc and Trilinos included, and its CMake package insists on
# that. Its headers name no such thing: they and the two libraries are enough for the program.
foreach(name arkode cvode)
  file(GLOB link ${TWINCHUTE_SUNDIALS}/usr/lib/*/libsundials_${name}.so)
  if(link)
    file(READ_SYMLINK ${link} soname)
    find_library(SUNDIALS_${name} ${soname} REQUIRED)
    mark_as_advanced(SUNDIALS_${name})
  else()
    message(FATAL_ERROR "${TWINCHUTE_SUNDIALS} holds no libsundials_${name}: remove it, and run ./bootstrap again")
  endif()
  add_library(SUNDIALS::${name} SHARED IMPORTED)
  set_target_properties(SUNDIALS::${name} PROPERTIES IMPORTED_LOCATION ${SUNDIALS_${name}}
    INTERFACE_INCLUDE_DIRECTORIES ${TWINCHUTE_SUNDIALS}/usr/include)
endforeach()

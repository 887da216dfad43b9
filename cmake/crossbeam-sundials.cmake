# Defines crossbeam::sundials, which crossbeam/adapters/sundials.hpp needs, where SUNDIALS is
# installed; sets crossbeam_sundials_FOUND. Part of the package: find_package(crossbeam COMPONENTS
# sundials).
find_package(SUNDIALS 6.4 CONFIG QUIET COMPONENTS
  arkode cvode ida kinsol nvecserial sunlinsoldense sunlinsolklu sunmatrixdense sunmatrixsparse
  sunnonlinsolfixedpoint)
# Versions 6 and 7; what 7 calls deprecated will be gone in 8.
if(SUNDIALS_FOUND AND SUNDIALS_VERSION VERSION_GREATER_EQUAL 8)
  message(STATUS "SUNDIALS ${SUNDIALS_VERSION} is not supported by crossbeam: 6.4 to 7.x is")
  set(SUNDIALS_FOUND FALSE)
endif()
set(crossbeam_sundials_FOUND "${SUNDIALS_FOUND}")
if(SUNDIALS_FOUND AND NOT TARGET crossbeam::sundials)
  add_library(crossbeam::sundials INTERFACE IMPORTED)
  target_link_libraries(crossbeam::sundials INTERFACE crossbeam::crossbeam
    SUNDIALS::arkode SUNDIALS::cvode SUNDIALS::ida SUNDIALS::kinsol SUNDIALS::nvecserial
    SUNDIALS::sunlinsolklu SUNDIALS::sunmatrixsparse SUNDIALS::sunnonlinsolfixedpoint)
endif()

# Fails when a header includes against the direction of the layers (CONTRIBUTING.md):
#   cmake -DROOT=<repository> -P cmake/layering.cmake
# A header may include its own folder and the folders left of it in `layers`; a folder's detail/ is
# for that folder alone; the umbrella may include everything up to dynamics; outside adapters no
# third party but Eigen.
cmake_minimum_required(VERSION 3.24)

set(layers base kinematics cell law element mesh contact dynamics adapters verification)
set(faults "")

file(GLOB_RECURSE headers RELATIVE "${ROOT}/include" "${ROOT}/include/crossbeam/*.hpp")
if(NOT headers)
  message(FATAL_ERROR "no headers under ${ROOT}/include/crossbeam")
endif()

foreach(header IN LISTS headers)
  if(header MATCHES "^crossbeam/([^/]+)/")
    set(own_folder "${CMAKE_MATCH_1}")
    list(FIND layers "${own_folder}" own_layer)
    if(own_layer EQUAL -1)
      string(APPEND faults "  ${header}: folder ${own_folder} is not one of the layers\n")
      continue()
    endif()
  else()
    set(own_folder "")
    list(FIND layers dynamics own_layer)
  endif()

  file(STRINGS "${ROOT}/include/${header}" includes REGEX "^[ \t]*#[ \t]*include")
  foreach(include IN LISTS includes)
    if(include MATCHES "[<\"]crossbeam/([^/\">]+)/([^\">]*)")
      set(folder "${CMAKE_MATCH_1}")
      set(rest "${CMAKE_MATCH_2}")
      list(FIND layers "${folder}" layer)
      if(layer EQUAL -1)
        string(APPEND faults "  ${header}: ${include}: unknown folder\n")
      elseif(layer GREATER own_layer)
        string(APPEND faults "  ${header}: ${include}: against the direction of the layers\n")
      elseif(rest MATCHES "^detail/" AND NOT folder STREQUAL own_folder)
        string(APPEND faults "  ${header}: ${include}: detail of another folder\n")
      endif()
    elseif(include MATCHES "[<\"]crossbeam/")
      string(APPEND faults "  ${header}: ${include}: the umbrella is for users only\n")
    elseif(include MATCHES "\"")
      string(APPEND faults "  ${header}: ${include}: spell it \"crossbeam/...\"\n")
    elseif(include MATCHES "<([^/>]+)/" AND NOT CMAKE_MATCH_1 STREQUAL "Eigen"
           AND NOT own_folder STREQUAL "adapters")
      string(APPEND faults "  ${header}: ${include}: third party outside adapters\n")
    endif()
  endforeach()
endforeach()

list(LENGTH headers count)
if(faults)
  list(JOIN layers " <- " order)
  message(FATAL_ERROR "layering of include/crossbeam (${order}):\n${faults}")
endif()
message(STATUS "layering: ${count} headers follow the direction of the layers")

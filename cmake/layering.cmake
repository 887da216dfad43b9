# Fails when a header includes against the direction of the layers (CONTRIBUTING.md):
#   cmake -DROOT=<repository> -P cmake/layering.cmake
# A header may include its own folder and the folders of the layers before its own; folders that
# share a layer do not know each other. A folder's detail/ is for that folder alone; the umbrella
# may include everything up to simulation; outside adapters Eigen is the only third party.
cmake_minimum_required(VERSION 3.24)

# One layer a word; folders of the same layer are joined by '|'.
set(layers base kinematics|cell|tools law element mesh model sweep|contact|dynamics simulation adapters
  verification)
set(faults "")

# layer_of(<folder> <result>): its place in `layers`, or -1
function(layer_of folder result)
  set(place 0)
  foreach(layer IN LISTS layers)
    string(REPLACE "|" ";" folders "${layer}")
    if(folder IN_LIST folders)
      set(${result} ${place} PARENT_SCOPE)
      return()
    endif()
    math(EXPR place "${place} + 1")
  endforeach()
  set(${result} -1 PARENT_SCOPE)
endfunction()

file(GLOB_RECURSE headers RELATIVE "${ROOT}/include" "${ROOT}/include/crossbeam/*.hpp")
if(NOT headers)
  message(FATAL_ERROR "no headers under ${ROOT}/include/crossbeam")
endif()

foreach(header IN LISTS headers)
  if(header MATCHES "^crossbeam/([^/]+)/")
    set(own_folder "${CMAKE_MATCH_1}")
    layer_of("${own_folder}" own_layer)
    if(own_layer EQUAL -1)
      string(APPEND faults "  ${header}: folder ${own_folder} is not one of the layers\n")
      continue()
    endif()
  else()
    set(own_folder "")
    layer_of(simulation own_layer)
  endif()

  file(STRINGS "${ROOT}/include/${header}" includes REGEX "^[ \t]*#[ \t]*include")
  foreach(include IN LISTS includes)
    if(include MATCHES "[<\"]crossbeam/([^/\">]+)/([^\">]*)")
      set(folder "${CMAKE_MATCH_1}")
      set(rest "${CMAKE_MATCH_2}")
      layer_of("${folder}" layer)
      if(layer EQUAL -1)
        string(APPEND faults "  ${header}: ${include}: unknown folder\n")
      elseif(layer GREATER own_layer)
        string(APPEND faults "  ${header}: ${include}: against the direction of the layers\n")
      elseif(own_folder AND layer EQUAL own_layer AND NOT folder STREQUAL own_folder)
        string(APPEND faults "  ${header}: ${include}: beside it in the same layer\n")
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

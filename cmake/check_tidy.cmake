# Fails when clang-tidy 16 objects to a header (.clang-tidy says to what):
#   cmake -DROOT=<repository> "-DEIGEN=<include folder>;..." -P cmake/check_tidy.cmake
# It looks at the umbrella: all headers but the adapters, and of a template what the headers themselves
# instantiate. Without version 16 the check is skipped and says so.
cmake_minimum_required(VERSION 3.24)

find_program(clang_tidy clang-tidy-16)
if(NOT clang_tidy)
  message(STATUS "check_tidy: skipped, no clang-tidy-16 (Debian: clang-tidy-16)")
  return()
endif()

set(flags -std=c++20 "-I${ROOT}/include")
foreach(folder IN LISTS EIGEN)
  list(APPEND flags -isystem "${folder}")
endforeach()
execute_process(
  COMMAND "${clang_tidy}" "--config-file=${ROOT}/.clang-tidy" --quiet --warnings-as-errors=*
    "${CMAKE_CURRENT_LIST_DIR}/check_tidy.cpp" -- ${flags}
  RESULT_VARIABLE status OUTPUT_VARIABLE text ERROR_VARIABLE counts)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "check_tidy:\n${text}${counts}")
endif()
message(STATUS "check_tidy: clang-tidy objects to nothing")

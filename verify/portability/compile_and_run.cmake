# Compiles a program and runs it:
#   cmake "-DCOMPILE=<command>" "-DOUTPUT=<program>" "-DRUN=<command>|no" ["-DREFUSED=<regex>"]
#     ["-DMUST_FAIL=<regex>"] -P compile_and_run.cmake
# COMPILE and RUN are lists; COMPILE is followed by -o OUTPUT. What the compiler says must not match
# REFUSED. With MUST_FAIL it must not compile, and the first error must match. A program that returns 77 cannot run here: the line
# "portability: skipped" tells ctest.
cmake_minimum_required(VERSION 3.24)

file(REMOVE "${OUTPUT}")
string(TIMESTAMP begin "%s")
execute_process(COMMAND ${COMPILE} -o "${OUTPUT}"
  RESULT_VARIABLE status OUTPUT_VARIABLE text ERROR_VARIABLE text)
string(TIMESTAMP end "%s")
math(EXPR seconds "${end} - ${begin}")
list(JOIN COMPILE " " command)
message(STATUS "${command}\n${text}\ncompiled in ${seconds} s")
if(MUST_FAIL)
  string(REGEX MATCH "error:[^\n]*" first "${text}")
  if(status EQUAL 0 OR NOT first MATCHES "${MUST_FAIL}")
    message(FATAL_ERROR "the first error is not one that matches ${MUST_FAIL}: ${first}")
  endif()
  return()
endif()
if(NOT status EQUAL 0)
  message(FATAL_ERROR "does not compile: ${status}")
endif()
if(REFUSED AND text MATCHES "${REFUSED}")
  message(FATAL_ERROR "the compiler says: ${CMAKE_MATCH_0}")
endif()

if(NOT RUN STREQUAL "no")
  execute_process(COMMAND ${RUN} RESULT_VARIABLE status)
  if(status EQUAL 77)
    message(STATUS "portability: skipped")
  elseif(NOT status EQUAL 0)
    message(FATAL_ERROR "${RUN} returned ${status}")
  endif()
endif()

# Fails when claims, tests and theory disagree:
#   cmake -DROOT=<repository> -P cmake/check_claims.cmake
# - A claim is a row of the table in verify/README.md that starts with its ID, "| V-CELL-03 |".
#   Each claim stands in the name of a test case and on a page of docs/theory; no test case and no
#   page names an ID that is not in the table; no ID has two rows.
# - A tag such as [C-7] is defined by a line of docs/theory that starts with "**[C-7]**", exactly
#   once; headers cite defined tags only, and every defined tag is cited by a header.
# - docs/tags.md says on which page each tag is defined, in the order of the tags. This writes it:
#   cmake -DROOT=<repository> -DWRITE_TAGS=ON -P cmake/check_claims.cmake
cmake_minimum_required(VERSION 3.24)

set(id_pattern "V-[A-Z0-9]+-[0-9]+")
set(tag_pattern "<[A-Z]+-[0-9]+[a-z]?>")
set(faults "")

# Contents of files as one string. Brackets become <>, semicolons commas: both mean something in a
# CMake list.
function(read_files result)
  set(all "")
  foreach(file IN LISTS ARGN)
    file(READ "${file}" text)
    string(REPLACE "[" "<" text "${text}")
    string(REPLACE "]" ">" text "${text}")
    string(REPLACE ";" "," text "${text}")
    string(APPEND all "\n${text}")
  endforeach()
  set(${result} "${all}" PARENT_SCOPE)
endfunction()

function(count_faults text list)
  set(result "${faults}")
  foreach(item IN LISTS ${list})
    string(APPEND result "  ${item} ${text}\n")
  endforeach()
  string(REGEX REPLACE "<([A-Z]+-[0-9]+[a-z]?)>" "[\\1]" result "${result}")
  set(faults "${result}" PARENT_SCOPE)
endfunction()

# The items of `left` that are not in `right`.
function(difference result left right)
  set(remaining "${${left}}")
  if(${right})
    list(REMOVE_ITEM remaining ${${right}})
  endif()
  list(REMOVE_DUPLICATES remaining)
  set(${result} "${remaining}" PARENT_SCOPE)
endfunction()

# The items that stand in a list more than once.
function(repeated result list)
  set(once "")
  set(again "")
  foreach(item IN LISTS ${list})
    if(item IN_LIST once)
      list(APPEND again "${item}")
    endif()
    list(APPEND once "${item}")
  endforeach()
  list(REMOVE_DUPLICATES again)
  set(${result} "${again}" PARENT_SCOPE)
endfunction()

file(GLOB_RECURSE test_files "${ROOT}/verify/*.cpp")
file(GLOB_RECURSE theory_files "${ROOT}/docs/theory/*.md")
file(GLOB_RECURSE header_files "${ROOT}/include/*.hpp" "${ROOT}/drape_demo/src/*.hpp")
read_files(table "${ROOT}/verify/README.md")
read_files(tests ${test_files})
read_files(theory ${theory_files})
read_files(headers ${header_files})

string(REGEX MATCHALL "\n\\| *${id_pattern} *\\|" rows "${table}")
string(REGEX MATCHALL "${id_pattern}" claims "${rows}")
string(REGEX MATCHALL "TEST_CASE[A-Z_]*\\([^\"]*\"${id_pattern}" names "${tests}")
string(REGEX MATCHALL "${id_pattern}" tested "${names}")
string(REGEX MATCHALL "${id_pattern}" explained "${theory}")
string(REGEX MATCHALL "\n\\*\\*${tag_pattern}\\*\\*" definitions "${theory}")
string(REGEX MATCHALL "${tag_pattern}" defined "${definitions}")
string(REGEX MATCHALL "${tag_pattern}" cited "${headers}")

if(NOT claims)
  string(APPEND faults "  verify/README.md has no claims\n")
endif()
repeated(found claims)
count_faults("has more than one row in verify/README.md" found)
difference(found claims tested)
count_faults("stands in verify/README.md, but in no test name" found)
difference(found claims explained)
count_faults("stands in verify/README.md, but on no page of docs/theory" found)
difference(found tested claims)
count_faults("stands in a test name, but not in verify/README.md" found)
difference(found explained claims)
count_faults("stands on a page of docs/theory, but not in verify/README.md" found)
repeated(found defined)
count_faults("is defined more than once in docs/theory" found)
difference(found cited defined)
count_faults("is cited in include, but not defined in docs/theory" found)
difference(found defined cited)
count_faults("is defined in docs/theory, but never cited in include" found)

# The index: a line "[C-4] | page | section" for each definition, the number padded for sorting.
set(index "")
foreach(file IN LISTS theory_files)
  cmake_path(GET file STEM page)
  read_files(text "${file}")
  string(REGEX MATCHALL "\n(##* [^\n]*|\\*\\*${tag_pattern}\\*\\*)" items "${text}")
  set(section "")
  foreach(item IN LISTS items)
    if(item MATCHES "^\n##* (.*)$")
      set(section "${CMAKE_MATCH_1}")
    elseif(item MATCHES "<([A-Z]+)-([0-9]+[a-z]?)>")
      string(LENGTH "${CMAKE_MATCH_2}" digits)
      math(EXPR padding "4 - ${digits}")
      string(REPEAT "0" ${padding} zeros)
      set(tag "${CMAKE_MATCH_1}-${zeros}${CMAKE_MATCH_2}")
      list(APPEND index "${tag} | <${page}>(theory/${page}.md) | ${section} |\n")
    endif()
  endforeach()
endforeach()
list(SORT index)
set(tags_page "# Tags

A tag names an equation or an argument. It stands in brackets in the code and on the pages of
docs/theory, and is defined on one of them. This list is made by cmake/check_claims.cmake.

| tag | page | section |
| --- | --- | --- |
")
foreach(row IN LISTS index)
  string(REGEX REPLACE "^([A-Z]+)-0*([0-9]+[a-z]?) " "| <\\1-\\2> " row "${row}")
  string(APPEND tags_page "${row}")
endforeach()
string(REPLACE "<" "[" tags_page "${tags_page}")
string(REPLACE ">" "]" tags_page "${tags_page}")
if(WRITE_TAGS)
  file(WRITE "${ROOT}/docs/tags.md" "${tags_page}")
endif()
set(tags_found "")
if(EXISTS "${ROOT}/docs/tags.md")
  file(READ "${ROOT}/docs/tags.md" tags_found)
endif()
if(NOT tags_found STREQUAL tags_page)
  string(APPEND faults
    "  docs/tags.md is not the list of the tags in docs/theory: write it anew by\n"
    "    cmake -DROOT=<repository> -DWRITE_TAGS=ON -P cmake/check_claims.cmake\n")
endif()

if(faults)
  message(FATAL_ERROR "claims and tags:\n${faults}")
endif()
list(LENGTH claims claim_count)
list(LENGTH defined tag_count)
message(STATUS "claims: ${claim_count} claims and ${tag_count} tags agree")

# Makes the release archive from a clean clone of HEAD and tries it as a user would: unpacked,
# installed, found by the consumer of verify/packaging, its version compared with the archive's
# name.
#   cmake -P cmake/release.cmake
# leaves out/release/crossbeam-<version>.tar.gz and prints its path and its SHA-256.
#   -DREPOSITORY=<another repository>  -DOUT=<another folder>
cmake_minimum_required(VERSION 3.24)

if(NOT REPOSITORY)
  cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH REPOSITORY)
endif()
if(NOT OUT)
  set(OUT "${REPOSITORY}/out/release")
endif()
set(scratch "${OUT}/scratch")
find_program(GIT git REQUIRED)

# run(<what it is for> <command>...): its output in `printed`
function(run purpose)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE printed
    ERROR_VARIABLE complaint OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "release: ${purpose} failed:\n${printed}\n${complaint}")
  endif()
  set(printed "${printed}" PARENT_SCOPE)
endfunction()

# Fails where the tree as it is differs from HEAD: the archive would not be what was tested.
run("asking git for changes" "${GIT}" -C "${REPOSITORY}" status --porcelain)
if(NOT printed STREQUAL "")
  message(FATAL_ERROR "release: there are changes that are not committed:\n${printed}")
endif()

file(REMOVE_RECURSE "${scratch}")
file(MAKE_DIRECTORY "${scratch}")
set(clone "${scratch}/clone")
run("cloning" "${GIT}" clone --quiet --no-hardlinks "${REPOSITORY}" "${clone}")
run("asking git for HEAD" "${GIT}" -C "${REPOSITORY}" rev-parse HEAD)
set(commit "${printed}")
run("checking out HEAD" "${GIT}" -C "${clone}" checkout --quiet --detach "${commit}")
foreach(check IN ITEMS check_version check_claims check_snippets check_links layering)
  run("${check}" "${CMAKE_COMMAND}" "-DROOT=${clone}" -P "${clone}/cmake/${check}.cmake")
endforeach()

file(READ "${clone}/include/crossbeam/base/version.hpp" header)
foreach(part IN ITEMS MAJOR MINOR PATCH)
  if(NOT header MATCHES "#define CROSSBEAM_VERSION_${part} ([0-9]+)")
    message(FATAL_ERROR "release: version.hpp states no ${part}")
  endif()
  set(${part} "${CMAKE_MATCH_1}")
endforeach()
set(name "crossbeam-${MAJOR}.${MINOR}.${PATCH}")
set(archive "${OUT}/${name}.tar.gz")

# The same commit gives the same archive: git takes the times from the commit, gzip none (-n).
run("archiving" "${GIT}" -C "${clone}" -c tar.tar.gz.command=gzip\ -cn archive --format=tar.gz
  "--prefix=${name}/" "--output=${archive}" HEAD)

file(ARCHIVE_EXTRACT INPUT "${archive}" DESTINATION "${scratch}")
set(source "${scratch}/${name}")
set(prefix "${scratch}/prefix")
run("configuring the unpacked archive" "${CMAKE_COMMAND}" -S "${source}" -B "${scratch}/build")
run("installing" "${CMAKE_COMMAND}" --install "${scratch}/build" --prefix "${prefix}")
run("configuring the consumer" "${CMAKE_COMMAND}" -S "${source}/verify/packaging/consumer"
  -B "${scratch}/consumer" -DWAY=find_package "-DCMAKE_PREFIX_PATH=${prefix}"
  "-DCROSSBEAM_VERSION_EXPECTED=${MAJOR}.${MINOR}.${PATCH}")
run("building the consumer" "${CMAKE_COMMAND}" --build "${scratch}/consumer")
# It compares the version that it was compiled with with the expected one.
run("running the consumer" "${scratch}/consumer/consumer")

file(REMOVE_RECURSE "${scratch}")
file(SHA256 "${archive}" sum)
file(WRITE "${archive}.sha256" "${sum}  ${name}.tar.gz\n")
message(STATUS "archive: ${archive}")
message(STATUS "commit:  ${commit}")
message(STATUS "sha256:  ${sum}")

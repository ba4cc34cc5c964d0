# SPDX-License-Identifier: BSD-3-Clause
# Project-wide settings and the four functions every folder uses:
#
#   rosflight_library(NAME [FIRMWARE] SOURCES ... USES ...)   one library, target rosflight::NAME
#   rosflight_program(NAME SOURCES ... USES ...)              one executable
#   rosflight_test(NAME [COMPUTES] SOURCES ... USES ... [LABELS ...] [ALIKE ...])   one GoogleTest binary, registered with
#                                                             CTest; LABELS emulator: needs the image of preset cortex-m7;
#                                                             LABELS long: takes over 5 s on an emulated arm64; LABELS alone:
#                                                             replaces a part of a library, so it is joined with no other test
#                                                             (joined_tests.cmake);
#                                                             COMPUTES: for long, so optimized; ALIKE: cases that differ
#                                                             from others in numbers only, left out under sanitizers
#   rosflight_fuzzer(NAME SOURCES ... USES ...)               one libFuzzer binary (LLVMFuzzerTestOneInput), preset sanitizers;
#                                                             name it fuzz_..., seeds go to FOLDER/fuzz/corpus/NAME/
#
# Headers are included by their path from the root of the project ("firmware/core/mixer.hpp").

set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
option(ROSFLIGHT_BARE_METAL "Build only what runs on a microcontroller" OFF)
option(ROSFLIGHT_SANITIZE "Address and undefined-behaviour sanitizers; with clang also the fuzzers" OFF)
option(ROSFLIGHT_QUICK_BUILD "Libraries several files at a time, the headers of other libraries precompiled" OFF)
set(ROSFLIGHT_FILES_AT_A_TIME 9 CACHE STRING "How many, in a quick build")
option(ROSFLIGHT_TESTS "Build the tests too" ON)

set(ROSFLIGHT_ROOT ${CMAKE_SOURCE_DIR})
set(ROSFLIGHT_WARNINGS
    -Wall -Wextra -Wpedantic -Werror -Wshadow -Wconversion -Wsign-conversion -Wold-style-cast
    -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-align -Wimplicit-fallthrough -Wdouble-promotion)
# Bit-identical results need the same arithmetic everywhere: no fused multiply-add, no fast-math.
# Nobody reads errno after a square root, and testing for it costs.
add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off> $<$<COMPILE_LANGUAGE:CXX>:-fno-math-errno>)
if(NOT ROSFLIGHT_BARE_METAL)
  # Shared libraries (plugins, ROS components) are linked from ours, and all targets share one set of precompiled headers.
  add_compile_options(-fPIC -fno-semantic-interposition)
endif()

if(ROSFLIGHT_SANITIZE)
  # The firmware is built without RTTI, which the vptr check needs.
  add_compile_options(-fsanitize=address,undefined -fno-sanitize=vptr -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_compile_definitions($<$<COMPILE_LANGUAGE:CXX>:_GLIBCXX_ASSERTIONS>)
  add_link_options(-fsanitize=address,undefined)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    # With its contents in the name: ccache does not read it. From the build folder, where ninja compiles: every clone has
    # the same command.
    file(SHA256 ${CMAKE_SOURCE_DIR}/cmake/sanitizers_ignore.txt digest)
    string(SUBSTRING ${digest} 0 12 digest)
    configure_file(${CMAKE_SOURCE_DIR}/cmake/sanitizers_ignore.txt ${CMAKE_BINARY_DIR}/sanitizers_ignore_${digest}.txt COPYONLY)
    add_compile_options(-fsanitize-ignorelist=sanitizers_ignore_${digest}.txt)
    set(ROSFLIGHT_FUZZERS ON)
  endif()
endif()

# Hundreds of tests are linked, by lld in a third of the time.
find_program(ROSFLIGHT_LLD ld.lld)
if(ROSFLIGHT_LLD AND (NOT CMAKE_CROSSCOMPILING OR CMAKE_CXX_COMPILER_ID STREQUAL "Clang"))
  add_link_options(-fuse-ld=lld)
endif()

find_program(ROSFLIGHT_PYTHON NAMES python3 PATHS ${CMAKE_SOURCE_DIR}/.venv-build/bin NO_DEFAULT_PATH)
if(NOT ROSFLIGHT_PYTHON)
  message(FATAL_ERROR "No Python environment in .venv-build: tools/ready.sh build makes it")
endif()

find_path(ROSFLIGHT_EIGEN_DIR Eigen/Core PATHS /usr/include/eigen3 NO_CMAKE_FIND_ROOT_PATH REQUIRED)
add_library(rosflight_eigen INTERFACE)
add_library(rosflight::eigen ALIAS rosflight_eigen)
target_include_directories(rosflight_eigen SYSTEM INTERFACE $<BUILD_INTERFACE:${ROSFLIGHT_EIGEN_DIR}>)
target_link_libraries(rosflight_eigen INTERFACE $<INSTALL_INTERFACE:Eigen3::Eigen>)
target_compile_definitions(rosflight_eigen INTERFACE EIGEN_MPL2_ONLY)
if(ROSFLIGHT_QUICK_BUILD)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC 12 warns falsely about std::string once its header is precompiled (GCC bugs 105329 and 105651).
    add_compile_options(-Wno-array-bounds -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread)
    set(ROSFLIGHT_PRECOMPILED_OPTIONS -fpch-preprocess)  # both for ccache
  else()
    set(ROSFLIGHT_PRECOMPILED_OPTIONS -Xclang -fno-pch-timestamp)
  endif()
  # What is precompiled holds for all, whether they use it or not.
  find_package(fmt REQUIRED)
  get_target_property(fmt_definitions fmt::fmt INTERFACE_COMPILE_DEFINITIONS)
  if(NOT fmt_definitions)
    set(fmt_definitions "")
  endif()
  add_compile_definitions(EIGEN_MPL2_ONLY ${fmt_definitions})
endif()

enable_testing()
if(NOT ROSFLIGHT_BARE_METAL)
  if(ROSFLIGHT_TESTS)
    find_package(GTest REQUIRED)
  endif()
  find_package(Threads REQUIRED)
  find_package(tinyxml2 REQUIRED)
endif()

function(_rosflight_common target visibility)
  target_include_directories(${target} ${visibility} ${ROSFLIGHT_ROOT})
endfunction()

# Three quarters of the time of an ordinary file go into reading Eigen, fmt and the standard library, most of the rest into
# our own headers and their templates. With ROSFLIGHT_QUICK_BUILD the former are read once for each kind of target, by
# rosflight_headers_KIND, and libraries are compiled several files at a time: names in the unnamed namespaces of one library
# differ. clang-tidy and the preset cortex-m7 compile file by file without, so a missing #include shows.
set(ROSFLIGHT_PRECOMPILED_FIRMWARE <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <cmath> <cstdint> <cstring> <limits>)
set(ROSFLIGHT_PRECOMPILED_HOST
    <Eigen/Dense> <fmt/format.h> <algorithm> <array> <charconv> <chrono> <cmath> <cstdint> <cstring> <deque> <filesystem> <fstream>
    <functional> <iostream> <limits> <map> <memory> <numbers> <optional> <random> <set> <span> <sstream> <stdexcept>
    <string> <string_view> <tuple> <utility> <variant> <vector>)

function(_rosflight_precompile target kind)
  if(ROSFLIGHT_QUICK_BUILD)
    # At the end of the folder, when the target has all its properties.
    cmake_language(EVAL CODE "cmake_language(DEFER CALL _rosflight_use_precompiled ${target} ${kind})")
  endif()
endfunction()

function(_rosflight_use_precompiled target kind)
  set(headers rosflight_headers_${kind})
  if(NOT TARGET ${headers})
    set(empty ${CMAKE_BINARY_DIR}/precompiled/${headers}.cpp)
    file(CONFIGURE OUTPUT ${empty} CONTENT "")
    add_library(${headers} OBJECT EXCLUDE_FROM_ALL ${empty})
    target_compile_options(${headers} PRIVATE ${ROSFLIGHT_WARNINGS})
    target_link_libraries(${headers} PRIVATE rosflight_eigen)
    set_target_properties(${headers} PROPERTIES CXX_STANDARD 20)
    set(files ${ROSFLIGHT_PRECOMPILED_HOST})
    if(kind STREQUAL "firmware")
      set(files ${ROSFLIGHT_PRECOMPILED_FIRMWARE})
      _rosflight_firmware_options(${headers})
    elseif(kind MATCHES "test")
      list(APPEND files <gtest/gtest.h>)
      target_link_libraries(${headers} PRIVATE GTest::gtest)
      _rosflight_test_options(${headers} ${kind})
    endif()
    if(NOT kind MATCHES "test")
      _rosflight_guides_fuzzers(${headers})
    endif()
    target_precompile_headers(${headers} PRIVATE ${files})
    target_compile_options(${headers} PRIVATE ${ROSFLIGHT_PRECOMPILED_OPTIONS})
  endif()
  target_precompile_headers(${target} REUSE_FROM ${headers})
  target_compile_options(${target} PRIVATE ${ROSFLIGHT_PRECOMPILED_OPTIONS})
endfunction()

# Fuzzers see which branches of it an input takes. Tests are compiled without: they are no target of theirs.
function(_rosflight_guides_fuzzers target)
  if(ROSFLIGHT_FUZZERS)
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
endfunction()

function(_rosflight_firmware_options target)
  set_target_properties(${target} PROPERTIES CXX_STANDARD 17)
  target_compile_options(${target} PRIVATE
    $<$<COMPILE_LANGUAGE:CXX>:-fno-exceptions -fno-rtti -fno-threadsafe-statics>)
  target_compile_definitions(${target} PRIVATE EIGEN_NO_MALLOC EIGEN_NO_DEBUG)
endfunction()

# A test is compiled once and run once: optimizing what it expands to takes longer than it saves, but for those that compute
# for long (kind computing_test). The libraries they test are optimized as the preset says.
function(_rosflight_test_options target kind)
  if((ROSFLIGHT_SANITIZE OR ROSFLIGHT_QUICK_BUILD) AND kind STREQUAL "test")
    target_compile_options(${target} PRIVATE -O0)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    target_compile_options(${target} PRIVATE -Wno-double-promotion)  # clang warns of double{x} too, which is explicit
  endif()
endfunction()

# RUNS_ONCE: code that runs once at a start, as a command line does: optimizing it takes longer than it saves.
function(rosflight_library name)
  cmake_parse_arguments(arg "FIRMWARE;RUNS_ONCE" "" "SOURCES;USES" ${ARGN})
  set(target rosflight_${name})
  if(arg_SOURCES)
    add_library(${target} STATIC ${arg_SOURCES})
    set_target_properties(${target} PROPERTIES UNITY_BUILD ${ROSFLIGHT_QUICK_BUILD} UNITY_BUILD_BATCH_SIZE ${ROSFLIGHT_FILES_AT_A_TIME})
    set(visibility PUBLIC)
    target_compile_options(${target} PRIVATE ${ROSFLIGHT_WARNINGS})
    _rosflight_guides_fuzzers(${target})
    if(arg_FIRMWARE)
      _rosflight_firmware_options(${target})
      _rosflight_precompile(${target} firmware)
    else()
      set_target_properties(${target} PROPERTIES CXX_STANDARD 20)
      if(arg_RUNS_ONCE AND ROSFLIGHT_QUICK_BUILD)
        target_compile_options(${target} PRIVATE -O0)  # without precompiled headers, whose level GCC takes
      else()
        _rosflight_precompile(${target} host)
      endif()
    endif()
  else()
    add_library(${target} INTERFACE)
    set(visibility INTERFACE)
  endif()
  add_library(rosflight::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  set_property(GLOBAL APPEND PROPERTY ROSFLIGHT_LIBRARIES ${target})
  _rosflight_common(${target} ${visibility})
  target_link_libraries(${target} ${visibility} ${arg_USES})
endfunction()

function(rosflight_program name)
  cmake_parse_arguments(arg "" "TEST" "SOURCES;USES" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  set_target_properties(${name} PROPERTIES CXX_STANDARD 20)
  target_compile_options(${name} PRIVATE ${ROSFLIGHT_WARNINGS})
  _rosflight_common(${name} PRIVATE)
  target_link_libraries(${name} PRIVATE ${arg_USES})
  if(arg_TEST)
    _rosflight_precompile(${name} ${arg_TEST})
    _rosflight_test_options(${name} ${arg_TEST})
  else()
    _rosflight_precompile(${name} host)
    _rosflight_guides_fuzzers(${name})
  endif()
endfunction()

function(rosflight_test name)
  if(ROSFLIGHT_BARE_METAL OR NOT ROSFLIGHT_TESTS)
    return()
  endif()
  cmake_parse_arguments(arg "COMPUTES" "" "SOURCES;USES;LABELS;ALIKE" ${ARGN})
  if(ROSFLIGHT_JOINED_TESTS AND NOT arg_LABELS)
    _rosflight_join_test(${name} "${arg_SOURCES}" "${arg_USES}")
    if(joined)
      return()
    endif()
  endif()
  set(kind test)
  if(arg_COMPUTES OR (ROSFLIGHT_JOINED_TESTS AND "long" IN_LIST arg_LABELS))
    set(kind computing_test)
  endif()
  rosflight_program(${name} TEST ${kind} SOURCES ${arg_SOURCES} USES ${arg_USES} GTest::gtest_main)
  set(filter)
  if(ROSFLIGHT_SANITIZE AND arg_ALIKE)
    list(JOIN arg_ALIKE ":" filter)
    set(filter "--gtest_filter=-${filter}")
  endif()
  add_test(NAME ${name} COMMAND ${name} ${filter} WORKING_DIRECTORY ${ROSFLIGHT_ROOT})
  # The labels tell ./rosflight test that it can count the cases inside, and whose test it is.
  file(RELATIVE_PATH folder ${ROSFLIGHT_ROOT} ${CMAKE_CURRENT_SOURCE_DIR})
  string(REGEX REPLACE "/.*" "" folder ${folder})
  set(timeout_s 300)
  if(ROSFLIGHT_SANITIZE)
    set(timeout_s 1200)
  elseif("emulator" IN_LIST arg_LABELS OR CMAKE_CROSSCOMPILING)
    set(timeout_s 900)
  endif()
  set_tests_properties(${name} PROPERTIES TIMEOUT ${timeout_s} LABELS "gtest;of ${folder};${arg_LABELS}")
endfunction()

include(joined_tests)

function(rosflight_fuzzer name)
  if(NOT ROSFLIGHT_FUZZERS)
    return()
  endif()
  rosflight_program(${name} ${ARGN})
  target_link_options(${name} PRIVATE -fsanitize=fuzzer)
endfunction()

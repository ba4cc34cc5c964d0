# SPDX-License-Identifier: BSD-3-Clause
# Project-wide settings, the four functions every folder uses, and one for the root:
#
#   rosflight_library(NAME [FIRMWARE] SOURCES ... USES ...)   one library, target rosflight::NAME
#   rosflight_program(NAME SOURCES ... USES ...)              one executable
#   rosflight_test(NAME SOURCES ... USES ... [LABELS ...])   one GoogleTest binary, registered with CTest;
#                                                             LABELS emulator: needs the image of preset cortex-m7
#   rosflight_fuzzer(NAME SOURCES ... USES ...)               one libFuzzer binary (LLVMFuzzerTestOneInput), preset fuzz;
#                                                             name it fuzz_..., seeds go to FOLDER/fuzz/corpus/NAME/
#   rosflight_export_libraries()                              target rosflight_libraries and a file that imports them
#
# Headers are included by their path from the root of the project ("firmware/core/mixer.hpp").

set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
option(ROSFLIGHT_BARE_METAL "Build only what runs on a microcontroller" OFF)
option(ROSFLIGHT_SANITIZE "Address and undefined-behaviour sanitizers" OFF)
option(ROSFLIGHT_FUZZ "Build the libraries and the fuzzers for libFuzzer, with clang; no tests" OFF)

set(ROSFLIGHT_ROOT ${CMAKE_SOURCE_DIR})
set(ROSFLIGHT_WARNINGS
    -Wall -Wextra -Wpedantic -Werror -Wshadow -Wconversion -Wsign-conversion -Wold-style-cast
    -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-align -Wimplicit-fallthrough -Wdouble-promotion)
# Bit-identical results need the same arithmetic everywhere: no fused multiply-add, no fast-math.
# Nobody reads errno after a square root, and testing for it costs.
add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off> $<$<COMPILE_LANGUAGE:CXX>:-fno-math-errno>)

if(ROSFLIGHT_SANITIZE)
  # The firmware is built without RTTI, which the vptr check needs.
  add_compile_options(-fsanitize=address,undefined -fno-sanitize=vptr -fno-sanitize-recover=all
                      -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
endif()

if(ROSFLIGHT_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "ROSFLIGHT_FUZZ needs clang++ (preset fuzz), not ${CMAKE_CXX_COMPILER}")
  endif()
  add_compile_options(-fsanitize=fuzzer-no-link,address,undefined -fno-sanitize=vptr
                      -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
endif()

find_program(ROSFLIGHT_PYTHON NAMES python3 PATHS ${CMAKE_SOURCE_DIR}/.venv/bin NO_DEFAULT_PATH)
if(NOT ROSFLIGHT_PYTHON)
  message(FATAL_ERROR "No virtual environment in .venv: tools/ready.sh venv makes it")
endif()

find_path(ROSFLIGHT_EIGEN_DIR Eigen/Core PATHS /usr/include/eigen3 NO_CMAKE_FIND_ROOT_PATH REQUIRED)
add_library(rosflight_eigen INTERFACE)
add_library(rosflight::eigen ALIAS rosflight_eigen)
target_include_directories(rosflight_eigen SYSTEM INTERFACE ${ROSFLIGHT_EIGEN_DIR})
target_compile_definitions(rosflight_eigen INTERFACE EIGEN_MPL2_ONLY)

enable_testing()
if(NOT ROSFLIGHT_BARE_METAL)
  find_package(GTest REQUIRED)
  find_package(Threads REQUIRED)
endif()

function(_rosflight_common target visibility)
  target_include_directories(${target} ${visibility} ${ROSFLIGHT_ROOT})
endfunction()

function(rosflight_library name)
  cmake_parse_arguments(arg "FIRMWARE" "" "SOURCES;USES" ${ARGN})
  set(target rosflight_${name})
  if(arg_SOURCES)
    add_library(${target} STATIC ${arg_SOURCES})
    set(visibility PUBLIC)
    target_compile_options(${target} PRIVATE ${ROSFLIGHT_WARNINGS})
    if(arg_FIRMWARE)
      set_target_properties(${target} PROPERTIES CXX_STANDARD 17)
      target_compile_options(${target} PRIVATE
        $<$<COMPILE_LANGUAGE:CXX>:-fno-exceptions -fno-rtti -fno-threadsafe-statics>)
      target_compile_definitions(${target} PRIVATE EIGEN_NO_MALLOC EIGEN_NO_DEBUG)
    else()
      set_target_properties(${target} PROPERTIES CXX_STANDARD 20)
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

# For programs outside this build, such as the ROS nodes: they include BUILD/rosflight_libraries.cmake
# after the packages named there and link rosflight::NAME as if they were inside.
function(rosflight_export_libraries)
  get_property(libraries GLOBAL PROPERTY ROSFLIGHT_LIBRARIES)
  add_custom_target(rosflight_libraries)
  add_dependencies(rosflight_libraries ${libraries})
  set_target_properties(rosflight_eigen PROPERTIES EXPORT_NAME eigen)
  export(TARGETS rosflight_eigen ${libraries} NAMESPACE rosflight:: FILE ${CMAKE_BINARY_DIR}/rosflight_libraries.cmake)
endfunction()

function(rosflight_program name)
  cmake_parse_arguments(arg "" "" "SOURCES;USES" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  set_target_properties(${name} PROPERTIES CXX_STANDARD 20)
  target_compile_options(${name} PRIVATE ${ROSFLIGHT_WARNINGS})
  _rosflight_common(${name} PRIVATE)
  target_link_libraries(${name} PRIVATE ${arg_USES})
  if(ROSFLIGHT_FUZZ)
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
  endif()
endfunction()

function(rosflight_test name)
  if(ROSFLIGHT_BARE_METAL OR ROSFLIGHT_FUZZ)
    return()
  endif()
  cmake_parse_arguments(arg "" "" "SOURCES;USES;LABELS" ${ARGN})
  rosflight_program(${name} SOURCES ${arg_SOURCES} USES ${arg_USES} GTest::gtest_main)
  add_test(NAME ${name} COMMAND ${name} WORKING_DIRECTORY ${ROSFLIGHT_ROOT})
  # The labels tell ./rosflight test that it can count the cases inside, and whose test it is.
  file(RELATIVE_PATH folder ${ROSFLIGHT_ROOT} ${CMAKE_CURRENT_SOURCE_DIR})
  string(REGEX REPLACE "/.*" "" folder ${folder})
  set(patience_s 300)
  if(ROSFLIGHT_SANITIZE)
    set(patience_s 1200)
  endif()
  set_tests_properties(${name} PROPERTIES TIMEOUT ${patience_s} LABELS "gtest;of ${folder};${arg_LABELS}")
endfunction()

function(rosflight_fuzzer name)
  if(NOT ROSFLIGHT_FUZZ)
    return()
  endif()
  rosflight_program(${name} ${ARGN})
  set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL OFF)
  target_link_options(${name} PRIVATE -fsanitize=fuzzer)
endfunction()

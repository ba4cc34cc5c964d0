# SPDX-License-Identifier: BSD-3-Clause
# Given to every package that `./rosflight ros build` configures (CMAKE_PROJECT_INCLUDE): files are compiled several at a
# time, which halves the time of the compiler. A plain colcon build does without.
set(CMAKE_UNITY_BUILD ON)
set(CMAKE_UNITY_BUILD_BATCH_SIZE 6)

# Generated sources of one kind repeat names in C; those of the other kinds may be joined.
function(rosflight_part_generated)
  get_property(targets DIRECTORY PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    if(target MATCHES "__rosidl_generator_")
      set_target_properties(${target} PROPERTIES UNITY_BUILD OFF)
    elseif(target MATCHES "__rosidl_typesupport_")
      set_target_properties(${target} PROPERTIES UNITY_BUILD_BATCH_SIZE 50)
    endif()
  endforeach()
endfunction()
cmake_language(DEFER DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} CALL rosflight_part_generated)

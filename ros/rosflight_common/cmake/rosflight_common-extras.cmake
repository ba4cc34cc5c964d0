# SPDX-License-Identifier: BSD-3-Clause
# What the CMakeLists.txt of every package with nodes would otherwise repeat.
include(${CMAKE_CURRENT_LIST_DIR}/names.cmake)

# C++20 with the project's warnings, the package's own include folder and the messages of the packages that
# rosflight_find_packages() found.
function(_rosflight_target name uses)
  set_target_properties(${name} PROPERTIES CXX_STANDARD 20 CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF)
  target_compile_options(${name} PRIVATE
    -Wall -Wextra -Wpedantic -Werror -Wshadow -Wconversion -Wsign-conversion -Wold-style-cast
    -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-align -Wimplicit-fallthrough -Wdouble-promotion)
  target_include_directories(${name} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/include)
  target_link_libraries(${name} PRIVATE rosflight_common::rosflight_common ${ROSFLIGHT_MESSAGES} ${uses})
endfunction()

# rosflight_add_program(NAME SOURCES file... [USES library...])
function(rosflight_add_program name)
  cmake_parse_arguments(arg "" "" "SOURCES;USES" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  _rosflight_target(${name} "${arg_USES}")
endfunction()

# rosflight_add_library(NAME SOURCES file... [USES library...]): what several nodes of one package share.
function(rosflight_add_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;USES" ${ARGN})
  add_library(${name} STATIC ${arg_SOURCES})
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  _rosflight_target(${name} "${arg_USES}")
endfunction()

# rosflight_add_node(NAME CLASS package::Class SOURCES file... [MAIN file] [USES library...])
#
# A library with the node as a component (rosflight_common/component.hpp) and a program for `ros2 run` that has this node
# alone. MAIN has the program's main(); without it, the macro ROSFLIGHT_NODE does. A macro, because rclcpp_components keeps what
# it has registered in variables of its caller until ament_package() writes them down.
set(ROSFLIGHT_NODE_MAIN ${CMAKE_CURRENT_LIST_DIR}/node_main.cpp)
find_package(rclcpp_components QUIET)
macro(rosflight_add_node name)
  cmake_parse_arguments(arg "" "CLASS;MAIN" "SOURCES;USES" ${ARGN})
  set(_component ${PROJECT_NAME}_${name})
  add_library(${_component} SHARED ${arg_SOURCES})
  # No macro with the library's name: ccache then compiles a file that two nodes share once.
  set_target_properties(${_component} PROPERTIES DEFINE_SYMBOL "")
  _rosflight_target(${_component} "${arg_USES}")
  if(rclcpp_components_FOUND)
    target_link_libraries(${_component} PRIVATE rclcpp_components::component)
    rclcpp_components_register_nodes(${_component} ${arg_CLASS})
  endif()
  if(NOT arg_MAIN)
    set(arg_MAIN ${ROSFLIGHT_NODE_MAIN})
  endif()
  add_executable(${name} ${arg_MAIN})
  _rosflight_target(${name} "${_component};${arg_USES}")
  set_target_properties(${name} PROPERTIES INSTALL_RPATH "$ORIGIN/..")
  install(TARGETS ${_component} DESTINATION lib)
  install(TARGETS ${name} DESTINATION lib/${PROJECT_NAME})
endmacro()

# rosflight_add_interfaces(INCLUDE folder SOURCES file... PACKAGES package... [USES target...] [EXPORTS package...] [PRIVATE target...])
#
# The shared library PACKAGE::interfaces with the base classes for modules of others. It is installed with its headers, all of
# `folder`, below include/PACKAGE. PACKAGES have the messages that the headers include; USES are further libraries of the headers,
# from the packages EXPORTS; PRIVATE are libraries of the sources alone.
macro(rosflight_add_interfaces)
  cmake_parse_arguments(arg "" "INCLUDE" "SOURCES;PACKAGES;USES;EXPORTS;PRIVATE" ${ARGN})
  add_library(${PROJECT_NAME}_interfaces SHARED ${arg_SOURCES})
  _rosflight_target(${PROJECT_NAME}_interfaces "${arg_PRIVATE}")
  add_library(${PROJECT_NAME}::interfaces ALIAS ${PROJECT_NAME}_interfaces)
  set_target_properties(${PROJECT_NAME}_interfaces PROPERTIES EXPORT_NAME interfaces)
  target_include_directories(${PROJECT_NAME}_interfaces PUBLIC
    $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/${arg_INCLUDE}> $<INSTALL_INTERFACE:include/${PROJECT_NAME}>)
  target_compile_features(${PROJECT_NAME}_interfaces INTERFACE cxx_std_17)
  set(messages)
  foreach(package ${arg_PACKAGES})
    list(APPEND messages ${${package}_TARGETS})
  endforeach()
  target_link_libraries(${PROJECT_NAME}_interfaces PUBLIC ${messages} ${arg_USES})
  install(TARGETS ${PROJECT_NAME}_interfaces EXPORT ${PROJECT_NAME} LIBRARY DESTINATION lib)
  install(DIRECTORY ${arg_INCLUDE}/ DESTINATION include/${PROJECT_NAME})
  ament_export_targets(${PROJECT_NAME} HAS_LIBRARY_TARGET)
  ament_export_dependencies(${arg_PACKAGES} ${arg_EXPORTS})
endmacro()

# rosflight_find_packages(package...): all of them must be there; their messages go to every node of this CMakeLists.txt.
macro(rosflight_find_packages)
  foreach(package ${ARGN})
    find_package(${package} REQUIRED)
    list(APPEND ROSFLIGHT_MESSAGES ${${package}_TARGETS})
  endforeach()
endmacro()

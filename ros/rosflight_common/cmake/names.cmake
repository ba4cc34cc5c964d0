# SPDX-License-Identifier: BSD-3-Clause
# Launch files and programs under the names that ROSflight 2.x gives them.

# rosflight_install_launch_files(): all of launch/. Each file is XML; beside it a Python file of the same name includes it,
# because ROSflight 2.x calls its launch files NAME.launch.py.
set(ROSFLIGHT_LAUNCH_TEMPLATE ${CMAKE_CURRENT_LIST_DIR}/launch.py.in)
function(rosflight_install_launch_files)
  install(DIRECTORY launch DESTINATION share/${PROJECT_NAME} PATTERN *.launch.xml EXCLUDE)
  file(GLOB files RELATIVE ${CMAKE_CURRENT_SOURCE_DIR}/launch CONFIGURE_DEPENDS launch/*.launch.xml)
  foreach(file IN LISTS files)
    set(data ${CMAKE_CURRENT_SOURCE_DIR}/launch/${file})
    if("$ENV{ROS_DISTRO}" STREQUAL humble)  # whose launch refuses the attribute; the Python file does the same
      file(READ ${data} text)
      set(data ${CMAKE_CURRENT_BINARY_DIR}/launch/${file})
      string(REPLACE " on_exit=\"shutdown\"" "" text "${text}")
      file(WRITE ${data} "${text}")
    endif()
    string(REGEX REPLACE "xml$" "py" script ${file})
    configure_file(${ROSFLIGHT_LAUNCH_TEMPLATE} ${CMAKE_CURRENT_BINARY_DIR}/launch/${script} @ONLY)
    install(FILES ${data} ${CMAKE_CURRENT_BINARY_DIR}/launch/${script} DESTINATION share/${PROJECT_NAME}/launch)
  endforeach()
endfunction()

# rosflight_forward_program(NAME PACKAGE PROGRAM): `ros2 run` of NAME in this package runs PROGRAM of PACKAGE, in the same process.
set(ROSFLIGHT_PROGRAM_TEMPLATE ${CMAKE_CURRENT_LIST_DIR}/forward.sh.in)
function(rosflight_forward_program name package program)
  configure_file(${ROSFLIGHT_PROGRAM_TEMPLATE} ${CMAKE_CURRENT_BINARY_DIR}/${name} @ONLY)
  install(PROGRAMS ${CMAKE_CURRENT_BINARY_DIR}/${name} DESTINATION lib/${PROJECT_NAME})
endfunction()

# rosflight_refuse_program(NAME TEXT): `ros2 run` of NAME prints what to type instead and ends with 2.
set(ROSFLIGHT_REFUSAL_TEMPLATE ${CMAKE_CURRENT_LIST_DIR}/refuse.sh.in)
function(rosflight_refuse_program name text)
  configure_file(${ROSFLIGHT_REFUSAL_TEMPLATE} ${CMAKE_CURRENT_BINARY_DIR}/${name} @ONLY)
  install(PROGRAMS ${CMAKE_CURRENT_BINARY_DIR}/${name} DESTINATION lib/${PROJECT_NAME})
endfunction()

# SPDX-License-Identifier: BSD-3-Clause
# Copies the example away, builds it there on its own and runs its test with the library that came out.
file(REMOVE_RECURSE ${WORK})
file(COPY ${SOURCE}/CMakeLists.txt ${SOURCE}/custom_drag.cpp DESTINATION ${WORK}/source)
foreach(step IN ITEMS
    "${CMAKE_COMMAND};-S;${WORK}/source;-B;${WORK}/build;-DROSFLIGHT=${ROSFLIGHT};-DROSFLIGHT_BUILD=${ROSFLIGHT_BUILD};-DCMAKE_CXX_COMPILER=${COMPILER};-DCMAKE_BUILD_TYPE=Release"
    "${CMAKE_COMMAND};--build;${WORK}/build"
    "${CMAKE_COMMAND};-E;env;CUSTOM_DRAG_PLUGIN=${WORK}/build/libcustom_drag.so;${PROGRAM}")
  execute_process(COMMAND ${step} WORKING_DIRECTORY ${ROSFLIGHT} COMMAND_ERROR_IS_FATAL ANY)
endforeach()

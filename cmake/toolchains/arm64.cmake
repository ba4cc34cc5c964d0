# SPDX-License-Identifier: BSD-3-Clause
# Linux on arm64, as on the companion's computer: the distribution's cross compiler, and libraries that tools/arm64.sh unpacks
# in build/arm64-root. Programs run on an emulated processor.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
find_program(ROSFLIGHT_ARM64_COMPILER aarch64-linux-gnu-g++)
if(NOT ROSFLIGHT_ARM64_COMPILER)
  message(FATAL_ERROR "aarch64-linux-gnu-g++ is not installed: it comes with the package g++-aarch64-linux-gnu")
endif()
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
get_filename_component(CMAKE_FIND_ROOT_PATH ${CMAKE_CURRENT_LIST_DIR}/../../build/arm64-root ABSOLUTE)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -L ${CMAKE_FIND_ROOT_PATH})
# Before the compiler's own headers; and what depends on the processor in the headers of those libraries.
set(CMAKE_CXX_FLAGS_INIT "-isystem ${CMAKE_CURRENT_LIST_DIR}/arm64 -isystem ${CMAKE_FIND_ROOT_PATH}/usr/include/aarch64-linux-gnu")
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_SYSTEM_LIBRARY_PATH /usr/lib/aarch64-linux-gnu)  # within that folder
# Where the linker looks for what these libraries need in turn.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,-rpath-link,${CMAKE_FIND_ROOT_PATH}/usr/lib/aarch64-linux-gnu")
# For the Debian package: dpkg-shlibdeps asks about installed packages, and these are only unpacked.
if(EXISTS ${CMAKE_FIND_ROOT_PATH}/depends)
  file(STRINGS ${CMAKE_FIND_ROOT_PATH}/depends depends)
  string(REPLACE ";" ", " ROSFLIGHT_DEBIAN_DEPENDS "${depends}")
endif()

# SPDX-License-Identifier: BSD-3-Clause
# Writes a header with version and commit of the sources, if they have changed since:
#     cmake -DROOT=SOURCES -DHEADER=FILE -P build_info.cmake
file(STRINGS ${ROOT}/CMakeLists.txt project_line REGEX "^project\\(rosflight VERSION")
string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+" version "${project_line}")
set(commit "")
set(changed false)
execute_process(COMMAND git -C ${ROOT} rev-parse --show-prefix HEAD OUTPUT_VARIABLE found ERROR_QUIET RESULT_VARIABLE failed)
# A prefix means that these sources lie, as an archive, in a repository of somebody else.
if(NOT failed AND found MATCHES "^\n([0-9a-f]+)\n$")
  set(commit ${CMAKE_MATCH_1})
  execute_process(COMMAND git -C ${ROOT} status --porcelain --untracked-files=no OUTPUT_VARIABLE differs ERROR_QUIET)
  if(differs)
    set(changed true)
  endif()
endif()
file(CONFIGURE OUTPUT ${HEADER} CONTENT [[
// Written by cmake/build_info.cmake.
inline constexpr rosflight::flight::BuildInfo kBuildInfo{"@version@", "@commit@", @changed@};
]] @ONLY)

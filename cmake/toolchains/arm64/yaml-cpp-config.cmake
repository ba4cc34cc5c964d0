# SPDX-License-Identifier: BSD-3-Clause
# Debian's libyaml-cpp-dev can be installed for one architecture only, and the host needs it. Its headers are the same for
# all; the arm64 library comes with libyaml-cpp0.7:arm64.
find_library(ROSFLIGHT_ARM64_YAML_CPP libyaml-cpp.so.0.7 PATHS /usr/lib/aarch64-linux-gnu NO_DEFAULT_PATH REQUIRED)
add_library(yaml-cpp SHARED IMPORTED)
set_target_properties(yaml-cpp PROPERTIES IMPORTED_LOCATION ${ROSFLIGHT_ARM64_YAML_CPP})

# SPDX-License-Identifier: BSD-3-Clause
"""The package.xml files: each names what its package uses, under names that rosdep and the ROS index know."""

import re
import subprocess
import xml.etree.ElementTree as xml
from pathlib import Path

import pytest
from project import ROOT, own_files

FILES = [path for path in own_files() if path.name == "package.xml" and path.parts[0] not in ("ros_standin", "examples")]
# Packages of Humble and Jazzy that ours need.
ROS = {"ament_cmake", "builtin_interfaces", "class_loader", "diagnostic_msgs", "geometry_msgs", "launch", "launch_ros", "launch_xml",
       "rcl_interfaces", "rclcpp", "rclcpp_components", "rclpy", "rosgraph_msgs", "rosidl_default_generators",
       "rosidl_default_runtime", "rqt_reconfigure", "rviz2", "sensor_msgs", "std_msgs", "std_srvs", "tf2_msgs",
       "visualization_msgs"}
# Keys of rosdep (rosdistro: rosdep/base.yaml and python.yaml) and their packages in Debian and Ubuntu.
ROSDEP = {"cli11": "libcli11-dev", "cmake": "cmake", "eigen": "libeigen3-dev", "git": "git", "gtest": "libgtest-dev",
          "libboost-dev": "libboost-dev", "libssl-dev": "libssl-dev", "libzstd-dev": "libzstd-dev", "ninja-build": "ninja-build",
          "nlohmann-json-dev": "nlohmann-json3-dev", "python3-numpy": None,
          "python3-venv": "python3-venv", "python3-yaml": None, "sdl2": "libsdl2-dev", "fmt": "libfmt-dev", "tinyxml2": "libtinyxml2-dev", "yaml-cpp": "libyaml-cpp-dev", "zlib": "zlib1g-dev"}
# What find_package calls otherwise, or brings along: rosflight_common exports what it is built on.
FOUND = {"Eigen3": "eigen", "SDL2": "sdl2", "GTest": "gtest", "Python3": None}
# rosdep has no keys for these; tools/ready.sh installs them.
WITHOUT_KEY = {"ca-certificates", "ccache", "g++"}


def read(path):
    return xml.parse(ROOT / path).getroot()


NAMES = {read(path).findtext("name"): path for path in FILES}


def dependencies(path):
    return {element.text for element in read(path) if element.tag.endswith("depend")}


def text_of(folder, *patterns):
    """All files of a package, without those of packages inside it."""
    files = [file for pattern in patterns for file in (ROOT / folder).glob(pattern)]
    return "\n".join(file.read_text() for file in files)


def used(path):
    """Packages that the sources, CMake and launch files of a package name, outside its tests."""
    folder = path.parent
    cmake = text_of(folder, "CMakeLists.txt")
    calls = re.findall(r"find_packages?\(([^)]*)\)", cmake) + re.findall(r"set\(packages ([^)]*)\)", cmake)
    names = {word for call in calls for word in re.split(r"\s+(?:REQUIRED|QUIET|COMPONENTS)\b", call)[0].split()
             if not word.startswith("$")}
    code = text_of(folder, "src/**/*.cpp", "include/**/*.hpp", "interfaces/**/*.hpp")
    names |= set(re.findall(r"#\s*include <(\w+)/(?:msg|srv)/", code)) | set(re.findall(r'#\s*include "(ros\w+)/', code))
    names |= {"rclcpp"} & set(re.findall(r"#\s*include <(rclcpp)/", code))
    names |= {"rclcpp_components"} & set(re.findall(r"__has_include\(<(\w+)/", code))
    names |= {"eigen"} if "#include <Eigen/" in code else set()
    python = text_of(folder, "scripts/*.py")
    names |= set(re.findall(r"^(?:from|import) (rclpy|\w+_(?:msgs|srvs))\b", python, re.M))
    names |= {f"python3-{word}" for word in re.findall(r"^import (yaml|numpy)$", python, re.M)}
    launch = text_of(folder, "launch/*.xml")
    names |= set(re.findall(r'pkg="(\w+)"', launch)) | set(re.findall(r"find-pkg-share (\w+)\)", launch))
    names |= set(re.findall(r"rosflight_forward_program\(\S+ (\w+) ", cmake))
    if launch:
        names |= {"launch", "launch_xml"} | ({"launch_ros"} if "<node" in launch else set())
    return {FOUND.get(name, name) for name in names} - {None, read(path).findtext("name")}


@pytest.mark.parametrize("path", FILES, ids=str)
def test_a_package_names_all_that_it_uses(path):
    missing = used(path) - dependencies(path)
    assert not missing, f"{path}: no dependency on {', '.join(sorted(missing))}"


@pytest.mark.parametrize("path", FILES, ids=str)
def test_every_dependency_is_ours_or_known_to_rosdep(path):
    unknown = dependencies(path) - set(NAMES) - ROS - set(ROSDEP)
    assert not unknown, f"{path}: {', '.join(sorted(unknown))}"


def test_rosdep_installs_what_the_list_of_system_packages_has_for_a_build():
    wanted, chosen = set(), False
    for line in (ROOT / "tools/system_packages.txt").read_text().splitlines():
        if line.startswith("["):
            chosen = line == "[run]"
        elif chosen and line and not line.startswith("#"):
            wanted.add(line.split()[0])
    named = {ROSDEP[name] for name in dependencies(Path("package.xml")) if name in ROSDEP}
    assert wanted == named | WITHOUT_KEY


@pytest.mark.parametrize("path", FILES, ids=str)
def test_a_package_has_maintainer_licence_version_and_description(path):
    root = read(path)
    maintainer = root.find("maintainer")
    expected = read(Path("package.xml")).find("maintainer")
    assert (maintainer.text, maintainer.get("email")) == (expected.text, expected.get("email"))
    assert root.findtext("license") == "BSD-3-Clause"
    project = re.search(r"project\(rosflight VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]
    assert root.findtext("version") == project
    assert len(root.findtext("description")) > 30 and root.get("format") == "3"


def test_packages_are_there_under_all_names_of_rosflight_2():
    """But for headers that need none."""
    assert NAMES.keys() >= {
        "rosflight_msgs", "rosflight_io", "rosflight_sim", "rosflight_gcs", "rosflight_pkgs", "rosflight_rqt_plugins",
        "roscopter", "roscopter_msgs", "roscopter_sim", "roscopter_gcs", "roscopter_tuning",
        "rosplane", "rosplane_msgs", "rosplane_sim", "rosplane_gcs", "rosplane_tuning", "rosplane_extra"}
    assert dependencies(NAMES["rosflight_pkgs"]) >= NAMES.keys() - {
        "rosflight", "rosflight_pkgs", "rosflight_examples", "own_modules", "rosflight_demos"}


def test_nodes_are_registered_where_rclcpp_components_writes_them_down(tmp_path):
    """Its macro keeps them in variables of its caller, which must be the package's CMakeLists.txt. The commands of CMake that need a project
    are made up here."""
    (tmp_path / "rclcpp_componentsConfig.cmake").write_text("""
macro(rclcpp_components_register_nodes target)
  list(APPEND registered ${target} ${ARGN})
endmacro()
""")
    script = tmp_path / "package.cmake"
    made_up = "add_library add_executable set_target_properties target_compile_options target_include_directories target_link_libraries install"
    script.write_text("\n".join(f"function({command})\nendfunction()" for command in made_up.split()) + f"""
set(PROJECT_NAME some)
include({ROOT}/ros/rosflight_common/cmake/rosflight_common-extras.cmake)
rosflight_add_node(first CLASS some::First SOURCES first.cpp MAIN main.cpp)
rosflight_add_node(second CLASS some::Second SOURCES second.cpp)
message("${{registered}}")
""")
    told = subprocess.run(["cmake", f"-Drclcpp_components_DIR={tmp_path}", "-P", script], capture_output=True, text=True, check=True)
    assert told.stderr.strip() == "some_first;some::First;some_second;some::Second"

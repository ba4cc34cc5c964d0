# SPDX-License-Identifier: BSD-3-Clause
"""The rules of check_structure.py, each shown on a small tree that breaks it."""

import subprocess
from pathlib import Path

import check_structure as structure
import pytest

SPDX = "// SPDX-License-Identifier: BSD-3-Clause\n"


@pytest.fixture
def tree(tmp_path):
    def make(files: dict[str, str]) -> structure.Tree:
        for name, text in files.items():
            path = tmp_path / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        return structure.Tree(tmp_path, [Path(name) for name in files])

    return make


@pytest.mark.parametrize("path, included", [
    ("firmware/core/mixer.cpp", "link/messages.hpp"),
    ("firmware/core/mixer.cpp", "firmware/core/mixer.hpp"),
    ("firmware/boards/linux/main.cpp", "firmware/core/firmware.hpp"),
    ("firmware/boards/linux/test/board_test.cpp", "firmware/core/firmware.hpp"),
    ("log/writer.hpp", "sim/types.hpp"),
    ("flight/flight.cpp", "autonomy/path.hpp"),
    ("apps/fly_command.cpp", "flight/fly.hpp"),
    ("bench/loop.cpp", "flight/flight.hpp"),
    ("firmware/core/mixer.cpp", "base/constants.hpp"),
    ("firmware/core/test/mixer_test.cpp", "base/atomic_file.hpp"),
    ("firmware/boards/linux/board.cpp", "base/atomic_file.hpp"),
])
def test_include_that_the_table_allows(tree, path, included):
    assert structure.check_includes(tree({path: f'#include "{included}"\n'})) == []


@pytest.mark.parametrize("path, included", [
    ("flight/fly.cpp", "apps/command_line.hpp"),
    ("bench/loop.cpp", "apps/command_line.hpp"),
    ("examples/own/main.cpp", "apps/command_line.hpp"),
    ("ros/roscopter/src/node.cpp", "apps/command_line.hpp"),
    ("link/codec.hpp", "firmware/hal/time.hpp"),
    ("firmware/hal/roles.hpp", "link/messages.hpp"),
    ("firmware/core/mixer.cpp", "firmware/boards/linux/board.hpp"),
    ("firmware/core/test/mixer_test.cpp", "sim/types.hpp"),
    ("firmware/boards/linux/board.cpp", "firmware/core/firmware.hpp"),
    ("sim/world.cpp", "firmware/core/firmware.hpp"),
    ("log/writer.hpp", "sim/modules.hpp"),
    ("companion/client.cpp", "sim/types.hpp"),
    ("autonomy/path.cpp", "companion/client.hpp"),
    ("ros/roscopter/src/node.cpp", "apps/command_line.hpp"),
    ("ros/rosflight_io/src/node.cpp", "sim/types.hpp"),
    ("ros/rosplane/src/node.cpp", "flight/flight.hpp"),
    ("firmware/core/mixer.cpp", "base/atomic_file.hpp"),
    ("base/angles.hpp", "autonomy/path.hpp"),
])
def test_include_against_the_direction_names_file_line_and_what_is_allowed(tree, path, included):
    (complaint,) = structure.check_includes(tree({path: f'\n  # include "{included}"\n'}))
    assert complaint.startswith(f"{path}:2: ")
    assert f"must not include {included}; it may use: " in complaint


@pytest.mark.parametrize("line, count", [
    ("constexpr double kDegree = kPi / 180.0;", 1), ("x = 180.0 / std::numbers::pi;", 1), ("g = 9.80665F;", 1),
    ("x = angle * 0.017453292519943295;", 1), ("p / 101325.0f", 1), ("a = 6378137.0;", 1), ("rho{1.225}", 1), ("57.2957795", 1),
    ("// 1.225 kg/m^3", 0), ('say("9.80665");', 0), ("x = 19.80665;", 0), ("y = 1.2251;", 0), ("x = base::kPi;", 0),
])
def test_constant_that_stands_outside_base_is_told(tree, line, count):
    found = structure.check_constants(tree({"sim/a.cpp": line, "base/a.hpp": line, "sim/test/a_test.cpp": line}))
    assert len(found) == count


@pytest.mark.parametrize("path, namespace, count", [
    ("sim/world.cpp", "rosflight::sim", 0), ("sim/dynamics/body.cpp", "rosflight::sim", 0),
    ("sim/dynamics/body.cpp", "rosflight::sim::dynamics", 0), ("config/table.hpp", "rosflight::config::detail", 0),
    ("firmware/core/mixer.cpp", "rosflight::core", 0), ("ros/rosflight_io/src/node.cpp", "rosflight_io", 0),
    ("autonomy/multirotor/leg.cpp", "rosflight::autonomy::multirotor", 0),
    ("sim/test/world_test.cpp", "rosflight::other", 0), ("sim/portable_math.hpp", "rosflight::sim::portable", 0),
    ("autonomy/multirotor/leg.cpp", "rosflight::autonomy", 1), ("sim/world.cpp", "rosflight::simulation", 1),
    ("sim/world.cpp", "rosflight::sim::dynamics", 1), ("firmware/core/mixer.cpp", "rosflight::firmware", 1),
    ("log/a.hpp", "rosflight::messages", 1), ("ros/rosflight_io/src/node.cpp", "rosflight::io", 1),
    ("base/a.hpp", "rosflight", 1),
])
def test_namespace_is_the_folder(tree, path, namespace, count):
    assert len(structure.check_namespaces(tree({path: f"namespace {namespace} {{\n"}))) == count


def test_cpp_in_an_unknown_folder_is_told(tree):
    assert len(structure.check_includes(tree({"misc/a.cpp": ""}))) == 1


def test_include_that_hides_its_folder_is_told(tree):
    found = structure.check_rooted(tree({"sim/a.cpp": '#include "../firmware/core/a.hpp"\n'
                                                      '#include "b.hpp"\n#include "sim/c.hpp"\n'}))
    assert [line.split(":")[1] for line in found] == ["1", "2"]


@pytest.mark.parametrize("header", ["rclcpp/rclcpp.hpp", "sensor_msgs/msg/imu.hpp", "tf2_ros/buffer.h"])
def test_ros_header_is_for_ros_alone(tree, header):
    line = f"#include <{header}>\n"
    (complaint,) = structure.check_ros_free(tree({"sim/a.cpp": line, "ros/src/a.cpp": line}))
    assert complaint == f"sim/a.cpp:1: ROS header {header} outside ros/"


def test_circle_of_headers_is_told(tree):
    found = structure.check_cycles(tree({"sim/a.hpp": '#include "sim/b.hpp"\n',
                                         "sim/b.hpp": '#include "sim/a.hpp"\n'}))
    assert found == ["circle: sim/a.hpp -> sim/b.hpp -> sim/a.hpp"]


def test_circle_of_folders_in_the_table_is_told(tree, monkeypatch):
    monkeypatch.setitem(structure.MAY_INCLUDE, "link", ["companion"])
    assert structure.check_cycles(tree({})) == ["circle: link -> companion -> link"]


def test_licence_line_is_wanted_in_sources_and_scripts_only(tree):
    found = structure.check_licences(tree({
        "sim/good.cpp": SPDX, "sim/bad.cpp": "int a;\n", "CMakeLists.txt": "project(x)\n",
        "script": "#!/usr/bin/env bash\n", "README.md": "text\n", "data": "#!not a script\n"}))
    assert [line.split(":")[0] for line in found] == ["sim/bad.cpp", "CMakeLists.txt", "script"]


def test_file_of_others_is_told(tree):
    found = structure.check_licences(tree({
        "ros/rclcpp/timer.hpp": f"{SPDX}\n// Copyright 2014 Open Source Robotics Foundation, Inc.\n", "a.py": f"{SPDX}# (c) 2020 Somebody\n",
        "sim/own.cpp": f"{SPDX}// copyright is the project's, see LICENSE\n"}))
    assert [line.split(": ")[0] for line in found] == ["ros/rclcpp/timer.hpp:3", "a.py:2"]


def test_size_limits(tree, capsys):
    found = structure.check_sizes(tree({"a.cpp": "\n" * 601, "b.cpp": "\n" * 600, "c.csv": "\n" * 999}))
    assert found == ["a.cpp: 601 lines, at most 600"]
    assert "b.cpp has 600 lines" in capsys.readouterr().out


def test_folders_without_readme_are_told(tree):
    found = structure.check_readmes(tree({"sim/README.md": "", "sim/a.cpp": "", "docs/a.md": "",
                                          "firmware/README.md": "", "firmware/core/CMakeLists.txt": "",
                                          "sim/test/CMakeLists.txt": "", ".ci/run": ""}))
    assert found == ["docs: no README.md", "firmware/core: no README.md"]


def test_a_folder_of_four_units_has_a_readme(tree):
    units = [f"{name}.{suffix}" for name in "abc" for suffix in ("hpp", "cpp")]
    tops = {"sim/README.md": "", "ros/README.md": ""}
    four = {f"{folder}/{name}": "" for name in [*units, "d.py"]
            for folder in ("sim/wind", "sim/wind/test", "sim/fuzz", "ros/package/src")}
    three = {f"sim/ground/{name}": "" for name in units}
    assert structure.check_readmes(tree(tops | four | three)) == ["sim/wind: no README.md"]


def test_paths_in_documents_exist(tree):
    found = structure.check_paths(tree({
        "sim/a.cpp": "", "sim/README.md": "[up](../docs/x.md) [web](https://a.b/c) [here](#x)\n",
        "docs/x.md": "`sim/a.cpp` `sim/*.cpp` `build/release` `./sim/gone.hpp` `sim/b*` `a/b`\n"}))
    assert found == ["docs/x.md:1: no such path: sim/gone.hpp", "docs/x.md:1: no such path: sim/b*"]


def test_the_table_itself_has_no_circle(tree):
    assert structure.check_cycles(tree({})) == []


@pytest.mark.parametrize("uses, ways", [
    ("rosflight::autonomy", []),
    ("rosflight::autonomy rosflight::sim", ["estimation -> sim"]),
    ("rosflight::helper", ["estimation -> helper -> sim"]),
])
def test_library_that_links_the_world_it_is_judged_in_is_told(tree, uses, ways):
    found = structure.check_links(tree({
        "autonomy/estimation/CMakeLists.txt": f"rosflight_library(estimation\n  SOURCES a.cpp  # USES rosflight::sim\n  USES {uses})\n",
        "helper/CMakeLists.txt": "rosflight_library(helper SOURCES h.cpp USES rosflight::sim)\n",
    }))
    assert [line.split(": ")[1] for line in found] == ways


@pytest.mark.parametrize("path, line", [
    ("web/server/conversation.cpp", "#include <boost/beast/core.hpp>"),
    ("web/server/web_server.hpp", "#include <boost/beast/http.hpp>"),
    ("viewer/page_server.cpp", '#include "web/server/detail/site.hpp"'),
    ("web/server/test/access_test.cpp", '#include "web/server/detail/viewer.hpp"'),
    ("web/page.js", ""), ("web/node_modules/three/package.json", ""), ("build/web/index.html", ""), ("web/src/page.js.map", ""),
])
def test_beast_elsewhere_and_what_is_generated_are_complaints(tree, path, line):
    assert len(structure.check_web(tree({path: line + "\n"}))) == 1


def test_nothing_generated_is_committed():
    """own_files() leaves out folders that Git is asked for here."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=structure.project.ROOT, capture_output=True, text=True)
    if listed.returncode:
        pytest.skip("a source archive without git")
    files = [Path(name) for name in listed.stdout.split("\0") if name]
    assert Path("web/package-lock.json") in files
    assert structure.check_web(structure.Tree(structure.project.ROOT, [path for path in files if path.suffix not in (".cpp", ".hpp")])) == []


@pytest.mark.parametrize("path, line", [
    ("web/server/web_server.cpp", '#include "web/server/detail/http_session.hpp"'),
    ("web/server/detail/site.hpp", "#include <boost/beast/core.hpp>"),
    ("web/server/web_server.cpp", "#include <boost/asio/steady_timer.hpp>"),
    ("web/build.mjs", ""), ("web/src/page.html", ""), ("web/package-lock.json", ""),
])
def test_one_translation_unit_has_beast_and_sources_are_committed(tree, path, line):
    assert structure.check_web(tree({path: line + "\n"})) == []

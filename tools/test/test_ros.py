# SPDX-License-Identifier: BSD-3-Clause
"""./rosflight ros: its arguments, its environment, what it builds. No ROS is needed here."""

import io
import os
import re
import subprocess
import sys
import threading
import time
from pathlib import Path

import project
import pytest
import ros
import ros_build
import ros_environment
import ros_test
from project import ROOT


@pytest.fixture
def wheels(monkeypatch):
    """As if .venv-ros were there and whole."""
    environment = ros_environment.Environment(None, Path("/venv/bin/python3"), ["colcon"])

    def find(rclcpp=None):
        environment.rclcpp = rclcpp
        return environment
    monkeypatch.setattr(ros_environment, "find", find)
    return environment


@pytest.fixture
def house(tmp_path, monkeypatch, wheels):
    """A project of three packages; what colcon is asked to build is noted, not built."""
    for folder, name in (("ros_standin/rclcpp_lite", "rclcpp"), ("ros/msgs", "rosflight_msgs"),
                         ("ros/node", "house_node")):
        (tmp_path / folder / "test").mkdir(parents=True)
        (tmp_path / folder / "package.xml").write_text(f"<package><name>{name}</name></package>")
        (tmp_path / folder / "test" / f"test_{Path(folder).name}.py").touch()
    for module in (ros_build, ros_test, ros_environment, project):
        monkeypatch.setattr(module, "ROOT", tmp_path)
    monkeypatch.setattr(ros_environment, "PLACE", tmp_path / "build/ros")
    monkeypatch.setattr(project, "own_files", lambda: sorted(
        path.relative_to(tmp_path) for path in tmp_path.glob("ros*/**/*") if path.is_file()))
    asked = []

    def colcon(environment, folders, packages, place, flags):
        asked.append(list(packages))
        return True
    monkeypatch.setattr(ros_build, "_colcon", colcon)
    monkeypatch.setattr(project, "build", lambda preset, *targets: asked.append(["programs"]) or True)
    return asked


def refused(capsys, *words: str) -> str:
    assert ros.main(list(words)) == 2
    said = capsys.readouterr()
    assert not said.out and said.err.count("\n") == 1
    return said.err.strip()


def test_unknown_sub_command_is_refused_with_those_there_are(capsys):
    says = refused(capsys, "bild")
    assert says == ("rosflight: unknown sub-command 'bild' of ros; allowed: "
                    f"{', '.join(ros.SUBCOMMANDS)}")
    assert "unknown sub-command ''" in refused(capsys)


def test_unknown_package_is_refused_with_those_there_are(capsys, wheels):
    says = refused(capsys, "build", "rosflight_oi")
    assert "no package 'rosflight_oi' under ros/; allowed: " in says and "rosflight_io" in says


def test_run_wants_a_command_that_exists(capsys, wheels, monkeypatch):
    assert refused(capsys, "run") == "rosflight: ros run needs a command"
    monkeypatch.setattr(ros_build, "build", lambda environment: True)
    assert refused(capsys, "run", "no_such_program") == (
        "rosflight: cannot run 'no_such_program': No such file or directory")


def test_env_takes_no_argument(capsys):
    assert refused(capsys, "env", "zsh") == "rosflight: ros env takes no argument, got 'zsh'"


def test_unknown_test_is_refused_with_the_files_there_are(capsys, house):
    says = refused(capsys, "test", "nothing_like_it")
    assert "no test file under ros/ matches nothing_like_it" in says and "test_msgs.py" in says


@pytest.mark.parametrize("words", [["--help"], ["-h"], ["build", "--help"], ["env", "-h"]])
def test_help_names_every_sub_command(capsys, words):
    assert ros.main(words) == 0
    said = capsys.readouterr().out
    assert all(re.search(rf"^  {name}\b", said, re.M) for name in ros.SUBCOMMANDS)


def test_help_of_the_script_needs_no_machine_made_ready():
    done = subprocess.run([ROOT / "rosflight", "ros", "--help"], capture_output=True, text=True,
                          env={"PATH": "/usr/bin:/bin"})
    assert done.returncode == 0 and "Usage: ./rosflight ros SUBCOMMAND" in done.stdout


@pytest.mark.parametrize("words", [["--rclcpp"], ["build", "--rclcpp"]])
def test_rclcpp_wants_a_folder(capsys, words):
    assert refused(capsys, *words) == "rosflight: --rclcpp needs a folder"


def test_a_folder_without_rclcpp_is_refused(capsys, tmp_path):
    assert refused(capsys, "build", "--rclcpp", str(tmp_path)) == (
        f"rosflight: --rclcpp: found {tmp_path}, allowed a folder with the package rclcpp below it")


def test_what_is_run_keeps_its_own_option_of_that_name(wheels, monkeypatch):
    given = []
    monkeypatch.setattr(ros, "run", lambda words, rclcpp: given.append((words, rclcpp)) or 0)
    monkeypatch.setitem(ros.SUBCOMMANDS, "run", ros.run)
    assert ros.main(["run", "mine", "--rclcpp", "none"]) == 0
    assert given == [(["mine", "--rclcpp", "none"], None)]


def test_sources_of_rclcpp_are_built_first_and_ours_on_them(tmp_path, wheels, monkeypatch):
    sources = tmp_path / "peers"
    (sources / "rclcpp").mkdir(parents=True)
    (sources / "rclcpp/package.xml").write_text("<package><name>rclcpp</name></package>")
    built = []
    monkeypatch.setattr(ros_environment, "ROOT", tmp_path)
    monkeypatch.setattr(project, "build", lambda preset, *targets: True)
    monkeypatch.setattr(ros_build, "_colcon",
                        lambda environment, folders, packages, place, flags: built.append((folders, packages, place)) or True)
    place = tmp_path / "build/ros_rclcpp"
    for _ in range(2):
        assert ros.main(["build", "--rclcpp", str(sources), "rosflight_io"]) == 0
        # The standing-in rclcpp is not among what is built.
        assert built == [([str(sources)], [], place / "underlay"),
                         ([str(ROOT / "ros"), str(ROOT / "ros_standin/tf2_msgs")], ["rosflight_io"], place)]
    prefixes = wheels.variables()["AMENT_PREFIX_PATH"].split(":")
    assert prefixes[:2] == [str(place / "install"), str(place / "underlay/install")]
    modules = [prefix / "lib/python3.11/site-packages" for prefix in (place / "install", place / "underlay/install")]
    for folder in modules:
        folder.mkdir(parents=True)
    assert wheels.variables()["PYTHONPATH"].split(":")[:2] == [str(folder) for folder in modules]


def test_failed_build_ends_with_1(capsys, wheels, monkeypatch):
    monkeypatch.setattr(ros_build, "build", lambda environment, packages=(): False)
    assert ros.main(["build"]) == 1
    assert ros.main(["run", "true"]) == 1


def test_nothing_is_built_again_until_something_changes(house, wheels, tmp_path):
    place = tmp_path / "build/ros"
    for _ in range(2):
        assert ros_build.build(wheels, place=place)
    assert house == [[]]
    # What all were built from was built for one, too.
    assert ros_build.build(wheels, ["rosflight_msgs"], place)
    assert house == [[]]
    source = tmp_path / "ros/node/package.xml"
    os.utime(source, ns=(1, 1))
    for _ in range(2):
        assert ros_build.build(wheels, ["house_node"], place)
    assert house == [[], ["house_node"]]
    assert ros_build.build(wheels, place=place)
    assert house == [[], ["house_node"], []]


def test_two_builds_at_once_are_one_after_the_other_and_the_second_finds_the_work_done(house, wheels, tmp_path, monkeypatch):
    place = tmp_path / "build/ros"
    begun, go_on, running = threading.Event(), threading.Event(), []

    def colcon(*_):
        running.append(threading.current_thread())
        begun.set()
        assert go_on.wait(20)
        return True
    monkeypatch.setattr(ros_build, "_colcon", colcon)
    said = io.StringIO()  # pytest's own capture loses what another thread writes while it is read
    monkeypatch.setattr(sys, "stderr", said)
    threads = [threading.Thread(target=ros_build.build, args=(wheels, [], place)) for _ in range(2)]
    threads[0].start()
    assert begun.wait(20)
    threads[1].start()
    end = time.monotonic() + 20
    while "waiting for another build in ros" not in said.getvalue() and time.monotonic() < end:
        time.sleep(0.01)
    assert "rosflight: waiting for another build in ros\n" in said.getvalue() and running == [threads[0]]
    go_on.set()
    for thread in threads:
        thread.join(20)
    assert running == [threads[0]], "the second had nothing to build"


def test_a_package_below_another_is_no_package_of_ours(house, wheels, tmp_path):
    """colcon looks for none there: it is an example to copy."""
    (tmp_path / "ros/node/copy").mkdir()
    (tmp_path / "ros/node/copy/package.xml").write_text("<package><name>to_copy</name></package>")
    assert ros_build.package_names() == ["house_node", "rclcpp", "rosflight_msgs"]


def test_a_package_that_has_moved_is_configured_again(house, wheels, tmp_path):
    place = tmp_path / "build/ros"
    (tmp_path / "ros/node/CMakeLists.txt").touch()
    for package, source in (("moved", "ros/old_folder"), ("stays", "ros/node")):
        (place / "build" / package).mkdir(parents=True)
        (place / "build" / package / "CMakeCache.txt").write_text(
            f"CMAKE_HOME_DIRECTORY:INTERNAL={tmp_path / source}\n")
    assert ros_build.build(wheels, place=place)
    assert [folder.name for folder in (place / "build").iterdir()] == ["stays"]


def test_the_libraries_are_built_for_the_packages_that_use_them_only(house, wheels, tmp_path):
    place, names = tmp_path / "build/ros", ("rclcpp", "rosflight_msgs")
    (tmp_path / "ros/node/package.xml").write_text(
        "<package><name>house_node</name><depend>rosflight</depend></package>")
    assert ros_build.build(wheels, names, place)
    assert house == [["rclcpp", "rosflight_msgs"]]
    assert ros_build.build(wheels, ["house_node"], place)
    assert house[1:] == [["programs"], ["house_node"]]


def test_a_failed_build_is_tried_again(house, wheels, tmp_path, monkeypatch):
    monkeypatch.setattr(ros_build, "_colcon", lambda *_: house.append("tried"))
    for _ in range(2):
        assert not ros_build.build(wheels, place=tmp_path / "build/ros")
    assert house == ["tried", "tried"]


def test_a_folder_may_be_named_for_its_package(house, wheels, tmp_path):
    assert ros_build.build(wheels, ["rclcpp_lite"], tmp_path / "build/ros")
    assert house == [["rclcpp"]]


@pytest.fixture
def ran(monkeypatch):
    """Names of the files that would have been given to pytest, for each run."""
    runs = []
    monkeypatch.setattr(ros_test, "_pytest",
                        lambda environment, files, place: runs.append([path.stem for path in files]))
    return runs


def test_tests_that_need_their_own_package_only_build_no_more(house, ran):
    ros_test.run(["test_msgs", "lite"])
    assert house == [["rclcpp", "rosflight_msgs"]]
    ros_test.run(["test_node"])
    assert house[1:] == [["programs"], []]
    ros_test.run()
    assert ran == [["test_msgs", "test_rclcpp_lite"], ["test_node"],
                   ["test_msgs", "test_node", "test_rclcpp_lite"]]


def test_an_installation_is_not_tested_with_what_stands_in_for_it(house, wheels, ran):
    wheels.installed = "humble"
    ros_test.run()
    assert ran == [["test_msgs", "test_node"]]
    assert (ros_test.sanitizers().passed, len(ran)) == (0, 1)


# ---- the environment -----------------------------------------------------------------------------


def install(prefix: Path) -> Path:
    config = prefix / "share/rclcpp/cmake/rclcppConfig.cmake"
    config.parent.mkdir(parents=True)
    config.touch()
    return prefix


@pytest.mark.parametrize("name, found", [("humble", "humble"), ("jazzy", "jazzy"), ("", None),
                                         ("foxy", None)])
def test_only_a_known_installation_counts(tmp_path, monkeypatch, name, found):
    monkeypatch.setenv("ROS_DISTRO", name)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(install(tmp_path / "opt")))
    assert ros_environment.sourced() == found


def test_our_own_rclcpp_is_no_installation(tmp_path, monkeypatch):
    monkeypatch.setattr(ros_environment, "PLACE", tmp_path)
    monkeypatch.setenv("ROS_DISTRO", "jazzy")
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{install(tmp_path / 'install')}:/none")
    assert ros_environment.sourced() is None


def test_variables_put_ours_in_front_once_and_keep_the_rest(tmp_path, monkeypatch, wheels):
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"/other:{tmp_path}/install")
    variables = wheels.variables(tmp_path)
    assert variables["AMENT_PREFIX_PATH"] == f"{tmp_path}/install:{ros_environment.VENV}:/other"
    wheels.installed = "jazzy"
    variables = wheels.variables(tmp_path)
    assert variables["AMENT_PREFIX_PATH"] == f"{tmp_path}/install:/other"
    assert "RMW_IMPLEMENTATION" not in variables and "VIRTUAL_ENV" not in variables


def test_printed_environment_is_read_by_a_shell(tmp_path, monkeypatch, capsys, wheels):
    monkeypatch.setenv("PATH", f"{os.environ['PATH']}:/a folder/with 'quotes'")
    assert ros.main(["env"]) == 0
    done = subprocess.run(["bash", "-c", f'{capsys.readouterr().out}\nprintf %s "$PATH"'],
                          capture_output=True, text=True, check=True)
    assert done.stdout == wheels.variables()["PATH"]
    assert "with 'quotes'" in done.stdout


# ---- what common code may use --------------------------------------------------------------------


def calls(text: str, name: str):
    """The arguments of every call of a template function, as texts split at the outer commas."""
    for found in re.finditer(rf"\b{name}<", text):
        start = text.find("(", found.end())
        depth, arguments, current = 0, [], ""
        for letter in text[start:]:
            depth += letter in "([{"
            depth -= letter in ")]}"
            if depth == 0:
                break
            if letter == "," and depth == 1:
                arguments.append(current)
                current = ""
            elif not (depth == 1 and letter == "("):
                current += letter
        yield [*arguments, current]


# Jazzy's alone, or gone in it.
NOT_IN_BOTH = (r"add_p(re|ost)_set_parameters_callback|->create_timer\(|[^:\w]create_timer\(|"
               r"ament_auto|rclcpp::ROSRate|BestAvailable|create_generic_(?!subscription)|get_type_hash|"
               r"get_clock\(\)->now\(\)")  # not const in Humble; now() of the node is


def node_sources() -> list[Path]:
    return [path for path in project.own_files() if path.parts[0] == "ros"
            and path.suffix in (".cpp", ".hpp")]


def test_calls_are_split_at_their_outer_commas():
    text = "create_service<A>(\n name, [this](int a, int b) { f(a, b); }); create_service<B>(x);"
    assert [len(arguments) for arguments in calls(text, "create_service")] == [2, 1]


def test_nodes_use_only_what_humble_and_jazzy_both_have():
    sources = {path: (ROOT / path).read_text() for path in node_sources()}
    assert len(sources) > 10
    wrong = [f"{path}: {found[0]}" for path, text in sources.items()
             for found in re.finditer(NOT_IN_BOTH, text)]
    # The argument after the callback or the name has one type in Humble and another in Jazzy.
    for path, text in sources.items():
        for function, most in (("create_service", 2), ("create_client", 1)):
            wrong += [f"{path}: {function} with {len(arguments)} arguments"
                      for arguments in calls(text, function) if len(arguments) > most]
    assert not wrong

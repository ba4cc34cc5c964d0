# SPDX-License-Identifier: BSD-3-Clause
"""The Python launch files, which no machine without ROS runs: what follows the end of a process. Its classes are stood in for."""

import atexit
import re
import sys
import types

import pytest
from ros_rig import ROOT

SCRIPT = ROOT / "ros/rosflight_common/cmake/launch.py.in"


@pytest.fixture
def script(monkeypatch):
    """The script as a module, on classes that keep what they are made with."""
    def kind(name):
        return type(name, (), {"__init__": lambda self, *words, **named: self.__dict__.update(words=words, **named)})
    for name, classes in {"launch": ["LaunchDescription"], "launch.actions": ["IncludeLaunchDescription", "RegisterEventHandler", "Shutdown"],
                          "launch.event_handlers": ["OnProcessExit"], "launch_xml": [],
                          "launch_xml.launch_description_sources": ["XMLLaunchDescriptionSource"]}.items():
        module = types.ModuleType(name)
        module.__dict__.update({each: kind(each) for each in classes})
        monkeypatch.setitem(sys.modules, name, module)
    last = []
    monkeypatch.setattr(atexit, "register", lambda function, *words, **_: last.append(words))
    module = types.ModuleType("script")
    module.__dict__.update(__file__="/share/launch/it.launch.py", last=last)
    exec(compile(SCRIPT.read_text(), str(SCRIPT), "exec"), module.__dict__)
    return module


def ended(name, code):
    return types.SimpleNamespace(process_name=f"{name}-1", cmd=[f"/opt/lib/rosflight_sim/{name}", "--ros-args"], returncode=code)


RUNNING, STOPPING = (types.SimpleNamespace(is_shutdown=stopped) for stopped in (False, True))


@pytest.mark.parametrize("code", [-11, 0, 1])
def test_a_node_that_the_others_need_ends_the_launch_with_one_line_last(script, code):
    action, = script.end_of(ended("sil_board", code), RUNNING)
    assert type(action).__name__ == "Shutdown"
    assert script.last == [(f"launch: sil_board-1 ended with exit code {code}",)]


@pytest.mark.parametrize("event, context", [(ended("rviz2", 1), RUNNING), (ended("init_firmware", 0), RUNNING),
                                            (ended("rosflight_io", -9), RUNNING), (ended("sil_board", -2), STOPPING)])
def test_others_may_end_and_all_do_when_the_launch_is_stopped(script, event, context):
    assert script.end_of(event, context) is None and not script.last


def test_the_script_includes_the_file_beside_it_and_watches_its_processes(script):
    handler, include = script.generate_launch_description().words[0]
    assert handler.words[0].on_exit is script.end_of
    assert include.words[0].words == ("/share/launch/it.launch.xml",)


def test_it_names_the_programs_that_the_xml_files_shut_down_for(script):
    found = {exec_ for file in ROOT.glob("ros/*/launch/*.xml")
             for exec_ in re.findall(r'<node pkg="\w+" exec="(\w+)"[^>]*on_exit="shutdown"', file.read_text())}
    assert found == script.NEEDED

# SPDX-License-Identifier: BSD-3-Clause
"""Processes of a launch, each a small Python script: lines, readiness, death, end. No ROS."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from ros_launch.test.installed import Installed

PROGRAM = Path(__file__).resolve().parents[1]
LONG_S = 30.0  # far beyond what anything here takes

SERVER = """
import os, signal, sys, time
print("ready", flush=True)
open({marks!r} + "/" + str(os.getpid()), "w").close()
while True: time.sleep(1)
"""
STUBBORN = """
import os, signal, time
signal.signal(signal.SIGINT, signal.SIG_IGN)
signal.signal(signal.SIGTERM, signal.SIG_IGN)
print("ready", flush=True)
open({marks!r} + "/" + str(os.getpid()), "w").close()
while True: time.sleep(1)
"""
PARENT = """
import os, subprocess, sys, time
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(1000)"], start_new_session=True)
open({marks!r} + "/" + str(child.pid), "w").close()
print("[INFO] [1.0] [n]: ready", flush=True)
while True: time.sleep(1)
"""


class Launch:
    def __init__(self, prefix: Path):
        self.place = Installed(prefix)
        self.marks = prefix / "marks"
        self.marks.mkdir()
        self.process = None

    def package(self, **scripts):
        marks = str(self.marks)
        self.place.package("world", **{name: text.replace("{marks!r}", repr(marks))
                                       for name, text in scripts.items()})

    def start(self, *nodes: str, words=()):
        xml = "".join(f'<node pkg="world" exec="{n}" name="{n}"/>' if "<" not in n else n for n in nodes)
        file = self.place.launch_file(f"<launch>{xml}</launch>")
        self.process = subprocess.Popen(
            [sys.executable, str(PROGRAM), str(file), *words], stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, text=True, start_new_session=True,
            env={**os.environ, "AMENT_PREFIX_PATH": str(self.place.prefix)})
        return self

    def until(self, text: str) -> list[str]:
        """Lines up to the one with the text."""
        lines = []
        end = time.monotonic() + LONG_S
        while time.monotonic() < end:
            line = self.process.stdout.readline()
            lines.append(line.rstrip("\n"))
            if text in line:
                return lines
            if not line:
                break
        raise AssertionError(f"no line with {text!r} in:\n" + "\n".join(lines))

    def end(self) -> tuple[int, str]:
        rest, _ = self.process.communicate(timeout=LONG_S)
        return self.process.returncode, rest

    def left(self) -> list[str]:
        return [mark.name for mark in self.marks.iterdir() if Path("/proc", mark.name).exists()]


@pytest.fixture
def launch(tmp_path):
    it = Launch(tmp_path)
    yield it
    if it.process and it.process.poll() is None:
        it.process.kill()
        it.process.communicate()
    for mark in it.marks.iterdir():
        try:
            os.kill(int(mark.name), signal.SIGKILL)
        except ProcessLookupError:
            pass


def test_lines_carry_the_name_and_ready_comes_once(launch):
    launch.package(a=SERVER, b="print('words')\n" + SERVER)
    lines = launch.start("a", "b").until("ready: 2 nodes in ")
    assert "[b] words" in lines
    assert not any(line.startswith("[a]") for line in lines), "its `ready` is the launch's"
    launch.process.send_signal(signal.SIGINT)
    code, rest = launch.end()
    assert code == 0
    assert "ready:" not in rest
    assert launch.left() == []


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_all(launch, number):
    launch.package(a=SERVER, parent=PARENT)
    launch.start("a", "parent").until("ready: 2")
    launch.process.send_signal(number)
    assert launch.end()[0] == 0
    assert launch.left() == []


def test_nodes_that_share_a_process_count_each(launch):
    launch.package(a=SERVER, shared=SERVER.replace('"ready"', '"[INFO] [1.5] [x]: ready: 3 nodes in one process"'))
    lines = launch.start("a", "shared").until("ready: 4 nodes in ")
    assert len([line for line in lines if "ready" in line]) == 1, "once, for all"


def test_a_job_that_says_not_ready_is_waited_for(launch):
    launch.package(a=SERVER, job="import time\nprint('not ready: loads something', flush=True)\ntime.sleep(1.5)\nprint('loaded')\n")
    lines = launch.start("a", "job").until("ready: 2 nodes in ")
    assert lines.index("[job] loaded") < len(lines) - 1 and not any("has finished" in line for line in lines)


def test_a_node_that_was_not_ready_and_then_is_has_become_a_server(launch):
    launch.package(a="import time\nprint('not ready: loads', flush=True)\ntime.sleep(0.5)\n" + SERVER)
    assert "[a] not ready: loads" in launch.start("a").until("ready: 1 node in ")


def test_a_node_that_will_not_end_is_killed(launch):
    launch.package(stubborn=STUBBORN)
    launch.start("stubborn").until("ready: 1 node in")
    launch.process.send_signal(signal.SIGINT)
    code, rest = launch.end()
    assert code == 0
    assert "stubborn still there, sending SIGTERM" in rest
    assert "stubborn still there, sending SIGKILL" in rest
    assert launch.left() == []


def test_a_death_takes_the_launch_down_and_says_who_and_why(launch):
    launch.package(a=SERVER, mortal="import sys\nprint('ready', flush=True)\n"
                   "print('out of fuel', flush=True)\nsys.exit(7)\n")
    code, rest = launch.start("a", "mortal").end()
    assert code == 1
    assert "launch: mortal (world/mortal) ended with exit code 7; its last lines:" in rest
    assert "    out of fuel" in rest
    assert rest.splitlines()[-1] == "launch: mortal (world/mortal) ended with exit code 7"
    assert launch.left() == []


def test_a_node_that_refuses_its_input_is_the_last_line_and_the_code(launch):
    launch.package(a=SERVER, picky="import sys\nprint('reading')\nprint('x: found 1, allowed 2', file=sys.stderr)\nsys.exit(2)\n")
    code, rest = launch.start("a", "picky").end()
    assert code == 2
    assert rest.splitlines()[-1] == "launch: picky (world/picky) refused to start: x: found 1, allowed 2"
    assert "ready:" not in rest
    assert launch.left() == []


def test_death_by_signal_has_its_name(launch):
    launch.package(mortal="import os\nos.kill(os.getpid(), 11)\n")
    code, rest = launch.start("mortal").end()
    assert code == 1
    assert "signal 11 (SIGSEGV)" in rest


def test_a_server_that_leaves_politely_is_missed_too(launch):
    launch.package(a=SERVER, leaver="print('ready', flush=True)\n")
    code, rest = launch.start("a", "leaver").end()
    assert code == 1
    assert "leaver (world/leaver) ended with exit code 0" in rest


def test_a_job_may_finish_and_the_launch_ends_with_the_last(launch):
    launch.package(job="print('done')\n", late="import time\ntime.sleep(0.5)\n")
    code, rest = launch.start("job", "late").end()
    assert code == 0
    assert "[job] done" in rest
    assert "launch: late has finished" in rest


def test_a_last_line_without_an_end_is_not_lost(launch):
    launch.package(job="import sys\nsys.stdout.write('no newline')\n")
    assert "[job] no newline\n" in launch.start("job").end()[1]


def test_a_flood_of_lines_is_passed_on_whole(launch):
    launch.package(job="for n in range(20000): print('line', n)\n")
    rest = launch.start("job").end()[1]
    assert sum(line.startswith("[job] line ") for line in rest.splitlines()) == 20000


def test_a_node_gets_its_parameters_and_names(launch):
    launch.package(job="import sys\nprint(sys.argv[1:])\n"
                   "print(open(sys.argv[sys.argv.index('--params-file') + 1]).read())\n")
    rest = launch.start('<set_parameter name="y" value="\'true\'"/><node pkg="world" exec="job" name="n" namespace="air" args="word">'
                        '<param name="x" value="2"/><remap from="a" to="b"/></node>').end()[1]
    assert "['word', '--ros-args', '-r', '__node:=n', '-r', '__ns:=/air', '-p', 'y:=true', '--params-file'," in rest
    assert "'-r', 'a:=b']" in rest
    assert "x: 2" in rest


def test_an_executable_is_up_when_it_runs(launch):
    launch.package()
    launch.start(f'<executable cmd="{sys.executable} -c \'import time; time.sleep(1000)\'" name="s"/>')
    launch.until("ready: 1 node in")


def test_a_killed_launch_leaves_no_node(launch):
    launch.package(a=SERVER)
    launch.start("a").until("ready: 1")
    launch.process.kill()
    launch.process.communicate()
    end = time.monotonic() + LONG_S
    while launch.left() and time.monotonic() < end:
        time.sleep(0.05)
    assert launch.left() == []


@pytest.mark.parametrize("nodes, words, said", [
    (["none"], [], "'none', allowed one of a"),
    (["a"], ["x:=1"], "'x', allowed nothing"),
    (["a"], ["--shwo"], "'--shwo', allowed one of"),
    ([], [], "nothing to start"),
])
def test_wrong_input_is_one_line_and_nothing_starts(launch, nodes, words, said):
    launch.package(a=SERVER)
    code, rest = launch.start(*nodes, words=words).end()
    assert code == 2
    assert said in rest
    assert rest.count("\n") == 1
    assert list(launch.marks.iterdir()) == []


def test_check_starts_nothing(launch):
    launch.package(a=SERVER)
    assert launch.start("a", words=["--check"]).end() == (0, "1 nodes: a\n")


def test_arguments_are_shown(launch):
    launch.package(a=SERVER)
    code, rest = launch.start('<arg name="rate" default="4" description="of the loop [Hz]"/>'
                              '<arg name="who"><choice value="me"/></arg>', words=["--show-args"]).end()
    assert code == 0
    assert rest == ("rate (default '4')\n    of the loop [Hz]\nwho (no default)\n    one of me\n")

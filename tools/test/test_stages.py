# SPDX-License-Identifier: BSD-3-Clause
"""How ./rosflight test counts, chooses and goes on after a failure."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import cpp_tests
import lanes
import pytest
import pytest_files
import ros_test
import run_tests
import stages
import tidy
from cpp_tests import Binary, Outcome
from lanes import ALONE, COMPUTES, WAITS, Stage

REPORT = """<testsuites><testsuite name="A">
<testcase name="Good" status="run" classname="A"/>
<testcase name="Bad" status="run" classname="A"><failure message="no"/></testcase>
<testcase name="Left" status="run" classname="A"><skipped/></testcase>
<testcase name="Off" status="notrun" classname="A"/>
</testsuite></testsuites>"""


def gtest_like(tmp_path, body: str, **options) -> Binary:
    """A program that is called as a GoogleTest binary; $report is where it should write."""
    script = tmp_path / "program"
    script.write_text(f'#!/bin/bash\nreport="${{1#--gtest_output=xml:}}"\n{body}\n')
    script.chmod(0o755)
    return Binary("program", [str(script)], str(tmp_path), counts_cases=True, **options)


def test_cases_of_a_report_are_counted_without_skipped_ones(tmp_path):
    (tmp_path / "text").write_text(REPORT)
    program = gtest_like(tmp_path, 'echo saying; cat text >"$report"; exit 1')
    outcome = cpp_tests.run(program, tmp_path / "results")
    assert (outcome.passed, outcome.failed) == (1, 1)
    assert outcome.complaints == ["program: A.Bad failed", "    saying"]


@pytest.mark.parametrize("body, complaint", [
    ("kill -SEGV $$", "ended with -11"),
    ("exec sleep 20", "did not end within 0.3 s"),
    ('echo "<testsuites/>" >"$report"', "holds no test case"),
    ('grep -v failure text >"$report"; exit 1', "ended with 1"),
])
def test_program_that_crashes_hangs_or_tests_nothing_fails_once(tmp_path, body, complaint):
    (tmp_path / "text").write_text(REPORT)
    outcome = cpp_tests.run(gtest_like(tmp_path, body, timeout_s=0.3), tmp_path / "results")
    assert outcome.failed == 1
    assert outcome.complaints[0] == f"program: {complaint}"


def test_report_of_an_earlier_run_does_not_count(tmp_path):
    (tmp_path / "results").mkdir()
    (tmp_path / "results/program.xml").write_text(REPORT)
    outcome = cpp_tests.run(gtest_like(tmp_path, "exit 1"), tmp_path / "results")
    assert (outcome.passed, outcome.failed) == (0, 1)


def test_tests_are_listed_before_they_are_built_and_fail_unbuilt(tmp_path, monkeypatch):
    monkeypatch.setattr(cpp_tests.project, "ROOT", tmp_path)
    build = tmp_path / "build/release"
    build.mkdir(parents=True)
    (build / "CTestTestfile.cmake").write_text(
        f'add_test(new_test "{build}/new_test")\nset_tests_properties(new_test PROPERTIES LABELS "gtest;of sim")\n')
    found, = cpp_tests.find("release")
    assert (found.name, found.command, found.part, found.counts_cases) == ("new_test", [], "sim", True)
    assert stages._run_binaries("release")["new_test"].complaints == ["new_test: not built"]


def broken():
    raise RuntimeError("no compiler")


def test_last_line_is_the_sum_and_a_broken_stage_hides_no_other(monkeypatch, capsys):
    monkeypatch.setattr(run_tests, "STAGES", {
        "one": Stage(lambda: Outcome(passed=3)), "two": Stage(broken),
        "three": Stage(lambda: Outcome(passed=4, failed=2, complaints=["why"]))})
    assert run_tests.main([]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[-1] == "7 passed, 3 failed"
    assert "   RuntimeError: no compiler" in lines and "   why" in lines
    assert run_tests.main(["one"]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "3 passed, 0 failed"


@pytest.mark.parametrize("breaks, said", [
    (lambda: os.kill(os.getpid(), signal.SIGKILL), "broke off with -9, nothing counted"),
    (lambda: sys.exit(0), "broke off with 1, nothing counted"),
    (lambda: None, "broke off with 1, nothing counted"),
])
@pytest.mark.parametrize("lane", [ALONE, COMPUTES])
def test_stage_that_leaves_no_count_is_a_failure(breaks, said, lane, capsys):
    rows, _ = lanes.run([("dies", Stage(breaks, lane)), ("good", Stage(lambda: Outcome(passed=2), WAITS))])
    found = {row.name: row.outcome for row in rows}
    assert (found["dies"].passed, found["dies"].failed, found["dies"].complaints) == (0, 1, [said])
    assert found["good"].passed == 2
    assert f"   {said}" in capsys.readouterr().out.splitlines()


def say(word):
    """Speaks to both streams and through a program, slowly enough for another stage to fall in between."""
    def run():
        for _ in range(3):
            print(f"{word} out", flush=True)
            subprocess.run(["sh", "-c", f"echo {word} program; echo {word} error >&2; sleep 0.05"])
        return Outcome(passed=1)
    return run


def test_stages_run_beside_each_other_and_their_words_are_not_mixed(capsys):
    rows, minutes = lanes.run([("a", Stage(say("A"), WAITS)), ("b", Stage(say("B"), COMPUTES)),
                               ("c", Stage(say("C"), WAITS))])
    printed = capsys.readouterr().out
    for name in "abc":
        block = printed.split(f"== {name}\n")[1].splitlines()[:9]
        assert block == [f"{name.upper()} {kind}" for _ in range(3) for kind in ("out", "program", "error")]
    assert sorted(row.name for row in rows) == ["a", "b", "c"]
    assert [row.name for row in rows if row.name != "b"] == ["a", "c"]  # one lane, one after the other


def test_lanes_run_at_the_same_time_and_computing_gives_way(tmp_path):
    def meet(mine, other):
        def run():
            (tmp_path / mine).write_text(str(os.nice(0)))
            end = time.monotonic() + 20
            while not (tmp_path / other).exists() and time.monotonic() < end:
                time.sleep(0.01)
            return Outcome(passed=int((tmp_path / other).exists()))
        return run
    rows, _ = lanes.run([("a", Stage(meet("a", "b"), WAITS)), ("b", Stage(meet("b", "a"), COMPUTES))])
    assert [row.outcome.passed for row in rows] == [1, 1]
    waits, computes = (int((tmp_path / name).read_text()) for name in "ab")
    assert waits == os.nice(0) < computes == min(19, waits + 19)


def test_stages_alone_come_before_the_lanes_and_processor_time_is_told():
    def compute():
        end = time.process_time() + 0.3
        while time.process_time() < end:
            pass
        return Outcome(passed=1)
    rows, _ = lanes.run([("lane", Stage(lambda: Outcome(passed=1), WAITS)), ("alone", Stage(compute))])
    assert [row.name for row in rows] == ["alone", "lane"]
    assert rows[0].processor_minutes >= 0.3 / 60 > rows[1].processor_minutes


def test_quick_is_a_few_stages_and_stays_so_beside_other_names():
    assert [name for name, _ in run_tests.chosen_stages(["quick"])] == list(run_tests.QUICK)
    assert [name for name, _ in run_tests.chosen_stages(["tidy", "quick", "unit"])] == ["tidy", *run_tests.QUICK]


def test_without_a_name_every_stage_runs_but_those_on_request():
    every = [name for name, _ in run_tests.chosen_stages([])]
    assert set(every) == set(run_tests.STAGES) - run_tests.ON_REQUEST and len(every) == len(set(every))


def pytest_file(folder, name, text):
    (folder / name).write_text(text)
    return folder / name


def test_pytest_files_are_counted_each_and_one_that_dies_is_a_failure(tmp_path):
    files = [
        pytest_file(tmp_path, "test_a.py", "def test_good(): pass\ndef test_bad(): assert 1 == 2, 'never'\n"),
        pytest_file(tmp_path, "test_b.py", "import os\ndef test_dies(): os._exit(0)\n"),
        pytest_file(tmp_path, "test_c.py", "import pytest\ndef test_good(): pass\ndef test_left(): pytest.skip()\n"),
        pytest_file(tmp_path, "test_d.py", "import nothing_of_this_name\n"),
    ]
    outcome = pytest_files.run(files, sys.executable, tmp_path / "reports")
    assert (outcome.passed, outcome.failed) == (2, 3)
    assert "never" in "\n".join(outcome.complaints) and "nothing_of_this_name" in "\n".join(outcome.complaints)


def test_pytest_files_run_in_lanes_of_their_own_environment(tmp_path):
    text = ("import os, pathlib, time\ndef test_meets():\n"
            "    here = pathlib.Path(__file__).parent\n    (here / os.environ['LANE']).touch()\n"
            "    while not ((here / '0').exists() and (here / '1').exists()): time.sleep(0.01)\n")
    files = [pytest_file(tmp_path, f"test_{name}.py", text) for name in "ab"]
    outcome = pytest_files.run(files, sys.executable, tmp_path / "reports", lanes=2,
                               environment=lambda lane: {**os.environ, "LANE": str(lane)})
    assert (outcome.passed, outcome.failed) == (2, 0)


def test_two_lanes_of_ros_tests_do_not_hear_each_other(monkeypatch):
    monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    assert ros_test.domain(0) != ros_test.domain(1)
    assert all(1 <= int(ros_test.domain(lane)) <= 101 for lane in (0, 1))


def test_runs_of_ros_tests_at_one_time_have_domains_of_their_own_and_give_them_back(monkeypatch):
    monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    monkeypatch.setattr(ros_test.os, "getpid", lambda: 7)  # in all three: the worst case
    ros_test._first_domain.cache_clear()
    tools = Path(ros_test.__file__).parent
    script = "import os, ros_test; os.getpid = lambda: 7; print(ros_test.domain(), flush=True); input()"
    mine = int(ros_test.domain())
    with subprocess.Popen([sys.executable, "-c", script], cwd=tools, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as other:
        try:
            theirs = int(other.stdout.readline())
        finally:
            other.kill()
    assert abs(theirs - mine) >= pytest_files.ROS_LANES
    with subprocess.Popen([sys.executable, "-c", script], cwd=tools, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as third:
        try:
            assert int(third.stdout.readline()) == theirs
        finally:
            third.kill()


def test_names_choose_stages_programs_and_pytest_files(monkeypatch):
    monkeypatch.setattr(stages, "test_names", lambda: ["core_mixer_test", "sim_wind_test"])
    assert [name for name, _ in run_tests.chosen_stages(["format"])] == ["format"]
    assert [name for name, _ in run_tests.chosen_stages(["mixer"])] == ["unit"]
    assert [name for name, _ in run_tests.chosen_stages(["test_bench", "tidy"])] == ["tidy", "python"]


def test_name_that_matches_nothing_is_one_line_and_exit_code_2(monkeypatch, capsys):
    monkeypatch.setattr(stages, "test_names", lambda: ["core_mixer_test"])
    assert run_tests.main(["mixxer"]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.count("\n") == 1
    assert "found mixxer, allowed" in said.err and "core_mixer_test" in said.err


def test_tidy_looks_again_when_source_header_command_or_configuration_change(tmp_path):
    source, header = tmp_path / "a.cpp", tmp_path / "a.hpp"
    source.write_text("1")
    header.write_text("2")
    entry = {"file": str(source), "command": "g++ a.cpp"}
    keys = [tidy.key_of(entry, [header], b"configuration")]
    keys.append(tidy.key_of(entry, [header], b"another"))
    keys.append(tidy.key_of({**entry, "command": "g++ -O2 a.cpp"}, [header], b"configuration"))
    header.write_text("3")
    keys.append(tidy.key_of(entry, [header], b"configuration"))
    source.write_text("4")
    keys.append(tidy.key_of(entry, [header], b"configuration"))
    assert len(set(keys)) == 5
    assert keys[-1] == tidy.key_of(entry, [header], b"configuration")


def test_tidy_remembers_for_every_clone_alike(tmp_path, monkeypatch):
    keys = []
    for clone in ("one", "another"):
        monkeypatch.setattr(tidy.project, "ROOT", tmp_path / clone)
        (tmp_path / clone).mkdir()
        source, header = tmp_path / clone / "a.cpp", tmp_path / clone / "a.hpp"
        source.write_text("1")
        header.write_text("2")
        keys.append(tidy.key_of({"file": str(source), "command": f"g++ -I{source.parent} {source}"}, [header], b""))
    assert keys[0] == keys[1]


def test_tidy_remembers_in_the_build_when_the_home_folder_takes_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(tidy.project, "ROOT", tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert tidy.memory() == tmp_path / "cache/rosflight/clang_tidy"
    monkeypatch.setenv("XDG_CACHE_HOME", "/proc")
    assert tidy.memory() == tmp_path / "build/clang_tidy/clean"


def test_tidy_sees_no_precompiled_headers():
    entry = {"file": "a.cpp", "command": "g++ -Winvalid-pch -include /b/lib.dir/cmake_pch.hxx -fpch-preprocess -O2 -include own.hpp -c a.cpp"}
    assert tidy.without_precompiled(entry)["command"] == "g++ -O2 -include own.hpp -c a.cpp"


def test_tidy_looks_at_each_file_of_those_compiled_together(tmp_path):
    together = tmp_path / "Unity/unity_0_cxx.cxx"
    together.parent.mkdir()
    together.write_text('/* generated */\n#include "/p/a.cpp"\n\n#include "/p/b.cpp"\n')
    entry = {"file": str(together), "command": f"g++ -O2 -c {together}", "output": "unity.o"}
    assert [(one["file"], one["command"]) for one in tidy.file_by_file(entry)] == [
        ("/p/a.cpp", "g++ -O2 -c /p/a.cpp"), ("/p/b.cpp", "g++ -O2 -c /p/b.cpp")]
    alone = {"file": "/p/a.cpp", "command": "g++ -c /p/a.cpp"}
    assert tidy.file_by_file(alone) == [alone]


@pytest.mark.parametrize("builds", [True, False])
def test_tidy_builds_what_it_looks_at(monkeypatch, builds):
    done = []
    monkeypatch.setattr(stages.project, "build", lambda preset, *_, **__: done.append(preset) or builds)
    monkeypatch.setattr(stages.clang_tidy, "run", lambda build, wanted: done.append(build) or (3, []))
    outcome = stages.tidy_product()
    assert done == (["cortex-m7", "build/cortex-m7", "release", "build/release"] if builds else ["cortex-m7", "release"])
    assert (outcome.passed, outcome.failed) == ((2, 0) if builds else (0, 2))


@pytest.mark.parametrize("builds", [True, False])
def test_named_python_tests_run_the_programs_of_today(monkeypatch, builds):
    done = []

    def build(preset, *targets, keep_going=False):
        done.append((preset, targets))
        return builds

    monkeypatch.setattr(stages.project, "build", build)
    monkeypatch.setattr(stages.pytest_files, "run", lambda *_: done.append("run") or Outcome(passed=1))
    outcome = stages.python_tests([stages.ROOT / "tools/test/test_stages.py"])
    assert done[0] == ("release", stages.PROGRAMS)
    assert (outcome.passed, outcome.failed) == ((1, 0) if builds else (0, 1)) and (len(done) == 2) == builds


QUARTER = {"flights": 10, "single_unexplained": 0, "pairs_unexplained": 0, "outside_worst": 0.005, "said_in_time_share": 1.0, "nominal_said": 0}


@pytest.mark.parametrize("found, said, complaint", [
    ({}, "100 of 10 flights", None),
    ({}, "docs/fault-matrix.md: multirotor, gnss, leg: written done, flown crash ?", "written done, flown crash"),
    ({}, "no rule explains: ./rosflight fly --fault mag@1: Crash.", "no rule explains"),
    ({"outside_worst": 0.011}, "", "outside_worst: found 0.0110, allowed at most 0.01"),
    ({"said_in_time_share": 0.94}, "", "said_in_time_share: found 0.9400, allowed at least 0.95"),
    ({"nominal_said": 1}, "", "nominal_said"),
])
def test_the_quarter_of_the_fault_campaign_fails_for_each_of_its_limits(monkeypatch, found, said, complaint):
    done = subprocess.CompletedProcess([], 0, stdout=json.dumps(QUARTER | found), stderr=said)
    monkeypatch.setattr(stages, "_run", lambda *_: done)
    outcome = stages._fault_quarter()
    assert outcome.failed == (0 if complaint is None else 1)
    assert outcome.passed == 13 - outcome.failed
    assert complaint is None or complaint in outcome.complaints[0]


def test_files_that_need_an_emulated_board_run_with_the_images(monkeypatch):
    (file,) = [path for path in stages.emulator_files() if path.name == "test_emulated_boards.py"]
    assert file not in stages.python_files() and file in stages.matching(["emulated_boards"])[1]
    built, ran = [], []
    monkeypatch.setattr(stages, "_build", lambda *targets: built.append(targets) or Outcome(passed=1))
    monkeypatch.setattr(stages, "_emulator_tests", lambda: ["a_test"])
    monkeypatch.setattr(stages, "_run_binaries", lambda preset, names=None: {})
    monkeypatch.setattr(pytest_files, "run", lambda files, *rest: ran.extend(files) or Outcome(passed=3))
    assert stages.cortex_m7().passed == 2 + 3
    assert ran == stages.emulator_files()
    assert built == [("cortex-m7",), ("release", "h7_emulator", "a_test", "rosflight", "rosflight_ground_tools")]


def test_named_they_have_their_images_built_first(monkeypatch):
    built = []
    monkeypatch.setattr(stages.project, "build", lambda preset, *targets, **options: built.append((preset, *targets)) or True)
    monkeypatch.setattr(pytest_files, "run", lambda files, *rest: Outcome(passed=1))
    stages.python_tests(stages.emulator_files())
    assert built == [("release", *stages.PROGRAMS), ("cortex-m7",), ("release", "h7_emulator")]
    built.clear()
    stages.python_tests(stages.python_files()[:1])
    assert built == [("release", *stages.PROGRAMS)]

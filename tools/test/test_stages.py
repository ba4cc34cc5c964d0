# SPDX-License-Identifier: BSD-3-Clause
"""How ./rosflight test counts, chooses and goes on after a failure."""

import cpp_tests
import pytest
import run_tests
import stages
import tidy
from cpp_tests import Binary, Outcome

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
        "one": lambda: Outcome(passed=3), "two": broken,
        "three": lambda: Outcome(passed=4, failed=2, complaints=["why"])})
    assert run_tests.main([]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[-1] == "7 passed, 3 failed"
    assert "   RuntimeError: no compiler" in lines and "   why" in lines
    assert run_tests.main(["one"]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "3 passed, 0 failed"


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
    assert "'mixxer'" in said.err and "core_mixer_test" in said.err


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

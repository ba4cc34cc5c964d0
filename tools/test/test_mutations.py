# SPDX-License-Identifier: BSD-3-Clause
"""Every mutation still fits the tree, and the frame that tries them distinguishes caught from not caught."""

import re
import subprocess

import mutation_tests
import project
import pytest
import run_tests
from mutation_tests import Mutation


def case_is_in(name: str, tests) -> bool:
    """Whether one of the files has the case, which may be one of several with parameters: FOR/SUITE.CASE/PARAMETER."""
    suite, case = re.fullmatch(r"(?:\w+/)?(\w+)\.(\w+)(?:/\w+)?", name).groups()
    return any(re.search(rf"TEST(_P)?\({suite}, {case}\)", test.read_text()) for test in tests)


@pytest.mark.parametrize("mutation", mutation_tests.all_mutations(), ids=lambda m: m.name)
def test_mutation_fits_the_tree(mutation):
    before = (project.ROOT / mutation.file).read_text()
    after = mutation.apply(before)
    assert after != before
    assert after.count("\n") == before.count("\n")
    assert "/test/" not in mutation.file
    if mutation.on_chip:
        assert mutation.file.startswith(mutation_tests.CHIP_PARTS)
        assert mutation.says
        if mutation.flight:
            assert re.match(r"--board \w+ ", mutation.flight)
        else:
            assert case_is_in(mutation.case, [project.ROOT / "flight/test" / f"{mutation.test.removeprefix('flight_')}.cpp"])
        return
    if mutation.file.startswith("firmware/boards/common/"):
        assert case_is_in(mutation.case, (project.ROOT / "firmware/boards/common/test").glob("*.cpp"))
        return
    if mutation.file.startswith("autonomy/"):
        tests = (project.ROOT / "autonomy").glob(f"*/test/{re.sub('^(autonomy_fixedwing|autonomy|estimation)_', '', mutation.test)}.cpp")
        assert case_is_in(mutation.case, tests)
        return
    folder = next(f for f in ("firmware/core", "firmware/boards/parts") if mutation.file.startswith(f + "/"))
    test = project.ROOT / folder / "test" / f"{mutation.test.removeprefix('parts_')}.cpp"
    assert test.is_file()


def test_there_is_one_for_each_invariant():
    text = (project.ROOT / "firmware/core/test/flight_invariants.cpp").read_text()
    said = [mutation.says for mutation in mutation_tests.all_mutations()]
    invariants = set(re.findall(r'fail\((?:silent \? )?"(\w+)"', text))
    missing = {name for name in invariants if name not in said}
    assert not missing, f"no mutation shows that these see their defect: {', '.join(sorted(missing))}"


def test_line_must_be_there_once():
    text = "a();\nb() {\n  a();\n}\nc() {\n  a();\n}\n"
    assert Mutation("m", "", "f", "a();", "", below="b()").apply(text) == "a();\nb() {\n  \n}\nc() {\n  a();\n}\n"
    with pytest.raises(ValueError, match="3 times"):
        Mutation("m", "", "f", "a();", "").apply(text)
    with pytest.raises(ValueError, match="0 times"):
        Mutation("m", "", "f", "d();", "").apply(text)
    with pytest.raises(ValueError, match="has no 'e"):
        Mutation("m", "", "f", "a();", "", below="e()").apply(text)


def test_cheapest_exists_and_unknown_names_are_refused():
    assert {m.name for m in mutation_tests.chosen(mutation_tests.CHEAPEST)} == set(mutation_tests.CHEAPEST)
    with pytest.raises(ValueError, match="no mutation matches 'nonsense'"):
        run_tests.chosen_stages(["mutations", "nonsense"])


@pytest.mark.parametrize("passes, said, complaint", [
    (True, "", "not caught by t"),
    (False, "outputs_in_range: x", ""),
    (False, "something else", "t fails, but says nothing of 'outputs_in_range'"),
])
def test_only_the_failure_it_names_counts(tmp_path, monkeypatch, passes, said, complaint):
    (tmp_path / "f").write_text("good\n")
    monkeypatch.setattr(mutation_tests, "COPY", tmp_path)

    def build_and_run(test, _case):
        assert (tmp_path / "f").read_text() == "bad\n"
        return passes, said

    monkeypatch.setattr(mutation_tests, "build_and_run", build_and_run)
    mutation = Mutation("m", "", "f", "good", "bad", test="t", says="outputs_in_range")
    assert mutation_tests.try_one(mutation) == complaint
    assert (tmp_path / "f").read_text() == "good\n"


def test_a_flight_stands_for_a_test(tmp_path, monkeypatch):
    (tmp_path / "f").write_text("good\n")
    monkeypatch.setattr(mutation_tests, "COPY", tmp_path)
    monkeypatch.setattr(mutation_tests, "build_and_fly", lambda options: (options == "--board b", "SPI: old flags"))
    mutation = Mutation("m", "", "f", "good", "bad", flight="--board b", says="old flags")
    assert mutation_tests.try_one(mutation) == "not caught by fly --board b"
    other = Mutation("m", "", "f", "good", "bad", flight="--board c", says="old flags")
    assert mutation_tests.try_one(other) == ""


def test_a_case_is_run_alone_and_must_exist(monkeypatch):
    answers = {"A.B": "[==========] Running 1 test from 1 test suite.", "A.C": "[==========] Running 0 tests from 0 test suites."}

    def run(command):
        case = command[-1].removeprefix("--gtest_filter=") if "--gtest_filter" in command[-1] else ""
        return subprocess.CompletedProcess(command, 0, answers.get(case, ""), "")

    monkeypatch.setattr(mutation_tests, "run", run)
    monkeypatch.setattr(mutation_tests.Path, "rglob", lambda _self, _name: [project.ROOT / "README.md"])
    assert mutation_tests.build_and_run("t", "A.B") == (True, answers["A.B"])
    with pytest.raises(RuntimeError, match="t has no case A.C"):
        mutation_tests.build_and_run("t", "A.C")


def test_a_test_and_a_flight_together_are_refused(tmp_path):
    (tmp_path / "m.yaml").write_text("breaks: b\nfile: f\nline: l\nbecomes: c\ntest: t\nflight: --board b\n")
    with pytest.raises(ValueError, match="m.yaml: allowed is one of test and flight"):
        mutation_tests.read(tmp_path / "m.yaml")


def test_a_test_that_flies_takes_the_images_of_the_copy(tmp_path, monkeypatch):
    tree, copy, built = tmp_path / "tree", tmp_path / "copy", []
    copy.mkdir()
    program = tree / "build/release/flight/flight_h7_pins_test"
    program.parent.mkdir(parents=True)
    program.write_text('#!/bin/sh\necho "[==========] Running 1 test from 1 test suite. $ROSFLIGHT_DATA_DIR $1"; exit 1\n')
    program.chmod(0o755)
    monkeypatch.setattr(mutation_tests, "COPY", copy)
    monkeypatch.setattr(mutation_tests.project, "ROOT", tree)
    monkeypatch.setattr(mutation_tests, "run", lambda command: built.append(command[-2:]) or subprocess.CompletedProcess(command, 0, "", ""))
    passed, said = mutation_tests.try_out(Mutation("m", "", "f", "a", "b", test="flight_h7_pins_test", case="A.B"))
    assert not passed and f" {copy} --gtest_filter=A.B" in said
    assert built == [["firmware_pixracer_pro.elf", "firmware_varmint.elf"]]

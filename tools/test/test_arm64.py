# SPDX-License-Identifier: BSD-3-Clause
"""The stages arm64 and arm64-rest: which tests, where they are left out, and what is wrong with a package or a flight."""

import struct
import subprocess
import sys

import arm64_tests
import pytest
import run_tests
import stages
from cpp_tests import Binary, Outcome
from project import ROOT


def test_arm64_is_a_stage_of_each_run_and_the_rest_is_on_request():
    every = [name for name, _ in run_tests.chosen_stages([])]
    assert "arm64" in every and "arm64-rest" not in every
    assert [name for name, _ in run_tests.chosen_stages(["arm64-rest"])] == ["arm64-rest"]


@pytest.mark.parametrize("test, quick, rest", [
    (Binary("joined_sim_test", [], part="sim"), True, False),
    (Binary("firmware_learned_test", [], part="firmware"), False, True),
    (Binary("estimation_estimator_test", [], part="autonomy"), False, True),
    (Binary("parts_fram_test", [], part="firmware"), False, True),
    (Binary("companion_clock_test", [], part="companion"), False, True),
    (Binary("linux_board_linux_serial_test", [], part="firmware"), False, False),
    (Binary("flight_test", [], part="flight"), False, False),
    (Binary("firmware_m7_test", [], part="firmware", needs_emulator=True), False, False),
])
def test_each_test_is_in_one_of_the_stages_or_in_none(test, quick, rest):
    assert (arm64_tests.is_quick(test), arm64_tests.is_rest(test)) == (quick, rest)


@pytest.mark.parametrize("codename, here", [("bookworm", True), ("jammy", False), ("noble", False)])
def test_other_systems_leave_arm64_out_with_a_line(monkeypatch, tmp_path, capsys, codename, here):
    (tmp_path / "os-release").write_text(f"VERSION_CODENAME={codename}\n")
    monkeypatch.setenv("ROSFLIGHT_OS_RELEASE", str(tmp_path / "os-release"))
    assert arm64_tests.is_here() == here
    assert bool(capsys.readouterr().out.count("left out")) == (not here)
    if not here:
        for stage in (arm64_tests.quick, arm64_tests.rest):
            assert stage() == Outcome()


def test_no_test_found_is_a_failure(monkeypatch):
    monkeypatch.setattr(arm64_tests, "is_here", lambda: True)
    monkeypatch.setattr(arm64_tests.project, "build", lambda *_, **__: True)
    monkeypatch.setattr(arm64_tests.cpp_tests, "find", lambda _: [Binary("flight_test", [], part="flight")])
    assert arm64_tests.quick().failed == 1


def test_program_of_an_earlier_build_is_not_run_on_the_emulated_processor(monkeypatch):
    asked = []
    monkeypatch.setattr(stages.project, "is_up_to_date", lambda *target: asked.append(target))
    old = Binary("joined_sim_test", ["/usr/bin/qemu-aarch64", "-L", "root", str(ROOT / "build/arm64-tests/joined_sim_test")])
    assert not stages._is_built("arm64-tests", old)
    assert asked == [("arm64-tests", "joined_sim_test")]


@pytest.mark.parametrize("there, here, complaint", [
    ('{"log_sha256": "ab"}', '{"log_sha256": "ab"}', None),
    ('{"log_sha256": "ab"}', '{"log_sha256": "cd"}', "multirotor: log_sha256 is ab on arm64, cd here"),
    (None, '{"log_sha256": "cd"}', "multirotor, arm64: it fell"),
])
def test_a_flight_has_to_have_the_bits_that_it_has_here(monkeypatch, tmp_path, there, here, complaint):
    def fly(command):
        said = there if command[0] == "qemu-aarch64" else here
        return subprocess.CompletedProcess(command, 0 if said else 1, stdout=said, stderr="it fell\n")
    monkeypatch.setattr(arm64_tests.stages, "_run", fly)
    assert arm64_tests.differs("multirotor", tmp_path / "rosflight") == ([complaint] if complaint else [])


def program(folder, machine: int):
    path = folder / "rosflight"
    path.write_bytes(b"\x7fELF" + bytes(14) + struct.pack("<H", machine) + bytes(44))
    return path


@pytest.mark.parametrize("architecture, depends, machine, complaints", [
    ("arm64", "libc6 (>= 2.36), libyaml-cpp0.7", 183, []),
    ("amd64", "libc6, libyaml-cpp0.7", 183, ["Architecture: found amd64, allowed arm64"]),
    ("arm64", "libc6, libyaml-cpp0.7", 62, ["rosflight: made for another processor"]),
    ("arm64", "libc6", 183, ["Depends: libyaml-cpp0.7 is missing"]),
    ("arm64", "libc6, libyaml-cpp0.7, zlib1g", 183, ["Depends: no program needs zlib1g"]),
])
def test_package_is_of_the_architecture_with_what_its_programs_need(monkeypatch, tmp_path, architecture, depends, machine, complaints):
    monkeypatch.setattr(arm64_tests, "libraries", lambda _: ["libc.so.6", "libm.so.6", "libyaml-cpp.so.0.7"])
    assert arm64_tests.wrong_package(architecture, depends, [program(tmp_path, machine)]) == complaints


def test_package_without_the_program_or_with_a_library_of_no_known_package_is_wrong(monkeypatch, tmp_path):
    assert arm64_tests.wrong_package("arm64", "", []) == ["usr/bin holds no rosflight"]
    monkeypatch.setattr(arm64_tests, "libraries", lambda _: ["libnew.so.1"])
    assert arm64_tests.wrong_package("arm64", "", [program(tmp_path, 183)]) == ["libnew.so.1: its package is not known"]


def test_joined_tests_may_use_one_name_for_two_things(tmp_path):
    for name, value in (("a", 1), ("b", 2)):
        (tmp_path / f"{name}_test.cpp").write_text(
            f"namespace rosflight {{\nnamespace {{\nconstexpr int kValue = {value};\nstatic_assert(kValue == {value});\n}}  // namespace\n}}\n")
    joined = tmp_path / "joined/all.cpp"
    subprocess.run([sys.executable, ROOT / "cmake/join_tests.py", joined, f"a_test={tmp_path}/a_test.cpp", f"b_test={tmp_path}/b_test.cpp"],
                   check=True)
    done = subprocess.run(["c++", "-std=c++20", "-fsyntax-only", joined], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    joined.write_text(joined.read_text().replace("kValue == 2", "kValue == 3"))
    failed = subprocess.run(["c++", "-std=c++20", "-fsyntax-only", joined], capture_output=True, text=True)
    assert f"{tmp_path}/b_test.cpp:4:" in failed.stderr

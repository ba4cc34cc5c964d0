# SPDX-License-Identifier: BSD-3-Clause
"""The frame of ./rosflight bench, with figures and programs made up here."""

import json
import re
import subprocess
import sys

import bench
import bench_build
import bench_figures
import bench_programs
import callgrind
import project
import pytest
from bench_figures import Figure


def fail():
    raise RuntimeError("no such program")


FIGURES = [
    Figure("a.fast", "s", "< 5", lambda: 4.9),
    Figure("a.slow", "s", "< 5", lambda: 5.0),
    Figure("b.told", "s/s", "report", lambda: 1234.5),
    Figure("b.broken", "B", "<= 10", fail),
]


@pytest.fixture(autouse=True)
def no_build(monkeypatch):
    monkeypatch.setattr(bench_programs, "prepare", lambda preset: None)


def run(*arguments: str) -> int:
    return bench.main(list(arguments), lambda: FIGURES)


def test_json_has_value_unit_target_and_met_of_every_figure(tmp_path, capsys):
    assert run("--json", str(tmp_path / "f.json")) == 1
    assert json.loads((tmp_path / "f.json").read_text()) == {
        "a.fast": {"value": 4.9, "unit": "s", "target": "< 5", "met": True},
        "a.slow": {"value": 5.0, "unit": "s", "target": "< 5", "met": False},
        "b.told": {"value": 1234.5, "unit": "s/s", "target": "report", "met": None},
        "b.broken": {"value": None, "unit": "B", "target": "<= 10", "met": False,
                     "reason": "no such program"},
    }
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == ["figure", "a.fast", "a.slow", "b.told", "b.broken"]
    assert lines[4].endswith("no  not measured: no such program")


def test_name_chooses_by_a_part(capsys):
    assert run("b.t") == 0
    assert [l.split()[0] for l in capsys.readouterr().out.splitlines()] == ["figure", "b.told"]


def test_what_takes_long_is_measured_when_named(capsys):
    figures = [*FIGURES[:1], Figure("c.long", "s", "report", lambda: 1.0, on_request=True)]
    assert bench.choose([], False, figures) == figures[:1]
    assert bench.choose(["c.long"], False, figures) == figures[1:]
    assert bench.choose([], True, figures) == figures


def test_what_takes_hours_is_not_measured_with_its_group():
    figures = [Figure("c.long", "s", "report", lambda: 1.0, on_request=True),
               Figure("c.rows_lost", "flights", "= 0", lambda: 0.0, on_request=True, by="c.rows")]
    assert bench.choose(["c"], False, figures) == figures[:1]
    assert bench.choose(["c.rows"], False, figures) == bench.choose(["c.rows_lost"], False, figures) == figures[1:]
    with pytest.raises(ValueError, match="NAME: found 'rows'"):
        bench.choose(["rows"], False, figures)


def test_the_file_is_written_after_each_figure(tmp_path):
    file = tmp_path / "f.json"

    def written_before() -> float:
        return float(len(json.loads(file.read_text())))

    assert bench.main(["--json", str(file)], lambda: [*FIGURES[:2], Figure("d.last", "1", "= 2", written_before)]) == 0
    assert json.loads(file.read_text())["d.last"]["met"] is True


def test_what_is_measured_without_names_needs_no_ros_and_no_fuzzer():
    names = {figure.name.split(".")[0] for figure in bench.choose([], False, bench_figures.all_figures())}
    assert {"firmware", "loop", "missions", "m7"} <= names and not names & {"fuzz", "rtt", "ros", "load", "property", "build"}


@pytest.mark.parametrize("arguments", [["c.none"], ["--json"], ["--fast"], ["--json", "/nowhere/f.json"]])
def test_bad_arguments_are_one_line_and_exit_code_2(arguments, capsys):
    assert run(*arguments) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.count("\n") == 1


@pytest.mark.parametrize("value, target, met", [
    (2500, "<= 2500", True), (2501, "<= 2500", False), (999.9, ">= 1000", False), (0, "= 0", True),
    (1, "= 0", False), (2, "> 2", False), (1e6, ">= 1000000", True),
    (0.69, "0.7..1.3", False), (0.7, "0.7..1.3", True), (1.3, "0.7..1.3", True), (1.31, "0.7..1.3", False)])
def test_targets(value, target, met):
    assert bench.meets(value, target) is met


@pytest.mark.parametrize("target", ["about 2", "1..", "..2", "0.7...1.3"])
def test_unreadable_target_is_refused(target):
    with pytest.raises(ValueError):
        bench.meets(1, target)


def test_consistency_has_both_bounds_for_each_block_and_sensor_of_each_vehicle():
    targets = {figure.name.removeprefix("estimation."): figure.target for figure in bench_figures.all_figures()
               if figure.name.startswith("estimation.")}
    aids = ("gnss_horizontal", "gnss_altitude", "gnss_velocity", "baro", "heading", "air_force")
    for noise, more in (("shipped", ("range",)), ("fixedwing_calm", ("pitot",)), ("fixedwing", ("pitot",)), ("fixedwing_gusts", ("pitot",))):
        names = [f"nees_{block}" for block in ("attitude", "velocity", "position")] + [f"nis_{aid}" for aid in (*aids, *more)]
        assert {targets[f"{noise}.{name}"] for name in names} == {"0.7..1.3"}, noise
    assert targets["shipped.horizontal_m_rms"] == "<= 0.174"
    assert {targets[f"{air}.horizontal_m_rms"] for air in ("fixedwing_calm", "fixedwing", "fixedwing_gusts")} == {"<= 0.241"}
    assert "shipped.nis_pitot" not in targets  # a multirotor has none


def test_every_figure_of_the_project_has_a_readable_target_and_its_own_name():
    figures = bench_figures.all_figures()
    assert len({figure.name for figure in figures}) == len(figures)
    for figure in figures:
        assert figure.target == "report" or bench.meets(1, figure.target) in (True, False)


def test_program_that_fails_or_prints_no_json_is_told():
    with pytest.raises(RuntimeError, match="ended with 3: broken"):
        bench_programs.run_json(["sh", "-c", "echo broken >&2; exit 3"])
    with pytest.raises(RuntimeError, match="printed no JSON"):
        bench_programs.run_json(["echo", "factor 7"])
    with pytest.raises(RuntimeError, match="no number 'b' among a"):
        bench_programs.number(bench_programs.run_json(["echo", '{"a": 1}']), "b")


@pytest.mark.parametrize("installed", [True, False])
def test_other_simulators_are_measured_where_they_can_be_installed(installed, monkeypatch):
    def environment(name, requirements):
        assert (project.ROOT / requirements).is_file() and f"/{name}/" in (project.ROOT / ".gitignore").read_text().splitlines()
        if not installed:
            raise subprocess.CalledProcessError(2, "ready.sh")

    monkeypatch.setattr(bench_programs, "environment", environment)
    monkeypatch.setattr(bench_programs.subprocess, "run", lambda *_, **__: subprocess.CompletedProcess([], 0))
    monkeypatch.setattr(bench_programs, "run_json", lambda command: {"command": command[1:]})
    peers = [str(project.ROOT / ".venv-peers/bin/python")] if installed else []
    assert bench_programs.scale.__wrapped__()["command"] == ["python", "bench/scale.py", *peers]


def test_what_was_learnt_is_the_worst_of_two_seeds(monkeypatch):
    def run(command, **_):
        seed = int(command[command.index("--seed") + 1])
        curve = command[command.index("--csv") + 1]
        with open(curve, "w") as file:
            print(f"steps,clock_s,processor_s,successes,episodes,reward\n8192,1.0,1.0,0,3,0.1\n16384,{10 * seed}.5,7.0,5,9,0.2", file=file)
        return subprocess.CompletedProcess(command, 0, f"16384 steps\n{100 - seed} of 100 episodes without noise succeed\n", "")

    monkeypatch.setattr(bench_programs, "ready_python", lambda: None)
    monkeypatch.setattr(bench_programs.subprocess, "run", run)
    bench_programs.learned.cache_clear()
    found = {f.name: f.measure() for f in bench_figures.learning() if "hover" in f.name}
    bench_programs.learned.cache_clear()
    assert found == {"learn.hover_successes": 98, "learn.hover_clock_s": 20.5, "learn.hover_processor_s": 7.0}


def test_totals_of_a_callgrind_profile():
    assert callgrind.total("events: Ir\nfn=main\n1 2\n\ntotals: 123456\n") == 123456
    assert callgrind.total("events: Ir\nsummary: 77\n1 2\n") == 77
    with pytest.raises(RuntimeError, match="no totals"):
        callgrind.total("events: Ir\n")


def test_instructions_per_call_are_those_of_the_loop_alone(tmp_path):
    # Two nops, the decrement and the jump.
    source = tmp_path / "loop.c"
    source.write_text('#include <stdlib.h>\nint main(int n, char** a) {\n'
                      '  for (int i = 0; i < 5000; ++i) __asm__ volatile("nop");\n'
                      '  long c = atol(a[n - 1]);\n'
                      '  do { __asm__ volatile("nop\\n\\tnop"); } while (--c > 0);\n}\n')
    subprocess.run(["gcc", "-O2", "-o", tmp_path / "loop", source], check=True)
    count = callgrind.instructions_per_call([str(tmp_path / "loop"), "--passes"], 10000, 30000)
    assert count in (4, 5)  # the compiler may add a test before the jump


def test_processor_time_of_a_build_is_that_of_the_compilers_without_cache(tmp_path, monkeypatch):
    (tmp_path / "build/release").mkdir(parents=True)
    (tmp_path / "build/release/CMakeCache.txt").write_text("ROSFLIGHT_QUICK_BUILD:BOOL=ON\nOTHER:BOOL=ON\n")
    calls = []
    real_run = subprocess.run

    def run(command, **options):
        calls.append(command)
        burns = "import time\nwhile time.process_time() < 0.4: pass" if command[0] == "ninja" else ""
        return real_run([sys.executable, "-c", burns], **options)
    monkeypatch.setattr(bench_build.subprocess, "run", run)
    assert 0.4 <= bench_build.flight_cpu_s(tmp_path) < 2
    configure, build = calls[1:]
    assert {"-DCMAKE_CXX_COMPILER_LAUNCHER=", "-DROSFLIGHT_QUICK_BUILD:BOOL=ON"} <= set(configure)
    assert not any("OTHER" in word for word in configure) and build[-1] == "rosflight"


def test_build_that_fails_is_not_measured(tmp_path, monkeypatch):
    monkeypatch.setattr(bench_build.subprocess, "run", lambda command, **_: subprocess.CompletedProcess(
        command, 1, "", "one\nno compiler\n"))
    with pytest.raises(RuntimeError, match="no compiler"):
        bench_build.flight_cpu_s(tmp_path)


def test_limits_of_wind_are_those_that_the_vehicles_state():
    rows = re.findall(r"^\| `(\w+)` \| (\d+) \|", (bench.project.ROOT / "vehicles" / "README.md").read_text(), re.M)
    assert {name: int(limit) for name, limit in rows} == bench_figures.WIND_LIMITS

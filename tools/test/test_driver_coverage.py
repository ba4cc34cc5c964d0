# SPDX-License-Identifier: BSD-3-Clause
import driver_coverage
import pytest


def report(where: str, **files: dict[int, int]) -> dict:
    """As gcov prints it; `files` are names without their suffix."""
    return {"current_working_directory": where, "files": [
        {"file": f"{name}.cpp", "lines": [{"line_number": number, "count": count} for number, count in lines.items()]}
        for name, lines in files.items()]}


def test_a_line_is_covered_if_one_of_the_programs_ran_it(tmp_path):
    reports = [report(str(tmp_path), sbus={10: 0, 11: 3, 12: 0}), report(str(tmp_path), sbus={10: 2, 11: 0, 12: 0, 13: 0})]
    counts = driver_coverage.merged(reports, tmp_path)
    assert counts == {"sbus.cpp": {10: 2, 11: 3, 12: 0, 13: 0}}
    assert driver_coverage.percent(list(counts["sbus.cpp"].values())) == 50.0


def test_tests_and_models_do_not_count(tmp_path):
    (tmp_path / "test").mkdir()
    assert driver_coverage.merged([report(str(tmp_path / "test"), sbus_test={1: 1})], tmp_path) == {}


def test_header_and_source_are_one_driver():
    assert driver_coverage.by_driver({"crsf.hpp": {1: 0}, "crsf.cpp": {1: 1, 2: 1}, "fram.cpp": {4: 0}}) == {
        "crsf": [0, 1, 1], "fram": [0]}


def test_the_total_counts_lines_and_the_lowest_is_one_driver(monkeypatch):
    monkeypatch.setattr(driver_coverage, "files", lambda: {"crsf.cpp": {1: 1, 2: 1, 3: 1}, "fram.cpp": {4: 0}})
    assert driver_coverage.total() == 75.0
    assert driver_coverage.lowest() == 0.0


def test_a_build_that_fails_is_reported(monkeypatch):
    monkeypatch.setattr(driver_coverage.project, "build", lambda *arguments, **options: False)
    with pytest.raises(RuntimeError, match="not configured"):
        driver_coverage.run_tests()

# SPDX-License-Identifier: BSD-3-Clause
"""doc_coverage.py counts what a reader of a header would."""

from pathlib import Path

import doc_coverage
import pytest


def functions(text):
    return {f.name: f.documented for f in doc_coverage.Header(Path("a.hpp"), text.encode()).functions}


@pytest.mark.parametrize("text, found", [
    ("/// Runs.\nvoid run();", {"run": True}),
    ("void run();  ///< Runs.", {"run": True}),
    ("int x;  ///< A number.\nvoid run();", {"run": False}),
    ("/// Far away.\n\n\nvoid run();", {"run": False}),
    ("/// Either.\nvoid run(int);\nvoid run(double);", {"run": True}),
    ("/// A template.\ntemplate <class T> T twice(T x) { return 2 * x; }", {"twice": True}),
    ("namespace detail { void hidden(); }", {}),
    ("namespace { void hidden(); }", {}),
    ("namespace a::b { void seen(); }", {"seen": False}),
])
def test_free_functions(text, found):
    assert functions(text) == found


@pytest.mark.parametrize("member, found", [
    ("void step(double dt_s);", {"A::step": False}),
    ("explicit A(int size);", {"A::A": False}),
    ("A();", {}),
    ("~A();", {}),
    ("A(const A&) = delete;", {}),
    ("void step(double dt_s) override;", {}),
    ("int size() const;", {}),
    ("int& size() { return size_; }", {}),
    ("bool take();", {"A::take": False}),
    ("void (*callback)(int);", {}),
    ("template <class T> void add(T x);", {"A::add": False}),
    ("static int of(int x) { return x; }", {"A::of": False}),
])
def test_members(member, found):
    assert functions("class A {\n public:\n  " + member + "\n private:\n  void hidden();\n};") == found
    assert functions("struct A {\n  " + member + "\n};") == found


def test_a_specialisation_is_documented_by_its_template():
    assert functions("template <> struct A<int> { void pack(int x); };") == {}


@pytest.mark.parametrize("folder", doc_coverage.FOLDERS)
def test_the_libraries_are_documented(folder):
    found = doc_coverage.functions_of(folder)
    assert len(found) > 20
    missing = [f"{f.file}:{f.line}: {f.name}" for f in found if not f.documented]
    assert doc_coverage.percent(found) >= doc_coverage.MIN_PERCENT >= 95.0, missing


def test_a_folder_below_the_limit_ends_with_1(monkeypatch, capsys):
    monkeypatch.setattr(doc_coverage, "functions_of", lambda folder: [
        doc_coverage.Function("a.hpp", 1, "a", True), doc_coverage.Function("a.hpp", 2, "b", False)])
    assert doc_coverage.main(["--list", "sim"]) == 1
    assert capsys.readouterr().out.split("\n")[:2] == ["sim                1 of    2   50.0 %", "   a.hpp:2: b"]

# SPDX-License-Identifier: BSD-3-Clause
"""product_lines.py counts what is neither test nor comment."""

from pathlib import PurePosixPath

import product_lines
import pytest


@pytest.mark.parametrize("text, lines", [
    ("// one\nint a;  // two\n\n/* three\n four */\nint b;\n", 2),
    ('const char* t = R"(a\nb\nc)";\n', 3),
    ('#include "a.hpp"\n/// doc\nvoid f() {\n}\n', 3),
])
def test_cpp(text, lines):
    assert product_lines.cpp_lines(text.encode()) == lines


@pytest.mark.parametrize("text, lines", [
    ('"""Doc\nstring."""\n\nimport os  # why\n\n# nothing\ndef f():\n    """Doc."""\n    return (1,\n            2)\n', 4),
    ('text = """a\nb"""\n', 2),
])
def test_python(text, lines):
    assert product_lines.python_lines(text.encode()) == lines


@pytest.mark.parametrize("name, counts", [
    ("sim/noise.cpp", True), ("sim/test/noise_test.cpp", False), ("ros/rosflight_io/test/test_link.py", False),
    ("tools/bench.py", True), ("docs/style.md", False), ("link/fuzz/receive_fuzz.hpp", False),
])
def test_what_is_product(name, counts):
    assert product_lines.is_product(PurePosixPath(name)) == counts

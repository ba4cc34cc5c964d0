# SPDX-License-Identifier: BSD-3-Clause
"""Writes one C++ file that contains several test files: their headers and templates are compiled once.

    join_tests.py OUT NAME=FILE...

The unnamed namespace of each file becomes one with the name of the test. Two files may therefore give the same name to something.
"""

import re
import sys
from pathlib import Path

UNNAMED = re.compile(r"^namespace \{$", re.M)


def joined(tests: list[tuple[str, Path]]) -> str:
    parts = []
    for name, path in tests:
        text = UNNAMED.sub(f"namespace of_{name} {{", path.read_text())
        parts.append(f'#line 1 "{path}"\n{text}')
    return "\n".join(parts)


def main(arguments: list[str]):
    out, *tests = arguments
    text = joined([(name, Path(path)) for name, _, path in (test.partition("=") for test in tests)])
    Path(out).parent.mkdir(parents=True, exist_ok=True)
    Path(out).write_text(text)


if __name__ == "__main__":
    main(sys.argv[1:])

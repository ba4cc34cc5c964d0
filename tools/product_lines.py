# SPDX-License-Identifier: BSD-3-Clause
"""Counts the lines of the product: C++ and Python without tests, comments, docstrings and blank lines.

Usage: product_lines.py [COMMIT]   of the working tree, or of a commit; one line per top folder and the sum
"""

import ast
import io
import subprocess
import sys
import tokenize
from collections import Counter
from pathlib import PurePosixPath

import project
import tree_sitter_cpp
from tree_sitter import Language, Parser

NOT_PRODUCT = {"test", "fuzz", "test_support", "mutations"}
CPP = Parser(Language(tree_sitter_cpp.language()))


def is_product(path: PurePosixPath) -> bool:
    is_test = path.name.startswith("test_") or path.name == "conftest.py" or NOT_PRODUCT & set(path.parts)
    return path.suffix in (".cpp", ".hpp", ".py") and not is_test


def cpp_lines(text: bytes) -> int:
    """Lines with something besides a comment."""
    lines = set()

    def visit(node):
        if node.type == "comment":
            return
        if not node.children:
            lines.update(range(node.start_point[0], node.end_point[0] + 1) if node.text.strip() else ())
        for child in node.children:
            visit(child)

    visit(CPP.parse(text).root_node)
    return len(lines)


def python_lines(text: bytes) -> int:
    """Lines with a token that is neither a comment nor a docstring."""
    passed = (tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENCODING, tokenize.ENDMARKER)
    lines = set()
    for token in tokenize.tokenize(io.BytesIO(text).readline):
        if token.type not in passed:
            lines.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(node) is not None:
            lines -= set(range(node.body[0].lineno, node.body[0].end_lineno + 1))
    return len(lines)


def files(commit: str | None) -> dict[PurePosixPath, bytes]:
    if commit is None:
        return {PurePosixPath(path): (project.ROOT / path).read_bytes() for path in project.own_files() if is_product(PurePosixPath(path))}

    def git(*words: str) -> bytes:
        return subprocess.run(["git", *words], cwd=project.ROOT, check=True, capture_output=True).stdout

    names = map(PurePosixPath, git("ls-tree", "-r", "--name-only", commit).decode().split("\n"))
    return {name: git("show", f"{commit}:{name}") for name in names if is_product(name)}


def count(found: dict[PurePosixPath, bytes]) -> Counter:
    lines = Counter()
    for path, text in found.items():
        lines[path.parts[0]] += python_lines(text) if path.suffix == ".py" else cpp_lines(text)
    return lines


def main(words: list[str]) -> int:
    try:
        lines = count(files(words[0] if words else None))
    except subprocess.CalledProcessError as error:
        print(f"product_lines: {error.stderr.decode().strip()}", file=sys.stderr)
        return 2
    for folder, number in sorted(lines.items()):
        print(f"{folder:<15}{number:>7}")
    print(f"{'all':<15}{sum(lines.values()):>7}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

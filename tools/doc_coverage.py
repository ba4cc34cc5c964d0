# SPDX-License-Identifier: BSD-3-Clause
"""Measures how many public functions of the libraries carry a comment of their own.

Usage: doc_coverage.py [--list] [FOLDER...]

A public function is a free function of a header outside of `detail` and anonymous namespaces, or a public member function.
Not counted: constructors without arguments, destructors, operators, defaulted and deleted functions, overrides (the
interface documents them), specialisations (the template documents them), and trivial accessors: without arguments, const
or returning a reference, with a body of one statement or none in the header.
A function is documented by a comment directly above it or at the end of its line; overloads share the comment above the
first. --list names the functions without one. Exit code 1 when a folder is below MIN_PERCENT.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import project
import tree_sitter_cpp
from tree_sitter import Language, Node, Parser

FOLDERS = ("link", "firmware/hal", "firmware/core", "sim", "companion", "autonomy")
NOT_PUBLIC = {"test", "fuzz", "bench"}
MIN_PERCENT = 95.0

CPP = Language(tree_sitter_cpp.language())


@dataclass(frozen=True)
class Function:
    file: str
    line: int
    name: str
    documented: bool


def text_of(node: Node | None) -> str:
    return node.text.decode() if node else ""


def function_declarator(node: Node) -> Node | None:
    """The part `name(arguments)` of a declaration, if it declares a function."""
    declarator = node.child_by_field_name("declarator")
    while declarator is not None and declarator.type in ("pointer_declarator", "reference_declarator"):
        declarator = next((child for child in declarator.named_children if child.type.endswith("declarator")), None)
    return declarator if declarator is not None and declarator.type == "function_declarator" else None


def is_counted(node: Node, declarator: Node, owner: str) -> bool:
    name = text_of(declarator.child_by_field_name("declarator"))
    whole, head = text_of(node), text_of(declarator)
    after = whole[whole.index(head) + len(head):]
    if name.startswith(("~", "operator", "(")) or "= delete" in after or "= default" in after:
        return False
    if " override" in head + after.split("{")[0] or " final" in head.split(")")[-1]:
        return False
    has_arguments = bool(declarator.child_by_field_name("parameters").named_children)
    if name == owner and not has_arguments:
        return False
    body = node.child_by_field_name("body")
    is_accessor = not has_arguments and node.child_by_field_name("type") is not None and (
        head.rstrip().endswith("const") and (body is None or len(body.named_children) == 1)
        or body is not None and len(body.named_children) == 1 and "&" in whole.split(name)[0])
    return not is_accessor


def comment_above(node: Node) -> bool:
    before = node.prev_sibling
    return before is not None and before.type == "comment" and before.end_point[0] + 1 >= node.start_point[0] \
        and not is_trailing(before)


def is_trailing(comment: Node) -> bool:
    """A comment behind code belongs to that code."""
    before = comment.prev_sibling
    return before is not None and before.end_point[0] == comment.start_point[0]


def comment_behind(node: Node) -> bool:
    after = node.next_sibling
    while after is not None and after.type == ";":
        after = after.next_sibling
    return after is not None and after.type == "comment" and after.start_point[0] == node.end_point[0]


class Header:
    def __init__(self, path: Path, text: bytes):
        self.path = path
        self.functions: list[Function] = []
        self._visit(Parser(CPP).parse(text).root_node, "", True)

    def _visit(self, parent: Node, owner: str, public: bool):
        named: dict[str, bool] = {}
        for node in parent.children:
            if node.type == "access_specifier":
                public = text_of(node).startswith("public")
            elif node.type == "namespace_definition":
                name = text_of(node.child_by_field_name("name"))
                if name and not name.endswith(("detail", "internal")):
                    self._visit(node.child_by_field_name("body"), "", True)
            elif node.type == "template_declaration":
                inner = node.named_children[-1]
                self._declaration(inner, node, owner, public, named)
            else:
                self._declaration(node, node, owner, public, named)

    def _declaration(self, node: Node, outer: Node, owner: str, public: bool, named: dict[str, bool]):
        if not public:
            return
        if node.type in ("class_specifier", "struct_specifier"):
            body, name = node.child_by_field_name("body"), node.child_by_field_name("name")
            if body is not None and (name is None or name.type != "template_type"):
                self._visit(body, text_of(name), node.type == "struct_specifier")
            return
        if node.type not in ("function_definition", "declaration", "field_declaration"):
            return
        inner = node.child_by_field_name("type")
        if inner is not None and inner.type in ("class_specifier", "struct_specifier"):
            return self._declaration(inner, inner, owner, public, named)
        declarator = function_declarator(node)
        if declarator is None or not is_counted(node, declarator, owner):
            return
        name = text_of(declarator.child_by_field_name("declarator"))
        documented = comment_above(outer) or comment_behind(outer) or named.get(name, False)
        named[name] = documented
        full = f"{owner}::{name}" if owner else name
        self.functions.append(Function(str(self.path), outer.start_point[0] + 1, full, documented))


def functions_of(folder: str, root: Path = project.ROOT) -> list[Function]:
    found = []
    for path in project.own_files(root):
        if path.suffix == ".hpp" and path.is_relative_to(folder) and not NOT_PUBLIC & set(path.parts):
            found += Header(path, (root / path).read_bytes()).functions
    return found


def percent(functions: list[Function]) -> float:
    return 100.0 * sum(f.documented for f in functions) / len(functions) if functions else 100.0


def main(words: list[str]) -> int:
    listing = "--list" in words
    folders = [word for word in words if word != "--list"] or list(FOLDERS)
    below = False
    for folder in folders:
        functions = functions_of(folder)
        below |= percent(functions) < MIN_PERCENT
        print(f"{folder:<15}{sum(f.documented for f in functions):>5} of {len(functions):>4} {percent(functions):>6.1f} %")
        if listing:
            for f in functions:
                if not f.documented:
                    print(f"   {f.file}:{f.line}: {f.name}")
    return int(below)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

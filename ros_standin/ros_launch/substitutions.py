# SPDX-License-Identifier: BSD-3-Clause
"""$(...) in the text of a launch file.

Same words and quoting as in the XML front end of ROS 2 (launch 3.4): one blank between arguments, ' or " around a whole
argument that has blanks or parentheses, substitutions inside each other, a backslash takes the next sign as it is.
`eval` knows arithmetic, comparisons, and, or, not, in, x if c else y, over numbers and texts: no calls.
"""

import ast
import operator
import os
import re
import shlex
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from .errors import LaunchError, near, one_of
from .packages import Packages


@dataclass
class Scope:
    """What substitutions look at."""

    packages: Packages
    variables: dict[str, str] = field(default_factory=dict)
    environment: dict[str, str] = field(default_factory=lambda: dict(os.environ))
    folder: Path = Path(".")


def substitute(text: str, scope: Scope) -> str:
    """The text with every $(...) replaced."""
    return "".join(piece for piece, _ in _template(text, 0, "", scope)[0])


def command_words(text: str, scope: Scope) -> list[str]:
    """The arguments of a program, as `ros2 launch` splits `args`, `ros_args` and `cmd`.

    Only what is written in the file is split, each stretch between two $(...) by itself and as a shell does it: a quote ends in
    the stretch where it begins. The value of a $(...) stays one piece, whatever blanks are in it, and also if it is empty.
    """
    words: list[str] = []
    word: str | None = None
    for piece, literal in _template(text, 0, "", scope)[0] or [("", True)]:
        if not literal:
            word = (word or "") + piece
            continue
        parts = shlex.split(piece)
        if not parts or (piece[0].isspace() and word is not None):
            words, word = [*words, word or ""], None
        for part in parts[:-1]:
            words, word = [*words, (word or "") + part], None
        if parts:
            word = (word or "") + parts[-1]
            if piece[-1].isspace():
                words, word = [*words, word], None
    return words if word is None else [*words, word]


# ---- reading ------------------------------------------------------------------------------------

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")
_ESCAPED = re.compile(r"\\(.)")


def _template(text: str, at: int, quote: str, scope: Scope) -> tuple[list[tuple[str, bool]], int]:
    """Pieces up to the closing quote, or to the end if there is none: what they say, and whether they are written there."""
    pieces: list[tuple[str, bool]] = []
    begin = at
    while True:
        ends = at >= len(text) or text[at] == quote
        if ends or (text.startswith("$(", at) and text[at - 1:at] != "\\"):
            if at > begin:
                pieces.append((_ESCAPED.sub(r"\1", text[begin:at]), True))
            if ends:
                break
            value, at = _substitution(text, at + 2, quote, scope)
            pieces.append((value, False))
            begin = at
        else:
            at += 2 if quote and text.startswith("\\" + quote, at) else 1
    if quote and at >= len(text):
        raise LaunchError(f"substitution: found {text!r}, allowed two {quote} around an argument")
    return pieces, at + 1


def _substitution(text: str, at: int, quote: str, scope: Scope) -> tuple[str, int]:
    """Reads what follows $( and returns its value and the place behind its )."""
    name = _NAME.match(text, at)
    if name is None:
        raise LaunchError(f"substitution: found {text!r}, allowed {one_of(_COMMANDS)} after $(")
    at, words = name.end(), [name.group()]
    while text[at:at + 1] == " ":
        word, at = _argument(text, at + 1, quote, scope)
        words.append(word)
    if text[at:at + 1] != ")":
        raise LaunchError(f"substitution: found {text!r}, allowed a ) for every $(, one blank between arguments, and quotes around "
                          "a whole argument, as around one with blanks or parentheses")
    return _value(words, scope), at + 1


def _argument(text: str, at: int, quote: str, scope: Scope) -> tuple[str, int]:
    """One argument: in quotes, or up to the next blank or ). Inside quotes no other argument has quotes."""
    if not quote and text[at:at + 1] in ("'", '"'):
        pieces, at = _template(text, at + 1, text[at], scope)
        return "".join(piece for piece, _ in pieces), at
    word, begin = "", at
    while at < len(text):
        if text.startswith("$(", at):
            value, at = _substitution(text, at + 2, quote, scope)
            word += value
        elif text[at] == "\\" and text[at + 1:at + 2] not in ("", " "):
            word, at = word + text[at + 1], at + 2
        elif text[at] in " ()" or text[at] in (quote or "'\""):
            break
        else:
            word, at = word + text[at], at + 1
    if at == begin:
        raise LaunchError(f"substitution: found {text!r}, allowed one blank before each argument, '' for an empty one")
    return word, at


def _value(words: list[str], scope: Scope) -> str:
    if not words:
        raise LaunchError(f"substitution: found $(), allowed {one_of(_COMMANDS)}")
    name, *arguments = words
    if name not in _COMMANDS:
        raise LaunchError(f"substitution: found $({name}), allowed {one_of(_COMMANDS)}")
    command, fewest, most = _COMMANDS[name]
    if not fewest <= len(arguments) <= most:
        allowed = str(fewest) if fewest == most else f"{fewest} to {most}"
        raise LaunchError(f"substitution: found $({name}) with {len(arguments)} arguments, "
                          f"allowed {allowed}")
    return command(scope, *arguments)


def _var(scope: Scope, name: str, *default: str) -> str:
    if name in scope.variables:
        return scope.variables[name]
    if default:
        return default[0]
    raise LaunchError(f"$(var): found {name!r}, allowed {one_of(scope.variables)}")


def _env(scope: Scope, name: str, *default: str) -> str:
    if name in scope.environment:
        return scope.environment[name]
    if default:
        return default[0]
    raise LaunchError(f"$(env): found {name!r}, allowed a variable that is set, or a second "
                      "argument to take instead" + near(name, scope.environment))


def truth(text: str) -> bool:
    """The two values of a condition, as launch files write them."""
    word = text.strip().lower()
    if word in ("true", "1"):
        return True
    if word in ("false", "0"):
        return False
    raise LaunchError(f"condition: found {text!r}, allowed true, 1, false, 0")


def _word(value: bool) -> str:
    return "true" if value else "false"


# ---- eval ---------------------------------------------------------------------------------------

_OPERATORS: dict[type, Callable] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul,
    ast.Div: operator.truediv, ast.FloorDiv: operator.floordiv, ast.Mod: operator.mod,
    ast.Eq: operator.eq, ast.NotEq: operator.ne, ast.Lt: operator.lt, ast.LtE: operator.le,
    ast.Gt: operator.gt, ast.GtE: operator.ge,
    ast.In: lambda a, b: a in b, ast.NotIn: lambda a, b: a not in b,
    ast.Not: operator.not_, ast.USub: operator.neg, ast.UAdd: operator.pos,
}
_LONGEST_EXPRESSION = 1000


def _eval(_: Scope, text: str) -> str:
    if len(text) > _LONGEST_EXPRESSION:
        raise LaunchError(f"$(eval): found {len(text)} signs, allowed {_LONGEST_EXPRESSION}")
    try:
        return str(_reckon(ast.parse(text.strip(), mode="eval").body))
    except LaunchError:
        raise
    except (SyntaxError, TypeError, ValueError, ArithmeticError, RecursionError, MemoryError) as why:
        raise LaunchError(f"$(eval): found {text!r}, allowed an expression ({why})") from why


def _reckon(node: ast.AST):
    if isinstance(node, ast.Constant) and isinstance(node.value, (bool, int, float, str)):
        return node.value
    if isinstance(node, (ast.List, ast.Tuple)):
        return [_reckon(entry) for entry in node.elts]
    if isinstance(node, ast.IfExp):
        return _reckon(node.body if _reckon(node.test) else node.orelse)
    if isinstance(node, ast.BoolOp):
        value = _reckon(node.values[0])
        for other in node.values[1:]:
            if bool(value) == isinstance(node.op, ast.Or):
                break
            value = _reckon(other)
        return value
    if isinstance(node, ast.UnaryOp) and type(node.op) in _OPERATORS:
        return _OPERATORS[type(node.op)](_reckon(node.operand))
    if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
        left, right = _reckon(node.left), _reckon(node.right)
        if isinstance(node.op, ast.Mult) and not all(isinstance(x, (int, float)) for x in (left, right)):
            raise LaunchError("$(eval): found a product of texts, allowed one of numbers")
        return _OPERATORS[type(node.op)](left, right)
    if isinstance(node, ast.Compare):
        left = _reckon(node.left)
        for compare, entry in zip(node.ops, node.comparators):
            right = _reckon(entry)
            if type(compare) not in _OPERATORS or not _OPERATORS[type(compare)](left, right):
                return False
            left = right
        return True
    raise LaunchError(f"$(eval): found {ast.unparse(node)!r}, allowed numbers, texts in quotes and "
                      "operators")


# Function, fewest and most arguments.
_COMMANDS: dict[str, tuple[Callable[..., str], int, int]] = {
    "var": (_var, 1, 2),
    "env": (_env, 1, 2),
    "find-pkg-share": (lambda scope, name: str(scope.packages.share(name)), 1, 1),
    "find-pkg-prefix": (lambda scope, name: str(scope.packages.prefix(name)), 1, 1),
    "dirname": (lambda scope: str(scope.folder), 0, 0),
    "eval": (_eval, 1, 1),
    "not": (lambda scope, a: _word(not truth(a)), 1, 1),
    "and": (lambda scope, a, b: _word(truth(a) and truth(b)), 2, 2),
    "or": (lambda scope, a, b: _word(truth(a) or truth(b)), 2, 2),
}

# SPDX-License-Identifier: BSD-3-Clause
"""Strict reading of YAML: every value knows its file, line and key, and each error is one line of them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import NoReturn

import yaml

MAX_BYTES = 1_000_000


class CampaignError(ValueError):
    """Bad input of a campaign: one line with what was found and what is allowed."""


class Value:
    """One value of a file."""

    def __init__(self, file: str, key: str, node: yaml.Node):
        self.file = file
        self.key = key  #: From the top, such as `faults[1].at_s`.
        self._node = node

    @property
    def line(self) -> int:
        return int(self._node.start_mark.line) + 1

    def fail(self, text: str) -> NoReturn:
        key = f"{self.key}: " if self.key else ""
        raise CampaignError(f"{self.file}:{self.line}: {key}{text}")

    def refuse(self, allowed: str) -> NoReturn:
        self.fail(f"found {self.shown()}, allowed {allowed}")

    def shown(self) -> str:
        if isinstance(self._node, yaml.MappingNode):
            return "a map"
        if isinstance(self._node, yaml.SequenceNode):
            return f"a list of {len(self._node.value)}"
        return f"'{self._node.value}'" if self._node.value else "nothing"

    def is_map(self) -> bool:
        return isinstance(self._node, yaml.MappingNode)

    def is_list(self) -> bool:
        return isinstance(self._node, yaml.SequenceNode)

    def entries(self, allowed: Iterable[str] | None = None) -> dict[str, Value]:
        """@param allowed: the keys that it may have; None: any."""
        if not isinstance(self._node, yaml.MappingNode):
            self.refuse("a map")
        names = None if allowed is None else tuple(allowed)
        found: dict[str, Value] = {}
        for key, value in self._node.value:
            if not isinstance(key, yaml.ScalarNode):
                Value(self.file, self.key, key).refuse("a name as key")
            name = str(key.value)
            child = Value(self.file, f"{self.key}.{name}" if self.key else name, value)
            at_key = Value(self.file, self.key, key)
            if names is not None and name not in names:
                at_key.fail(f"found the key '{name}', allowed {', '.join(names)}")
            if name in found:
                at_key.fail(f"found the key '{name}' twice, allowed once")
            found[name] = child
        return found

    def elements(self) -> list[Value]:
        """Its elements, at least one."""
        if not isinstance(self._node, yaml.SequenceNode):
            self.refuse("a list")
        if not self._node.value:
            self.fail("found an empty list, allowed at least one element")
        return [Value(self.file, f"{self.key}[{k}]", node) for k, node in enumerate(self._node.value)]

    def text(self, allowed: str = "a text") -> str:
        if not isinstance(self._node, yaml.ScalarNode) or not self._node.value:
            self.refuse(allowed)
        return str(self._node.value)

    def one_of(self, names: Iterable[str]) -> str:
        allowed = tuple(names)
        text = self.text(", ".join(allowed))
        if text not in allowed:
            self.refuse(", ".join(allowed))
        return text

    def is_number(self) -> bool:
        return isinstance(self._node, yaml.ScalarNode) and self._node.style is None and _number(self._node.value) is not None

    def number(self, low: float = -math.inf, high: float = math.inf) -> float:
        allowed = "a number" + (f" from {low:g}" if low > -math.inf else "") + (f" to {high:g}" if high < math.inf else "")
        number = _number(self._node.value) if isinstance(self._node, yaml.ScalarNode) and self._node.style is None else None
        if number is None or not low <= number <= high:
            self.refuse(allowed)
        return number

    def whole(self, low: int, high: int) -> int:
        text = self._node.value if isinstance(self._node, yaml.ScalarNode) and self._node.style is None else ""
        if not text.isascii() or not text.isdigit() or len(text) > 20 or not low <= int(text) <= high:
            self.refuse(f"a whole number from {low} to {high}")
        return int(text)


def _number(text: str) -> float | None:
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) and "_" not in text else None


def load(file: Path) -> tuple[Value, str]:
    """The document and its text. Raises CampaignError."""
    try:
        if file.stat().st_size > MAX_BYTES:
            raise CampaignError(f"{file}: found {file.stat().st_size} bytes, allowed {MAX_BYTES}")
        text = file.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise CampaignError(f"{file}: found a file that is not UTF-8, allowed a YAML file") from None
    except OSError as error:
        raise CampaignError(f"{file}: cannot read it: {error.strerror}") from None
    try:
        node = yaml.compose(text, Loader=yaml.SafeLoader)
    except (yaml.YAMLError, RecursionError) as error:
        mark = getattr(error, "problem_mark", None)
        line = f":{mark.line + 1}" if mark else ""
        raise CampaignError(f"{file}{line}: found {getattr(error, 'problem', None) or 'text that is no YAML'}, allowed YAML") from None
    if node is None:
        raise CampaignError(f"{file}: found nothing, allowed a map")
    return Value(str(file), "", node), text

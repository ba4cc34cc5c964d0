# SPDX-License-Identifier: BSD-3-Clause
"""What is wrong with a launch, in one line."""

import difflib
from collections.abc import Iterable


class LaunchError(Exception):
    """FILE:LINE: what: found X, allowed Y."""


def one_of(names: Iterable[str]) -> str:
    names = sorted(names)
    return "one of " + ", ".join(names) if names else "nothing"


def near(name: str, names: Iterable[str]) -> str:
    """Names that resemble one, as words for the end of a message."""
    close = difflib.get_close_matches(name, list(names), 3, 0.6)
    return f", such as {', '.join(close)}" if close else ""

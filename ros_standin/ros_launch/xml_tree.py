# SPDX-License-Identifier: BSD-3-Clause
"""XML with the line of every element, for messages that people can act on."""

from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

from .errors import LaunchError, one_of


@dataclass
class Element:
    tag: str
    attributes: dict[str, str]
    file: Path
    line: int
    children: list["Element"] = field(default_factory=list)

    @property
    def where(self) -> str:
        return f"{self.file}:{self.line}"

    def error(self, text: str) -> LaunchError:
        return LaunchError(f"{self.where}: {text}")

    def check(self, required: set[str], optional: set[str], children: set[str]) -> None:
        """Attributes and kinds of children are those that there are."""
        allowed = required | optional
        for name in self.attributes:
            if name not in allowed:
                raise self.error(f"attribute of <{self.tag}>: found {name!r}, "
                                 f"allowed {one_of(allowed)}")
        for name in sorted(required - self.attributes.keys()):
            raise self.error(f"<{self.tag}>: found no attribute {name!r}, allowed with it only")
        for child in self.children:
            if child.tag not in children:
                raise child.error(f"element in <{self.tag}>: found <{child.tag}>, allowed "
                                  + one_of(f"<{name}>" for name in children))


def read(file: Path) -> Element:
    """The root element of a file."""
    try:
        text = file.read_bytes()
    except OSError as why:
        raise LaunchError(f"{file}: found no file that can be read ({why.strerror}), "
                          "allowed a launch file") from why
    roots: list[Element] = []
    open_elements: list[Element] = []
    parser = expat.ParserCreate()

    def start(tag: str, attributes: dict[str, str]) -> None:
        element = Element(tag, attributes, file, parser.CurrentLineNumber)
        (open_elements[-1].children if open_elements else roots).append(element)
        open_elements.append(element)

    def words(data: str) -> None:
        if data.strip():
            raise LaunchError(f"{file}:{parser.CurrentLineNumber}: found the text "
                              f"{data.strip()!r}, allowed elements and comments")

    def no_entities(*_: object) -> None:
        raise LaunchError(f"{file}:{parser.CurrentLineNumber}: found <!ENTITY>, allowed none")

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: open_elements.pop()
    parser.CharacterDataHandler = words
    parser.EntityDeclHandler = no_entities
    try:
        parser.Parse(text, True)
    except expat.ExpatError as why:
        raise LaunchError(f"{file}:{why.lineno}: found {expat.ErrorString(why.code)}, "
                          "allowed well-formed XML") from why
    return roots[0]

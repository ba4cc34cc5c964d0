# SPDX-License-Identifier: BSD-3-Clause
"""Make C++ structs, their serialisation and their schema texts from ROS 2 message definitions.

usage: generate.py OUTPUT FOLDER...

FOLDER is a package with its definitions in FOLDER/msg/*.msg; its name is the name of the package. Every type that a
definition names must be in one of the folders. Writes OUTPUT/messages/PACKAGE.hpp for each package and
OUTPUT/messages/generated.cpp. A definition that cannot be used ends the program with one line and exit code 2.

Not supported, because no message here needs it: wide and bounded strings, bounded arrays, arrays of strings, arrays of messages but TYPE[].
"""

import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

NUMBERS = {"bool": ("bool", 1), "byte": ("std::uint8_t", 1), "char": ("std::uint8_t", 1), "float32": ("float", 4),
           "float64": ("double", 8)}
NUMBERS |= {f"{sign}int{bits}": (f"std::{sign}int{bits}_t", bits // 8) for sign in ("", "u") for bits in (8, 16, 32, 64)}
TYPE = re.compile(r"(?:(?P<package>[a-z]\w*)/)?(?P<name>\w+)(?P<array>\[(?P<count>\d*)\])?")
FIELD_NAME, CONSTANT_NAME, MESSAGE_NAME = (re.compile(p) for p in (r"[a-z][a-z0-9_]*", r"[A-Z][A-Z0-9_]*", r"[A-Z]\w*"))
LICENCE = "SPDX-License-Identifier"
SEPARATOR = "=" * 80


class BadDefinition(ValueError):
    """A definition that cannot be used; the text names file, line and what was found."""


@dataclass
class Field:
    where: str
    type: str  # a number's name, "string" or PACKAGE/NAME
    name: str
    count: int | None = None  # None: one value; 0: a sequence; else a fixed array
    default: str = ""

    @property
    def is_sequence_of_messages(self) -> bool:
        return "/" in self.type and self.count == 0

    @property
    def cpp_type(self) -> str:
        single = NUMBERS[self.type][0] if self.type in NUMBERS else \
            "std::string" if self.type == "string" else self.type.replace("/", "::")
        if self.count is None:
            return single
        return f"std::array<{single}, {self.count}>" if self.count else f"std::vector<{single}>"


@dataclass
class Message:
    package: str
    name: str
    text: str  # the schema: the definition without its licence line
    fields: list[Field] = field(default_factory=list)
    constants: list[tuple[str, str, str]] = field(default_factory=list)  # type, name, value

    @property
    def key(self) -> str:
        return f"{self.package}/{self.name}"

    def inner(self) -> list[str]:
        return [f.type for f in self.fields if "/" in f.type]


# ---- reading --------------------------------------------------------------------------------------


def value_of(kind: str, text: str, where: str) -> str:
    """A constant or default as C++ writes it."""
    try:
        if kind == "bool":
            return {"true": "true", "false": "false", "1": "true", "0": "false"}[text.lower()]
        if kind in ("float32", "float64"):
            return repr(float(text)) + ("F" if kind == "float32" else "")
        value, bits = int(text, 0), 8 * NUMBERS[kind][1]
        signed = kind.startswith("int")
        lowest, highest = (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)
        if not lowest <= value <= highest:
            raise ValueError
        return str(value)
    except (KeyError, ValueError):
        raise BadDefinition(f"{where}: found '{text}', allowed a {kind}") from None


def parse_line(message: Message, line: str, where: str):
    """Adds what one line declares: `TYPE NAME=VALUE` or `TYPE NAME [DEFAULT]`."""
    constant = re.fullmatch(r"(\w+)\s+(\w+)\s*=\s*(.+)", line)
    words = line.split()
    if not constant and len(words) not in (2, 3):
        raise BadDefinition(f"{where}: found '{line}', allowed TYPE NAME, TYPE NAME DEFAULT or TYPE NAME=VALUE")
    names = {name for _, name, _ in message.constants} | {f.name for f in message.fields}
    kind, name = constant.groups()[:2] if constant else words[:2]
    if not (CONSTANT_NAME if constant else FIELD_NAME).fullmatch(name):
        allowed = "a constant in CAPITALS" if constant else "a field in small letters"
        raise BadDefinition(f"{where}: found the name '{name}', allowed {allowed}")
    if name in names:
        raise BadDefinition(f"{where}: '{name}' is there twice")
    if constant:
        if kind not in NUMBERS:
            raise BadDefinition(f"{where}: found a constant of type '{kind}', allowed {', '.join(NUMBERS)}")
        message.constants.append((kind, name, value_of(kind, constant[3].strip(), where)))
        return
    found = TYPE.fullmatch(kind)
    if not found:
        raise BadDefinition(f"{where}: found the type '{kind}', allowed NAME, PACKAGE/NAME, TYPE[COUNT] or TYPE[]")
    basic = found["name"] in NUMBERS or found["name"] == "string"
    type_name = found["name"] if basic and not found["package"] else f"{found['package'] or message.package}/{found['name']}"
    count = int(found["count"] or 0) if found["array"] else None
    sequence_of_messages = "/" in type_name and count == 0 and found["count"] == ""
    if found["array"] and not sequence_of_messages and (
            type_name not in NUMBERS or found["count"] == "0" or (count == 0 and type_name == "bool")):
        raise BadDefinition(f"{where}: found '{kind}', allowed TYPE[COUNT] and TYPE[] of numbers, bool[COUNT] and MESSAGE[]")
    default = ""
    if len(words) == 3:
        if type_name not in NUMBERS or found["array"]:
            raise BadDefinition(f"{where}: found a default for '{kind}', allowed for single numbers only")
        default = value_of(type_name, words[2], where)
    message.fields.append(Field(where, type_name, name, count, default))


def parse(path: Path, package: str) -> Message:
    lines = path.read_text().splitlines()
    if not MESSAGE_NAME.fullmatch(path.stem):
        raise BadDefinition(f"{path}: found the name '{path.stem}', allowed a capital, then letters and digits")
    message = Message(package, path.stem, "\n".join(l for l in lines if LICENCE not in l).strip("\n") + "\n")
    for number, line in enumerate(lines, 1):
        line = line.split("#")[0].strip()
        if line:
            parse_line(message, line, f"{path}:{number}")
    if not message.fields:
        raise BadDefinition(f"{path}: found no field, allowed one or more")
    return message


def read(folders: list[Path]) -> dict[str, Message]:
    """All messages by PACKAGE/NAME, each behind those inside it."""
    found = {}
    for folder in folders:
        files = sorted(folder.glob("msg/*.msg"))
        if not files:
            raise BadDefinition(f"{folder}/msg: found no .msg file")
        found |= {f"{folder.name}/{path.stem}": parse(path, folder.name) for path in files}
    ordered: dict[str, Message] = {}

    def add(key: str, trail: tuple[str, ...]):
        if key in trail:
            raise BadDefinition(f"{found[key].fields[0].where.split(':')[0]}: {key} contains itself")
        for inner in found[key].fields:
            if "/" in inner.type:
                if inner.type not in found:
                    raise BadDefinition(f"{inner.where}: no definition of {inner.type} in the folders given")
                add(inner.type, (*trail, key))
        ordered.setdefault(key, found[key])

    for key in found:
        add(key, ())
    return ordered


def schema_of(message: Message, messages: dict[str, Message]) -> str:
    """The definition and behind it those of all types inside, as rosbag2 and Foxglove expect of "ros2msg"."""
    wanted, text = message.inner(), message.text
    for at, key in enumerate(wanted):  # grows while it is walked
        if key not in wanted[:at]:
            text += f"{SEPARATOR}\nMSG: {key}\n{messages[key].text}"
            wanted += messages[key].inner()
    return text


# ---- writing --------------------------------------------------------------------------------------


def leaves(message: Message, messages: dict[str, Message], path: str = ""):
    """Numbers, strings, arrays and sequences in the order of the wire, by their path from the message."""
    for one in message.fields:
        if "/" in one.type and one.count is None:
            yield from leaves(messages[one.type], messages, f"{path}{one.name}.")
        else:
            yield path + one.name, one


def serialiser(message: Message, messages: dict[str, Message]) -> list[str]:
    """The body of serialize(): runs of fixed size, whose inner layout is known here, between strings and sequences."""
    body: list[str] = []
    run: list[str] = []
    start_alignment = size = 0

    def close():
        nonlocal run
        if run:
            body.append(f"  {{ std::uint8_t* const to = out.run({start_alignment}, {size});")
            body.extend(f"    {line}" for line in run)
            body[-1] += " }"
        run = []

    for path, one in leaves(message, messages):
        if one.is_sequence_of_messages:
            close()
            body += [f"  out.put_count(m.{path}.size());", f"  for (const auto& one : m.{path}) serialize(out, one);"]
            continue
        if one.type == "string" or one.count == 0:
            close()
            body.append(f"  out.put(m.{path});")
            continue
        width = NUMBERS[one.type][1]
        if run and width > start_alignment:
            close()
        if not run:
            start_alignment, size = width, 0
        gap = -size % width
        if gap:
            run.append(f"cdr::pad(to + {size}, {gap});")
        run.append(f"cdr::store(to + {size + gap}, m.{path});")
        size += gap + width * (one.count or 1)
    close()
    return body


def struct(message: Message, messages: dict[str, Message]) -> list[str]:
    lines = [f"/// {message.package}/msg/{message.name}", f"struct {message.name} {{"]
    lines += [f"  static constexpr {NUMBERS[kind][0]} {name} = {value};" for kind, name, value in message.constants]
    lines += [f"  {one.cpp_type} {one.name}{{{one.default}}};" for one in message.fields]
    lines += [f'  static constexpr std::string_view kName = "{message.package}/msg/{message.name}";',
              "  static std::string_view schema();",
              "  template <class From, class To> static void copy(const From& from, To& to) {"]
    for path, one in leaves(message, messages):
        if one.is_sequence_of_messages:
            lines += [f"    to.{path}.resize(from.{path}.size());",
                      f"    for (std::size_t k = 0; k < from.{path}.size(); ++k)",
                      f"      {one.type.replace('/', '::')}::copy(from.{path}[k], to.{path}[k]);"]
        else:
            lines.append(f"    to.{path} = from.{path};")
    return [*lines, "  }", "};", f"void serialize(CdrWriter& out, const {message.name}& m);", ""]


def header(package: str, messages: dict[str, Message]) -> str:
    mine = [m for m in messages.values() if m.package == package]
    others = sorted({key.split("/")[0] for m in mine for key in m.inner()} - {package})
    # Every member is initialised alike, so that a caller may leave any out.
    lines = ["// Generated by messages/generate.py.", "// NOLINTBEGIN(readability-redundant-member-init)", "#pragma once",
             "#include <array>", "#include <cstddef>", "#include <cstdint>", "#include <string>", "#include <string_view>", "#include <vector>", "",
             *(f'#include "messages/{name}.hpp"' for name in ("cdr", *others)), "",
             f"namespace rosflight::messages::{package} {{", ""]
    for message in mine:
        lines += struct(message, messages)
    return "\n".join([*lines, f"}}  // namespace rosflight::messages::{package}",
                      "// NOLINTEND(readability-redundant-member-init)", ""])


def source(packages: list[str], messages: dict[str, Message]) -> str:
    lines = ["// Generated by messages/generate.py.", *(f'#include "messages/{name}.hpp"' for name in packages), ""]
    for m in messages.values():
        lines += [f"namespace rosflight::messages::{m.package} {{",
                  f"void serialize(CdrWriter& out, const {m.name}& m) {{", *serialiser(m, messages), "}",
                  f"std::string_view {m.name}::schema() {{", f'  return R"SCHEMA({schema_of(m, messages)})SCHEMA";', "}",
                  "}", ""]
    return "\n".join(lines)


def main(arguments: list[str]) -> int:
    if len(arguments) < 2:
        print(__doc__, file=sys.stderr)
        return 2
    output, folders = Path(arguments[0]) / "messages", [Path(folder) for folder in arguments[1:]]
    try:
        messages = read(folders)
    except (BadDefinition, OSError, UnicodeDecodeError) as error:
        print(error, file=sys.stderr)
        return 2
    packages = [folder.name for folder in folders]
    output.mkdir(parents=True, exist_ok=True)
    for package in packages:
        (output / f"{package}.hpp").write_text(header(package, messages))
    (output / "generated.cpp").write_text(source(packages, messages))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

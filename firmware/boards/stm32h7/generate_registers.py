# SPDX-License-Identifier: BSD-3-Clause
"""Makes C++ constants of the tables of the chip.

Usage: generate_registers.py REGISTERS.csv INSTANCES.csv REQUESTS.csv HEADER LIST

HEADER is for drivers: offsets, fields, instances, interrupt and DMA request numbers. LIST is for the models of the
emulated chip: each register's name and its defined bits.
"""

import csv
import sys
from pathlib import Path

TOP = "// SPDX-License-Identifier: BSD-3-Clause\n// Generated from {sources}.\n#pragma once\n"


class TableError(Exception):
    """One line: file, row, what was found, what is allowed."""


def read_table(path: Path) -> list[dict]:
    """Rows by the names of the first line; lines with # are comments."""
    with path.open(newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def fields_of(row: dict) -> list[tuple[str, int, int]]:
    """Name, lowest bit and width of each field of a register."""
    fields = []
    for text in row["fields"].split():
        name, colon, place = text.partition(":")
        low, plus, width = place.partition("+")
        if not (colon and plus and low.isdigit() and width.isdigit() and 0 < int(width) and int(low) + int(width) <= 32):
            raise TableError(f"{row['block']}.{row['register']}: found field '{text}', allowed NAME:lsb+width within 32 bits")
        fields.append((name, int(low), int(width)))
    return fields


def defined_bits(row: dict) -> int:
    mask = 0
    for _, low, width in fields_of(row):
        mask |= ((1 << width) - 1) << low
    return mask


def bit_of(name: str, registers: list[dict]) -> tuple[int, int]:
    """Offset in RCC and bit of 'AHB1ENR.DMA1EN'."""
    register, _, wanted = name.partition(".")
    for row in registers:
        if row["block"] == "RCC" and row["register"] == register:
            for field, low, _ in fields_of(row):
                if field == wanted:
                    return int(row["offset"], 16), low
    raise TableError(f"found RCC bit '{name}', allowed one of registers.csv")


def header(registers: list[dict], instances: list[dict], requests: list[dict]) -> str:
    lines = [TOP.format(sources="registers.csv, instances.csv and requests.csv"),
             '#include "firmware/boards/stm32h7/register.hpp"\n', "namespace rosflight::boards::stm32h7 {\n"]
    for block in dict.fromkeys(row["block"] for row in registers):
        lines.append(f"namespace {block.lower()} {{")
        for row in (row for row in registers if row["block"] == block):
            lines.append(f"inline constexpr std::uint32_t {row['register']} = {row['offset']};")
            lines += [f"inline constexpr Field {row['register']}_{name}{{{low}, {width}}};"
                      for name, low, width in fields_of(row)]
        lines.append(f"}}  // namespace {block.lower()}\n")
    for row in instances:
        gate, bit = bit_of(row["enable"], registers) if row["enable"] else (0, 0)
        lines.append(f"inline constexpr Instance {row['instance']}{{{row['base']}, {gate:#x}, {bit}}};")
    lines.append("\nnamespace irq {")
    for name, number in interrupts(instances).items():
        lines.append(f"inline constexpr unsigned {name} = {number};")
    lines.append("}  // namespace irq\n\nnamespace request {")
    lines += [f"inline constexpr std::uint32_t {row['request']} = {row['number']};" for row in requests]
    lines.append("}  // namespace request\n\n}  // namespace rosflight::boards::stm32h7")
    return "\n".join(lines) + "\n"


def interrupts(instances: list[dict]) -> dict[str, int]:
    found = {}
    for row in instances:
        for text in row["interrupts"].split():
            name, _, number = text.partition("=")
            if found.setdefault(name, int(number)) != int(number):
                raise TableError(f"instances.csv: found two numbers of interrupt {name}, allowed one")
    return found


def register_list(registers: list[dict]) -> str:
    rows = "\n".join(f'    {{"{r["block"]}", "{r["register"]}", {r["offset"]}, {defined_bits(r):#x}}},' for r in registers)
    return (TOP.format(sources="registers.csv") + "#include <cstdint>\n\nnamespace rosflight::boards::stm32h7 {\n\n"
            "struct RegisterName {\n  const char* block;\n  const char* name;\n  std::uint32_t offset;\n"
            "  std::uint32_t defined_bits;\n};\n\n"
            f"inline constexpr RegisterName kRegisterNames[] = {{\n{rows}\n}};\n\n"
            "}  // namespace rosflight::boards::stm32h7\n")


def main(arguments: list[str]) -> int:
    if len(arguments) != 5:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        registers, instances, requests = (read_table(Path(name)) for name in arguments[:3])
        Path(arguments[3]).write_text(header(registers, instances, requests))
        Path(arguments[4]).write_text(register_list(registers))
    except (TableError, OSError) as error:
        print(f"generate_registers.py: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

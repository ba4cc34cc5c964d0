# SPDX-License-Identifier: BSD-3-Clause
"""The rules of check_boards.py, each shown on a small tree that breaks it."""

from pathlib import Path

import check_boards
import check_structure
import project
import pytest

EMULATOR = "firmware/boards/stm32h7/emulator/CMakeLists.txt"
LIST = """set(unicorn ${ROSFLIGHT_ROOT}/.venv/unicorn)  # under the GPL
add_library(h7_chip SHARED processor.cpp)
target_link_libraries(h7_chip PUBLIC rosflight::h7_models PRIVATE ${unicorn}/lib/libunicorn.so.2)
rosflight_program(h7_emulator SOURCES emulator_main.cpp USES h7_chip)
foreach(target IN ITEMS h7_processor_test)
  target_link_libraries(${target} PRIVATE h7_chip)
endforeach()
"""


def tree(files: dict[str, str]) -> check_structure.Tree:
    return check_structure.Tree(Path(), list(map(Path, files)), dict((Path(name), text) for name, text in files.items()))


def own() -> check_structure.Tree:
    return check_structure.Tree(project.ROOT, project.own_files(project.ROOT))


@pytest.mark.parametrize("line", ["#ifdef EMULATED", "#if EMULATED", "  # ifndef NDEBUG", "#elif defined(SILICON)"])
@pytest.mark.parametrize("folder", ["stm32h7", "stm32h7/emulator", "pixracer_pro", "varmint", "parts", "common"])
def test_a_condition_in_the_sources_of_a_board_is_found(folder, line):
    (found,) = check_boards.check_one_image(tree({f"firmware/boards/{folder}/pins.cpp": f"int a;\n{line}\n#endif\n"}))
    assert found.startswith(f"firmware/boards/{folder}/pins.cpp:2: {line.strip()}: ")


def test_conditions_elsewhere_and_other_directives_are_allowed():
    assert check_boards.check_one_image(tree({
        "firmware/boards/qemu_m7/a.cpp": "#ifdef X\n", "base/a.hpp": "#if X\n",
        "firmware/boards/varmint/a.hpp": '#pragma once\n#include "b.hpp"\n#define A 1\n// #if in a comment\n'})) == []


@pytest.mark.parametrize("name, text, target", [
    (EMULATOR, LIST.replace("h7_processor_test)", "h7_processor_test rosflight)"), "rosflight must not link h7_chip"),
    (EMULATOR, LIST + "target_link_libraries(rosflight_flight PRIVATE ${unicorn}/lib/x.so)\n", "rosflight_flight must not link unicorn"),
    ("apps/CMakeLists.txt", "target_link_libraries(rosflight PRIVATE unicorn)\n", "rosflight must not link unicorn"),
    ("apps/CMakeLists.txt", "rosflight_program(rosflight SOURCES main.cpp USES h7_chip)\n", "rosflight must not link h7_chip"),
    ("flight/CMakeLists.txt", "rosflight_library(flight\n  SOURCES a.cpp\n  USES Unicorn::unicorn)\n", "flight must not link unicorn"),
])
def test_a_program_that_links_unicorn_is_found(name, text, target):
    (found,) = check_boards.check_unicorn(tree({EMULATOR: LIST, name: text}))
    assert found.startswith(f"{name}: {target}; only ")


def test_unicorn_is_included_by_the_emulator_alone():
    line = "#include <unicorn/unicorn.h>\n"
    (found,) = check_boards.check_unicorn(tree({
        EMULATOR: LIST, "firmware/boards/stm32h7/emulator/processor.cpp": line, "flight/a.cpp": line}))
    assert found.startswith("flight/a.cpp:1: ")


def test_those_that_link_unicorn_are_found_in_the_projects_own_list():
    text = own().text(Path(EMULATOR))
    assert {library: check_boards.linked_with(text, library) for library in check_boards.UNICORN_TARGETS} == check_boards.UNICORN_TARGETS


@pytest.mark.parametrize("path", ["firmware/boards/parts/bmi088.cpp", "firmware/boards/parts/models/bmi088_model.hpp",
                                  "firmware/boards/parts/test/bmi088_test.cpp"])
def test_a_part_that_includes_a_chip_is_found(path):
    (found,) = check_boards.check_parts(tree({
        path: '#include "firmware/hal/time.hpp"\n#include "firmware/boards/stm32h7/spi_bus.hpp"\n',
        "firmware/boards/varmint/board.hpp": '#include "firmware/boards/stm32h7/spi_bus.hpp"\n'}))
    assert found.startswith(f"{path}:2: ")


def test_the_rules_are_among_those_of_each_run():
    assert {check_boards.check_one_image, check_boards.check_unicorn, check_boards.check_parts} <= set(check_structure.CHECKS)

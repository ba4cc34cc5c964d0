# SPDX-License-Identifier: BSD-3-Clause
import pytest

import m7_figures

MAP = """\
Archive member included to satisfy reference by file (symbol)

 .text._ZN5earlyEv
                0x00000010       0x10 before/the/map.cpp.obj

Linker script and memory map

 .text._ZN9estimator4stepEv
                0x00000900       0x40 firmware/core/librosflight_core.a(estimator.cpp.obj)
 .text.startup  0x00000100       0x20 bench/m7/CMakeFiles/m7_firmware_pass.dir/firmware_pass_main.cpp.obj
 .text.empty    0x00000a00        0x0 firmware/core/librosflight_core.a(mixer.cpp.obj)
 .text          0x00000940        0x8 /usr/lib/arm/libc_nano.a(lib_a-memcpy.o)
 .rodata        0x00000a40       0x80 firmware/core/librosflight_core.a(mixer.cpp.obj)
"""


def test_code_is_found_in_the_linkers_map_by_address():
    assert m7_figures.placed_code(MAP) == [
        (0x100, 0x20, "firmware_pass_main"), (0x900, 0x40, "estimator"), (0x940, 0x8, "lib_a-memcpy")]


@pytest.mark.parametrize("source, module", [
    ("estimator", "estimator"), ("mavlink_codec", "link"), ("firmware", "loop"),
    ("lib_a-memcpy", "library"), ("firmware_pass_main", None), ("startup", None)])
def test_each_file_belongs_to_a_module(source, module):
    assert m7_figures.module_of(source, {"firmware", "estimator"}) == module


def test_every_module_that_a_file_names_has_a_figure():
    assert set(m7_figures.MODULE_OF.values()) <= set(m7_figures.MODULES)


def test_load_is_cycles_of_all_passes_in_a_second_over_the_clock(monkeypatch):
    monkeypatch.setattr(m7_figures, "passes", lambda: {"instructions": 4000})
    # 4000 instructions, 1.5 cycles each, 400 times a second, of 400 million cycles
    assert m7_figures.load_percent() == pytest.approx(0.6)


def test_figures_of_a_policy_are_those_of_the_image_in_which_it_flies(monkeypatch):
    images = {"firmware_pass": {"instructions": 4000, "stack_bytes": 3000},
              "firmware_pass_policy": {"instructions": 30000, "stack_bytes": 3500, "policy_bytes": 400, "policy_flies": 1}}
    monkeypatch.setattr(m7_figures, "passes", lambda name="firmware_pass": images[name])
    assert m7_figures.policy_ram_bytes() == 900
    # 30000 instructions, 1.5 cycles each, 400 times a second, of 400 million cycles
    assert m7_figures.load_percent(m7_figures.policy_passes()["instructions"]) == pytest.approx(4.5)
    images["firmware_pass_policy"]["policy_flies"] = 0
    with pytest.raises(RuntimeError, match="the policy did not fly"):
        m7_figures.policy_passes()

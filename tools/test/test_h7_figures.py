# SPDX-License-Identifier: BSD-3-Clause
import h7_figures
import pytest

SIZE = """firmware.elf  :
section           size        addr
.text           100000   134217728
.ARM.exidx           8   134317728
.stack           17408   536870912
.data               96   536888320
.bss             40000   536888416
.dma              5120   805568512
.record         512000   603979776
.debug_info      99999           0
Total           262631
"""


@pytest.fixture
def sections(monkeypatch):
    monkeypatch.setattr(h7_figures, "sections", lambda board: h7_figures.sizes_of(SIZE))


def test_initial_values_count_in_flash_and_ram(sections):
    assert h7_figures.text_bytes() == 100000 + 8 + 96
    assert h7_figures.ram_bytes() == 17408 + 96 + 40000 + 5120


def test_the_flight_record_is_counted_apart(sections):
    assert h7_figures.record_bytes() == 512000


def test_factor_is_simulated_time_over_the_median_of_three_processor_times(monkeypatch):
    times_s = {"pixracer_pro": iter([10.0, 30.0, 8.0]), "varmint": iter([8.0, 2.0, 9.0])}
    monkeypatch.setattr(h7_figures, "fly", lambda board: {"sim_time_s": 50.0, "cpu_s": next(times_s[board])})
    monkeypatch.setattr(h7_figures, "flight", lambda board: h7_figures.fly(board))
    assert h7_figures.realtime_factor() == 5.0
    assert h7_figures.realtime_factor("varmint") == 6.25


@pytest.mark.parametrize("missing", ["gnss_hz", "receiver_hz", "battery_hz"])
def test_round_trips_without_a_stream_do_not_count(monkeypatch, missing):
    found = {"lost": 0, "gnss_hz": 10.0, "receiver_hz": 50.0, "battery_hz": 10.0}
    monkeypatch.setattr(h7_figures.project, "build", lambda *words, **options: True)
    monkeypatch.setattr(h7_figures, "bench_program", lambda *words: found)
    assert h7_figures.measure_round_trips("varmint", "usb") == found
    found[missing] = 0.0
    with pytest.raises(RuntimeError, match=f"not all streams were on: {missing} is 0"):
        h7_figures.measure_round_trips("varmint", "usb")

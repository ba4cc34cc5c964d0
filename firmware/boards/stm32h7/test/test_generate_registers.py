# SPDX-License-Identifier: BSD-3-Clause
"""The generator of the chip's registers: what it makes of a table, and what it says to a wrong one."""

import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent.parent
REGISTERS = "block,register,offset,fields\nRCC,AHB1ENR,0xd8,DMA1EN:0+1\nSPI,CFG1,0x8,DSIZE:0+5 MBR:28+3\n"
INSTANCES = "instance,block,base,enable,reset,interrupts\nDMA1,DMA,0x40020000,AHB1ENR.DMA1EN,,DMA1_STREAM0=11\n"
REQUESTS = "request,number\nSPI5_RX,85\n"


def generate(folder, registers=REGISTERS, instances=INSTANCES, requests=REQUESTS):
    names = []
    for name, text in (("registers.csv", registers), ("instances.csv", instances), ("requests.csv", requests)):
        (folder / name).write_text(text)
        names.append(str(folder / name))
    header, listed = folder / "registers.hpp", folder / "list.hpp"
    done = subprocess.run([sys.executable, str(HERE / "generate_registers.py"), *names, str(header), str(listed)],
                          capture_output=True, text=True)
    return done, header, listed


def test_table_becomes_constants(tmp_path):
    done, header, listed = generate(tmp_path)
    assert done.returncode == 0, done.stderr
    text = header.read_text()
    assert "namespace spi {\ninline constexpr std::uint32_t CFG1 = 0x8;" in text
    assert "inline constexpr Field CFG1_MBR{28, 3};" in text
    assert "inline constexpr Instance DMA1{0x40020000, 0xd8, 0};" in text
    assert "inline constexpr unsigned DMA1_STREAM0 = 11;" in text
    assert "inline constexpr std::uint32_t SPI5_RX = 85;" in text
    assert '{"SPI", "CFG1", 0x8, 0x7000001f},' in listed.read_text()


@pytest.mark.parametrize(("change", "said"), [
    ({"registers": REGISTERS.replace("MBR:28+3", "MBR:28+5")}, "SPI.CFG1: found field 'MBR:28+5', allowed NAME:lsb+width"),
    ({"registers": REGISTERS.replace("MBR:28+3", "MBR")}, "SPI.CFG1: found field 'MBR'"),
    ({"instances": INSTANCES.replace("DMA1EN", "DMA9EN")}, "found RCC bit 'AHB1ENR.DMA9EN', allowed one of registers.csv"),
    ({"instances": INSTANCES + "X,DMA,0x0,,,DMA1_STREAM0=12\n"}, "found two numbers of interrupt DMA1_STREAM0"),
])
def test_wrong_table_is_refused_in_one_line(tmp_path, change, said):
    done, header, _ = generate(tmp_path, **change)
    assert done.returncode == 2
    assert said in done.stderr
    assert done.stderr.count("\n") == 1
    assert not header.exists()


def test_tables_of_the_chip_agree_with_known_facts(tmp_path):
    tables = {name: (HERE / f"{name}.csv").read_text() for name in ("registers", "instances", "requests")}
    done, header, _ = generate(tmp_path, **tables)
    assert done.returncode == 0, done.stderr
    text = header.read_text()
    # RM0433: memory map, RCC, interrupt vectors and DMAMUX1 inputs, looked up by hand.
    for line in ("Instance SPI5{0x40015000, 0xf0, 20}", "Instance USART2{0x40004400, 0xe8, 17}", "unsigned EXTI3 = 9",
                 "unsigned USART6 = 71", "std::uint32_t USART2_TX = 44", "Field CR1_CSTART{9, 1}"):
        assert line in text

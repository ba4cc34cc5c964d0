# SPDX-License-Identifier: BSD-3-Clause
"""The pins that the headers of the boards name, compared with the tables of facts beside them (pins.csv)."""

import csv
import re
from dataclasses import dataclass
from pathlib import Path

import pytest

BOARDS = Path(__file__).resolve().parent.parent.parent
LITERAL = re.compile(r"\{'([A-K])',\s*(\d+)\}")


@dataclass(frozen=True)
class Board:
    headers: tuple[str, ...]
    table: str
    column: str
    gpio: dict[str, list[str]]  # constant of a header -> functions of the table


VARMINT = {
    "kRedLed": ["led red"], "kGreenLed": ["led green"], "kBlueLed": ["led blue"],
    "kImuReady": ["imu data ready"], "kImuReset": ["imu reset"], "kImuDevices": ["imu select"],
    "kBaroBusDevices": ["barometer select", "magnetometer select"],
    "kPitotReady": ["pitot end of conversion"], "kPulsePerSecond": ["gnss pulse per second"],
    "kUnusedSelects": ["second accelerometer select", "second gyro select"]}
PIXRACER_PRO = {
    "kRedLed": ["led red"], "kGreenLed": ["led green"], "kBlueLed": ["led blue"], "kSensorSupply": ["3.3 V sensor supply enable"],
    "kLevelShifter": ["1.8 V level shifter enable"], "kGyroReady": ["gyro INT3"],
    "kImuDevices": ["accelerometer select", "gyro select"],
    "kBaroBusDevices": ["barometer select", "fram select"], "kPulsePerSecond": ["gnss pulse per second"],
    "kUnusedSelects": ["icm-20602 select", "icm-20948 select"]}
HEADER, PIXRACER_HEADER = "varmint/varmint_pins.hpp", "pixracer_pro/pixracer_pro_pins.hpp"
ALL = {
    "pixracer_pro": Board((PIXRACER_HEADER,), "pixracer_pro/pins.csv", "pin", PIXRACER_PRO),
    "varmint": Board((HEADER, "varmint/revision_11x.hpp"), "varmint/pins.csv", "pin_11x", VARMINT),
    "varmint_10x": Board((HEADER, "varmint/revision_10x.hpp"), "varmint/pins.csv", "pin_10x", VARMINT),
}


# ---- the header


def parsed(text: str):
    """A brace initialiser as nested lists of words; a pin {'A', 8} is the word PA8."""
    text = LITERAL.sub(r"P\1\2", text)
    stack: list[list] = [[]]
    for word in re.findall(r"[{}]|[^{},\s]+(?:\([^)]*\))?", text):
        if word == "{":
            stack.append([])
        elif word == "}":
            done = stack.pop()
            stack[-1].append(done)
        else:
            stack[-1].append(word.removeprefix("stm32h7::"))
    return stack[0]


def constants(text: str) -> list[tuple[str, str, list]]:
    """Type, name and initialiser of each constant of a header."""
    found = []
    text = re.sub(r"//.*", "", text)
    for kind, declared in re.findall(r"inline constexpr\s+([\w:]+)\s+([^;]+);", text):
        words = re.split(r",\s*(?=k\w+(?:\[\])?\s*[{=])", declared)
        for each in words:
            name = re.match(r"\w+", each)[0]
            found.append((kind.removeprefix("stm32h7::"), name, parsed(each[len(name):].replace("[]", "").replace("=", " "))))
    return found


# ---- what it has to be


class Facts:
    """The table of one revision."""

    def __init__(self, board: Board, text: str | None = None):
        lines = (text or (BOARDS / board.table).read_text()).splitlines()
        rows = [row for row in csv.DictReader(line for line in lines if not line.startswith("#")) if row[board.column]]
        self.pins = [row[board.column] for row in rows]
        self.by_signal = {(row["peripheral"], row["signal"]): row for row in rows if row["peripheral"] != "GPIO"}
        self.by_function = {row["function"]: row for row in rows}
        self.column = board.column

    def pin(self, row: dict) -> str:
        return row[self.column].removesuffix("_C")


class Check:
    """Goes through the constants of the headers and collects what differs from the table."""

    def __init__(self, board: Board, facts: Facts):
        self.board, self.facts = board, facts
        self.complaints: list[str] = []
        self.seen = 0  # pins compared

    def expect(self, what: str, found: str, wanted: str):
        if found != wanted:
            self.complaints.append(f"{what}: found {found}, the table has {wanted}")

    def signal(self, name: str, peripheral: str, signal: str, pin: str, function: str | None):
        row = self.facts.by_signal.get((peripheral, signal))
        self.seen += 1
        if row is None:
            self.complaints.append(f"{name}: the table has no {peripheral} {signal}")
            return
        self.expect(f"{name}, {peripheral} {signal}", pin, self.facts.pin(row))
        if function is not None:
            self.expect(f"{name}, {peripheral} {signal}, alternate function", function, row["alternate_function"])

    def gpio(self, name: str, pins: list[str]):
        functions = self.board.gpio.get(name, [])
        if len(functions) != len(pins):
            self.complaints.append(f"{name}: found {len(pins)} pins, this test knows {len(functions)}")
        for pin, function in zip(pins, functions):
            self.seen += 1
            self.expect(f"{name}, {function}", pin, self.facts.pin(self.facts.by_function[function]))

    def request(self, name: str, request: str, peripheral: str, signal: str):
        self.expect(f"{name}, DMA request", request, f"request::{peripheral}_{signal}")

    def spi(self, name: str, bus: list):
        peripheral, clock, data_in, data_out, function, _, _, request, *own = bus
        self.signal(name, peripheral, "SCK", clock, function)
        self.signal(name, peripheral, "MISO", data_in, function)
        self.signal(name, peripheral, "MOSI", data_out, own[0] if own else function)
        self.request(name, request, peripheral, "RX")

    def uart(self, name: str, uart: list):
        peripheral, irq, receive, transmit, function, _, _, request = uart
        self.signal(name, peripheral, "RX", receive, function)
        self.signal(name, peripheral, "TX", transmit, function)
        self.expect(f"{name}, interrupt", irq, f"irq::{peripheral}")
        self.request(name, request, peripheral, "RX")

    def outputs(self, name: str, channels: list):
        for k, (timer, channel, advanced, pin, function) in enumerate(channels):
            self.signal(f"{name}[{k}]", timer, f"CH{int(channel) + 1}", pin, function)
            self.expect(f"{name}[{k}]", f"{timer} CH{int(channel) + 1}",
                        "{peripheral} {signal}".format(**self.facts.by_function[f"output {k + 1}"]))
            self.expect(f"{name}[{k}], advanced timer", advanced, "true" if timer in ("TIM1", "TIM8") else "false")

    def plan(self, name: str, plan: list, pins: dict[str, str]):
        (_, minus, plus), _, _, pulse, pulse_irq, ready, ready_irq, _, _, _, battery, _, _ = plan
        self.signal(name, "USB_OTG_FS", "DM", minus, None)
        self.signal(name, "USB_OTG_FS", "DP", plus, None)
        for constant, irq in ((pulse, pulse_irq), (ready, ready_irq)):
            line = int(pins[constant][2:])
            group = f"EXTI{line}" if line < 5 else "EXTI9_5" if line < 10 else "EXTI15_10"
            self.expect(f"{name}, interrupt of {constant}", irq, f"irq::{group}")
        for channel, function in zip(battery, ("battery voltage", "battery current")):
            self.expect(f"{name}, {function}", f"INP{channel}", self.facts.by_function[function]["signal"])

    # Pins with a square wave: timer and channel.
    WAVES = {"kSyncClock": ("TIM12", "CH1"), "kBuzzer": ("TIM2", "CH1")}

    def run(self, text: str):
        found = constants(text)
        pins = {name: value[0] for kind, name, value in found if kind == "Pin" and not isinstance(value[0], list)}
        numbers = {name: value for _, name, value in found}
        for kind, name, value in found:
            inner = value[0] if value and isinstance(value[0], list) else value
            if name in self.WAVES:
                self.signal(name, *self.WAVES[name], inner[0], numbers[f"{name}Function"][0])
            elif kind == "Pin":
                self.gpio(name, inner)
            elif kind == "SpiBus::Pins":
                for bus in inner if isinstance(inner[0], list) else [inner]:
                    self.spi(name, bus)
            elif kind == "SpiBus::Device":
                self.gpio(name, [device[0] for device in inner])
            elif kind == "I2cBus::Pins":
                peripheral, event, error, clock, data, function = inner
                self.signal(name, peripheral, "SCL", clock, function)
                self.signal(name, peripheral, "SDA", data, function)
                self.expect(f"{name}, interrupts", f"{event} {error}", f"irq::{peripheral}_EV irq::{peripheral}_ER")
            elif kind == "Uart::Pins":
                self.uart(name, inner)
            elif kind == "Pulses::Channel":
                self.outputs(name, inner)
            elif kind == "FlightBoard::Plan":
                self.plan(name, inner, pins)
        literals = len(LITERAL.findall(re.sub(r"//.*", "", text)))
        if self.seen != literals:
            self.complaints.append(f"found {literals} pins in the headers, compared {self.seen}")


def texts(board: Board) -> dict[str, str]:
    return {name: (BOARDS / name).read_text() for name in board.headers}


def differences(board: Board, headers: dict[str, str] | None = None) -> list[str]:
    check = Check(board, Facts(board))
    check.run("\n".join((headers or texts(board)).values()))
    return check.complaints


@pytest.mark.parametrize("name", ALL)
def test_every_pin_of_the_headers_is_that_of_the_table(name):
    assert differences(ALL[name]) == []


@pytest.mark.parametrize("name", ALL)
def test_no_pin_of_a_table_has_two_functions(name):
    pins = Facts(ALL[name]).pins
    assert sorted(pin for pin in set(pins) if pins.count(pin) > 1) == []
    assert all(re.fullmatch(r"P[A-K](\d|1[0-5])(_C)?", pin) for pin in pins)


@pytest.mark.parametrize("name", ALL)
def test_a_change_of_any_pin_is_found(name):
    for header, text in texts(ALL[name]).items():
        for literal in LITERAL.finditer(text):
            other = f"{{'{literal[1]}', {(int(literal[2]) + 1) % 16}}}"
            changed = text[:literal.start()] + other + text[literal.end():]
            assert differences(ALL[name], {**texts(ALL[name]), header: changed}), f"{header}: {literal[0]} for {other}"


@pytest.mark.parametrize("name, header, line, becomes, said", [
    ("varmint", HEADER, "{'E', 6}, 5, 5, 6", "{'E', 6}, 6, 5, 6", "alternate function: found 6, the table has 5"),
    ("varmint_10x", "varmint/revision_10x.hpp", "SPI3_RX, 7}", "SPI3_RX, 6}", "SPI3 MOSI, alternate function: found 6"),
    ("varmint_10x", "varmint/revision_10x.hpp", "request::SPI3_RX", "request::SPI2_RX", "DMA request"),
    ("varmint", HEADER, "{stm32h7::TIM1, 1, true", "{stm32h7::TIM1, 2, true", "TIM1 CH3"),
    ("varmint", HEADER, "false, {'C', 6}, 2}", "false, {'C', 6}, 1}", "alternate function: found 1"),
    ("pixracer_pro", PIXRACER_HEADER, "kBuzzerFunction = 1", "kBuzzerFunction = 2", "TIM2 CH1, alternate function"),
    ("varmint", HEADER, "kSyncClockFunction = 2", "kSyncClockFunction = 1", "TIM12 CH1, alternate function"),
    ("varmint", HEADER, "{16, 11}", "{16, 12}", "battery current: found INP12"),
    ("varmint", HEADER, "irq::EXTI9_5", "irq::EXTI3", "interrupt of kImuReady"),
    ("pixracer_pro", PIXRACER_HEADER, "{stm32h7::TIM8, 0, true", "{stm32h7::TIM8, 0, false", "advanced timer"),
    ("pixracer_pro", PIXRACER_HEADER, "irq::UART4,", "irq::USART2,", "kGnss, interrupt"),
])
def test_a_change_of_anything_else_is_named(name, header, line, becomes, said):
    before = texts(ALL[name])
    assert line in before[header]
    told = differences(ALL[name], {**before, header: before[header].replace(line, becomes, 1)})
    assert any(said in each for each in told), told


def test_a_pin_that_no_table_has_is_found():
    before = texts(ALL["varmint"])
    more = before[HEADER] + "\ninline constexpr Pin kMystery{'E', 10};\n"
    assert "kMystery: found 1 pins, this test knows 0" in differences(ALL["varmint"], {**before, HEADER: more})

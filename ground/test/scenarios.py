# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the ground tools start: each scenario has a firmware of its own and returns what the commands said.

They run beside each other, because they mostly wait.
"""

import concurrent.futures
import json
import os
import pty
import re
import select
import shlex
import signal
import socket
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parents[2] / "flight" / "sil" / "test"))
from ground_tool import PROGRAM, ROOT, TIMEOUT_S, Sil  # noqa: E402
from peer import HandTurned, OldFirmware  # noqa: E402
from piloted import PARAMETERS, write_parameters  # noqa: E402

ARM = "at_s: 1.2, switch: arm, on: true"
STICKS = ("roll", "pitch", "yaw", "throttle")


LONGER = ("--timeout", "20")  # ten firmwares share the machine


@dataclass
class Done:
    """What a command ended with."""
    code: int
    out: str
    err: str

    @property
    def lines(self):
        return self.out.splitlines()


def tool(*words, cwd=None):
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, timeout=3 * TIMEOUT_S, cwd=cwd)
    return Done(done.returncode, done.stdout, done.stderr)


class Vehicle(Sil):
    """A firmware on TCP, optionally with a pilot's script and parameters in its memory."""

    def __init__(self, folder, *options, events=(), parameters=None, link="tcp:0"):
        folder.mkdir(parents=True, exist_ok=True)
        self.folder = folder
        if parameters:
            write_parameters(folder, parameters)
        words = list(options)
        if events:
            script = folder / "pilot.yaml"
            script.write_text("start: {attitude_mode: 1}\nevents:\n" + "".join(f"  - {{{event}}}\n" for event in events))
            words += ["--rc", script]
        super().__init__(folder, "--link", link, *words)
        self.link = self.words["link"]

    def run(self, command, *words):
        longer = LONGER if command == "params" else ()
        return tool(command, self.link, *longer, *words, cwd=self.folder)


# ---- scenarios, each with a vehicle of its own -----------------------------------------------------


def listing(folder):
    with Vehicle(folder, link="pty", parameters={"RC_TYPE": 1}) as v:
        return {"json": v.run("params", "list", "--json"), "text": v.run("params", "list", "--changed"), "link": v.link}


def storing(folder):
    """Set, set and store, restart."""
    said = {}
    with Vehicle(folder) as v:
        said["set"] = v.run("params", "set", "RC_TYPE", "1", "X_EQ_TORQUE", "-0.125", "--write")
        said["not stored"] = v.run("params", "set", "FAILSAFE_THR", ".25")
        said["get"] = v.run("params", "get", "--json", "RC_TYPE", "X_EQ_TORQUE", "FAILSAFE_THR")
    with Vehicle(folder) as v:
        said["restarted"] = v.run("params", "get", "--json", "RC_TYPE", "X_EQ_TORQUE", "FAILSAFE_THR")
    return said


def files(folder):
    """Save, compare, change, compare, load, compare."""
    said = {}
    with Vehicle(folder) as v:
        said["save"] = v.run("params", "save", "all.yaml")
        said["again"] = v.run("params", "save", "all.yaml")
        said["same"] = v.run("params", "diff", "all.yaml", "--json")
        text = (folder / "all.yaml").read_text()
        said["text"] = text
        (folder / "some.yaml").write_text("- {name: RC_TYPE, type: 6, value: 1}\n- {name: NUM_MOTORS, type: 6, value: 4}\n")
        said["differs"] = v.run("params", "diff", "some.yaml", "--json")
        said["load"] = v.run("params", "load", "some.yaml", "--write")
        said["loaded"] = v.run("params", "diff", "some.yaml")
        (folder / "other.yaml").write_text("- {name: RC_TYPE, type: 6, value: 0}\n- {name: OF_ANOTHER, type: 6, value: 4}\n")
        said["unknown"] = v.run("params", "load", "other.yaml", "--write")
    return said


def bad_input(folder):
    said = {}
    with Vehicle(folder) as v:
        for name, words in {"range": ["set", "RC_TYPE", "0", "RC_ARM_THRESHOLD", "0.3"], "odd": ["set", "RC_TYPE"],
                            "no number": ["set", "RC_TYPE", "on"], "no integer": ["set", "RC_TYPE", "0.5"],
                            "unknown": ["set", "RC_TYPE", "1", "NO_SUCH", "1"], "unknown get": ["get", "NO_SUCH"],
                            "no file": ["load", "none.yaml"], "no action": []}.items():
            said[name] = v.run("params", *words)
        for name, text in {"file range": "- {name: NUM_MOTORS, type: 6, value: 4}\n- {name: RC_TYPE, type: 6, value: 3}\n",
                           "file key": "- {name: NUM_MOTORS, type: 6, valeu: 4}\n"}.items():
            (folder / "bad.yaml").write_text(text)
            said[name] = v.run("params", "load", "bad.yaml")
        said["what"] = v.run("calibrate", "yaw")
        said["period"] = v.run("monitor", "--period", "0")
        said["untouched"] = v.run("params", "get", "--json", "RC_TYPE")
    return said


def armed(folder):
    """Everything that a vehicle in flight refuses."""
    said = {}
    with Vehicle(folder, events=[ARM], parameters=PARAMETERS) as v:
        deadline = time.monotonic() + TIMEOUT_S
        while time.monotonic() < deadline:
            if json.loads(v.run("monitor", "--once", "--json").out)["state"]["armed"]:
                break
        said["set"] = v.run("params", "set", "RC_TYPE", "1")
        said["write"] = v.run("params", "set", "PID_ROLL_ANG_P", "1.1", "--write")
        for what in ("gyro", "accel", "baro", "airspeed", "mag", "rc"):
            said[what] = v.run("calibrate", what)
        said["esc"] = v.run("calibrate", "esc", "--props-off")
        said["preflight"] = v.run("preflight")
    return said


def calibrated(what):
    def scenario(folder):
        with Vehicle(folder) as v:
            return {"first": v.run("calibrate", what, "--write")}
    return scenario


def refused(what, *options):
    def scenario(folder):
        with Vehicle(folder, *options) as v:
            done = v.run("calibrate", what, "--wait", "1.5")
            return {"calibrate": done, "params": v.run("params", "list", "--changed")}
    return scenario


def transmitter(folder):
    """A person who moves the sticks as told; a trim is left on the roll stick."""
    events = []
    for k, at_s in enumerate((3.0, 4.0, 5.0)):
        events += [f"at_s: {at_s + 0.5 * end}, set: {stick}, to: {float((end + k) % 2)}" for stick in STICKS for end in (0, 1)]
    events += [f"at_s: 6.0, set: {stick}, to: 0.5" for stick in ("pitch", "yaw")]
    events += ["at_s: 6.0, set: roll, to: 0.53", "at_s: 6.0, set: throttle, to: 0.0"]
    with Vehicle(folder, events=events, parameters=PARAMETERS) as v:
        return {"calibrate": v.run("calibrate", "rc", "--wait", "15")}


def off_centre(folder):
    events = [f"at_s: {2.0 + 0.5 * end}, set: {stick}, to: {float(end)}" for stick in STICKS for end in (0, 1)]
    events += [f"at_s: 3.5, set: {stick}, to: 0.5" for stick in ("pitch", "yaw")]
    events += ["at_s: 3.5, set: roll, to: 0.65", "at_s: 3.5, set: throttle, to: 0.0"]
    with Vehicle(folder, events=events) as v:
        return {"calibrate": v.run("calibrate", "rc", "--wait", "4")}


def speed_controllers(folder):
    events = ["at_s: 9.0, switch: arm, on: true", "at_s: 10.5, set: throttle, to: 1.0", "at_s: 12.0, set: throttle, to: 0.0",
              "at_s: 13.5, switch: arm, on: false"]
    with Vehicle(folder, events=events, parameters=PARAMETERS) as v:
        done = v.run("calibrate", "esc", "--props-off", "--wait", "20")
    with Vehicle(folder) as v:
        return {"calibrate": done, "restarted": v.run("params", "list", "--json")}


def stopped_speed_controllers(folder):
    with Vehicle(folder, parameters=PARAMETERS) as v:
        said = {"no flag": v.run("calibrate", "esc"), "before": v.run("params", "list", "--json")}
        with subprocess.Popen([PROGRAM, "calibrate", v.link, "esc", "--props-off"], stdout=subprocess.PIPE, text=True) as process:
            process.stdout.readline()  # the first instruction
            process.send_signal(signal.SIGINT)
            out, _ = process.communicate(timeout=TIMEOUT_S)
        said["stopped"] = Done(process.returncode, out, "")
        said["mixer"] = v.run("params", "get", "--json", "PRIMARY_MIXER")
    return said


def stopped_mag(folder):
    with Vehicle(folder, parameters={"MAG_X_BIAS": 1e-5}) as v:
        with subprocess.Popen([PROGRAM, "calibrate", v.link, "mag"], stdout=subprocess.PIPE, text=True) as process:
            process.stdout.readline()
            process.send_signal(signal.SIGINT)
            out, _ = process.communicate(timeout=TIMEOUT_S)
        return {"stopped": Done(process.returncode, out, ""), "bias": v.run("params", "get", "--json", "MAG_X_BIAS")}


def watching(folder):
    """One screen, lines, Ctrl-C, a terminal, and a vehicle that goes away."""
    said = {}
    with Vehicle(folder) as v:
        said["screen"] = v.run("monitor", "--once")
        said["json"] = v.run("monitor", "--once", "--json")
        with subprocess.Popen([PROGRAM, "monitor", v.link, "--period", "0.1"], stdout=subprocess.PIPE, text=True) as process:
            lines = [process.stdout.readline() for _ in range(3)]
            process.send_signal(signal.SIGINT)
            rest, _ = process.communicate(timeout=TIMEOUT_S)
        said["lines"] = Done(process.returncode, "".join(lines) + rest, "")
        said["terminal"] = on_terminal(v.link)
        with subprocess.Popen([PROGRAM, "monitor", v.link, "--json", "--period", "0.2"], stdout=subprocess.PIPE,
                              text=True) as process:
            process.stdout.readline()
            v.end()
            deadline = time.monotonic() + TIMEOUT_S
            connected = True
            while connected and time.monotonic() < deadline:
                connected = json.loads(process.stdout.readline())["connected"]
            process.send_signal(signal.SIGTERM)
            process.communicate(timeout=TIMEOUT_S)
        said["lost"] = (connected, process.returncode)
    return said


def on_terminal(link):
    master, slave = pty.openpty()
    process = subprocess.Popen([PROGRAM, "monitor", link, "--period", "0.1"], stdout=slave)
    os.close(slave)
    text = b""
    deadline = time.monotonic() + TIMEOUT_S
    while text.count(b"\x1b[H") < 3 and time.monotonic() < deadline:
        if select.select([master], [], [], 0.1)[0]:
            text += os.read(master, 65536)
    process.send_signal(signal.SIGINT)
    code = process.wait(timeout=TIMEOUT_S)
    os.close(master)
    return Done(code, text.decode(), "")


def checks(folder):
    with Vehicle(folder) as v:
        said = {"fails": v.run("preflight"), "json": v.run("preflight", "--json")}
    good = {**PARAMETERS, "GYRO_X_BIAS": 0.001}
    with Vehicle(folder / "good", parameters=good) as v:
        said["passes"] = v.run("preflight")
    return said


def other_links(folder):
    """The words that sil prints, on every kind of link and in both protocols."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    said = {}
    with Vehicle(folder / "udp", link=f"udp:127.0.0.1:{port}") as v:
        said["udp"] = v.run("params", "set", "RC_TYPE", "1")
        said["udp port"] = tool("params", f"udp:{port}", *LONGER, "get", "RC_TYPE")
    with Vehicle(folder / "lean", "--link-protocol", "lean", link="pty") as v:
        said["lean"] = tool("params", v.link.removeprefix("pty:"), *LONGER, "set", "RC_TYPE", "1")
        said["lean checks"] = v.run("preflight", *LONGER, "--json")
    return said


def old_firmware(_folder):
    fcu = OldFirmware({"heartbeat", "status"})
    said = {"preflight": tool("preflight", fcu.link, "--json", "--timeout", "2")}
    fcu.ended.set()
    fcu = OldFirmware({"heartbeat", "status"})
    said["params"] = tool("params", fcu.link, "list", "--timeout", "1")
    fcu.ended.set()
    return said


def turned_by_hand(_folder):
    fcu = HandTurned()
    done = tool("calibrate", fcu.link, "mag", "--write", "--wait", "20")
    fcu.ended.set()
    return {"calibrate": done, "values": dict(fcu.values), "stored": fcu.stored, "hard_iron_T": fcu.HARD_IRON_T}


def no_answer(folder):
    said = {}
    folder.mkdir()
    fcu = OldFirmware(set())  # bytes, but no heartbeat
    for name, words in {"closed": ["params", "tcp:127.0.0.1:9", "list"], "device": ["monitor", "/dev/no_such_device"],
                        "udp": ["preflight", "udp:127.0.0.1:9"], "silent": ["calibrate", fcu.link, "gyro"],
                        "wrong": ["params", "usb:3", "list"], "file": ["monitor", str(ROOT / "README.md")]}.items():
        said[name] = tool(*words, "--timeout", "0.5")
    fcu.ended.set()
    return said


def documented(folder):
    """Command lines of docs/ground-tools.md, each with a vehicle and the files it needs."""
    folder.mkdir()
    text = (ROOT / "docs" / "ground-tools.md").read_text()
    commands = re.findall(r"^    \./rosflight ((?:params|calibrate|monitor|preflight) .*?)(?: +#.*)?$", text, re.M)
    assert len(commands) > 10

    def run(numbered):
        number, command = numbered
        place = folder / str(number)
        with Vehicle(place) as v:
            if re.search(r" (diff|load) ", command):
                assert v.run("params", "save", "vehicle.yaml").code == 0
            words = [v.link if word == "tcp:127.0.0.1:5760" else word for word in shlex.split(command)]
            assert v.link in words, command
            words = ["2" if word == "120" else word for word in words]
            process = subprocess.Popen([PROGRAM, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=place)
            first = ""
            if words[0] == "monitor" and "--once" not in words:
                first = process.stdout.readline()
                process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=3 * TIMEOUT_S)
            return command, Done(process.returncode, first + out, err)

    with concurrent.futures.ThreadPoolExecutor(16) as pool:
        return dict(pool.map(run, enumerate(commands)))


NOISY = "vehicle.sensors.imu.gyro_rad_s.noise_sigma=0.2"
SCENARIOS = {
    "speed controllers": speed_controllers, "stopped speed controllers": stopped_speed_controllers, "transmitter": transmitter,
    "armed": armed, "files": files, "listing": listing, "storing": storing, "bad input": bad_input, "documented": documented,
    "gyro": calibrated("gyro"), "accel": calibrated("accel"), "baro": calibrated("baro"), "airspeed": calibrated("airspeed"),
    "shaken gyro": refused("gyro", "--set", NOISY), "turning gyro": refused("gyro", "--fault", "gyro_step_x=0.5@0.2"),
    "tilted accel": refused("accel", "--fault", "accel_step_x=2@0.2"),
    "noisy baro": refused("baro", "--set", "vehicle.sensors.baro.pressure_Pa.noise_sigma=30"),
    "noisy airspeed": refused("airspeed", "--set", "vehicle.sensors.diff_pressure.pressure_Pa.noise_sigma=30"),
    "no baro": refused("baro", "--set", "vehicle.sensors.baro.enabled=false"),
    "turned by hand": turned_by_hand, "resting mag": refused("mag"), "resting sticks": refused("rc"), "stopped mag": stopped_mag, "off centre": off_centre,
    "watching": watching, "checks": checks, "other links": other_links, "old firmware": old_firmware, "no answer": no_answer,
}


AT_ONCE = 10  # firmware at real time each: more of them leave a busy machine no room for a heartbeat within 5 s


def run_all(folder):
    """A future of each scenario, all ended. An exception fails the tests that need it, alone."""
    with concurrent.futures.ThreadPoolExecutor(AT_ONCE) as pool:
        running = {name: pool.submit(scenario, folder / name.replace(" ", "_")) for name, scenario in SCENARIOS.items()}
        concurrent.futures.wait(running.values())
        return running

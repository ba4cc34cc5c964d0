# SPDX-License-Identifier: BSD-3-Clause
"""The firmware as a process, with pymavlink, which nobody here wrote, as its ground tool."""

import csv
import os
import random
import signal
import struct
import subprocess
import sys
import time
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from ground_tool import (DIALECT, INT32, TIMEOUT_S, PROGRAM, REAL32, ROOT, Connected, Ground, Port,  # noqa: E402
                         Sil, decoded, udp_socket)

DEFAULTS = ROOT / "firmware" / "core" / "test" / "data" / "reference_parameters.csv"


@pytest.fixture(params=["pty", "udp", "tcp"])
def ground(request, tmp_path):
    with Connected(request.param, tmp_path) as tool:
        yield tool


@pytest.fixture
def pty_ground(tmp_path):
    with Connected("pty", tmp_path) as tool:
        yield tool


def reference_parameters():
    with DEFAULTS.open() as file:
        return list(csv.DictReader(file))


# ---- what a ground tool does first --------------------------------------------------------------


def test_heartbeat_and_version(ground):
    beats = [ground.expect("HEARTBEAT") for _ in range(2)]
    assert all(beat.get_srcSystem() == 1 and beat.get_srcComponent() == 250 for beat in beats)
    ground.mav.rosflight_cmd_send(DIALECT.ROSFLIGHT_CMD_SEND_VERSION)
    assert ground.expect("ROSFLIGHT_VERSION").version


def test_all_parameters_have_the_names_types_and_defaults_of_the_reference_and_ours_follow(ground):
    with (ROOT / "firmware" / "core" / "parameters.csv").open() as file:
        table = list(csv.DictReader(file))
    reference = reference_parameters()
    assert len(reference) == 333 < len(table)
    assert [row["name"] for row in table[:333]] == [row["name"] for row in reference]
    reference += table[333:]
    ground.mav.param_request_list_send(1, 1)
    got = {}
    while len(got) < len(reference):
        message = ground.expect("PARAM_VALUE")
        assert message is not None, f"{len(got)} of {len(reference)}"
        assert message.param_count == len(reference)
        got[message.param_index] = message
    for index, row in enumerate(reference):
        message = got[index]
        assert message.param_id == row["name"]
        assert message.param_type == (INT32 if row["type"] == "int32" else REAL32), row["name"]
        wanted = int(row["default"]) if row["type"] == "int32" else struct.unpack(
            "<f", struct.pack("<f", float(row["default"])))[0]
        assert decoded(message) == wanted, row["name"]


def test_a_tool_that_knows_only_the_protocol_loads_all_parameters_and_sets_one_of_ours(pty_ground):
    """As official tools do: a table of the size that the first value reports, filled by index, gaps asked for."""
    pty_ground.mav.param_request_list_send(1, 1)
    first = pty_ground.expect("PARAM_VALUE")
    table = [None] * first.param_count
    message = first
    for _ in range(2 * first.param_count):
        assert message.param_count == len(table) and message.param_index < len(table)
        table[message.param_index] = message.param_id
        if all(table):
            break
        message = pty_ground.expect("PARAM_VALUE")
    assert all(table) and len(set(table)) == len(table) > 333
    index = table.index("CHECK_LEVEL")
    assert index >= 333
    pty_ground.set("CHECK_LEVEL", 1)
    answer = pty_ground.expect("PARAM_VALUE", lambda m: m.param_id == "CHECK_LEVEL")
    assert decoded(answer) == 1 and answer.param_index == index and answer.param_count == len(table)
    pty_ground.mav.param_request_read_send(1, 1, b"", index)
    assert decoded(pty_ground.expect("PARAM_VALUE", lambda m: m.param_index == index)) == 1


def test_sensors_stream_in_real_time(pty_ground):
    first = pty_ground.expect("SMALL_IMU")
    last = first
    count = 0
    while last.time_boot_us - first.time_boot_us < 1_000_000:
        last = pty_ground.expect("SMALL_IMU")
        count += 1
    assert count == 400  # stamps are those of the ticks, whatever the machine does
    assert last.zacc == pytest.approx(-9.8, abs=0.5)


# ---- parameters -----------------------------------------------------------------------------------


def test_set_answers_with_the_new_value(ground):
    ground.set("NUM_MOTORS", 6)
    assert decoded(ground.expect("PARAM_VALUE", lambda m: m.param_id == "NUM_MOTORS")) == 6
    ground.set("RC_MAX_THR", 0.5, REAL32)
    assert decoded(ground.expect("PARAM_VALUE", lambda m: m.param_id == "RC_MAX_THR")) == 0.5


@pytest.mark.parametrize("name, value, kind, kept", [
    ("NUM_MOTORS", 1000, INT32, 4), ("NUM_MOTORS", -1, INT32, 4),
    ("RC_MAX_THR", float("nan"), REAL32, None), ("RC_MAX_THR", 1e30, REAL32, None),
    ("NUM_MOTORS", 2.0, REAL32, 4)])
def test_a_value_that_is_not_allowed_is_answered_with_the_one_kept(pty_ground, name, value, kind, kept):
    before = pty_ground.value(name)
    assert kept is None or before == kept
    pty_ground.set(name, value, kind)
    answer = pty_ground.expect("PARAM_VALUE", lambda m: m.param_id == name)
    assert decoded(answer) == before
    assert pty_ground.value(name) == before


def test_written_parameters_survive_the_process(tmp_path):
    with Connected("tcp", tmp_path) as ground:
        ground.set("NUM_MOTORS", 6)
        assert ground.command(DIALECT.ROSFLIGHT_CMD_WRITE_PARAMS)
        ground.set("NUM_MOTORS", 8)  # not written
        assert ground.value("NUM_MOTORS") == 8
    with Connected("udp", tmp_path) as ground:
        assert ground.value("NUM_MOTORS") == 6


def test_a_killed_process_keeps_what_was_written(tmp_path):
    with Connected("tcp", tmp_path) as ground:
        ground.set("NUM_MOTORS", 6)
        assert ground.command(DIALECT.ROSFLIGHT_CMD_WRITE_PARAMS)
        assert ground.sil.end(signal.SIGKILL) == -signal.SIGKILL
    with Connected("tcp", tmp_path) as ground:
        assert ground.value("NUM_MOTORS") == 6


def test_a_reboot_starts_the_firmware_again_with_what_was_written(ground):
    ground.set("NUM_MOTORS", 6)
    assert ground.command(DIALECT.ROSFLIGHT_CMD_WRITE_PARAMS)
    ground.set("NUM_MOTORS", 8)
    assert ground.value("NUM_MOTORS") == 8
    before = ground.expect("SMALL_IMU").time_boot_us
    assert ground.command(DIALECT.ROSFLIGHT_CMD_REBOOT)
    assert ground.expect("SMALL_IMU", lambda m: m.time_boot_us < before)
    assert ground.value("NUM_MOTORS") == 6


def test_a_memory_cut_off_half_way_still_starts(tmp_path):
    with Connected("tcp", tmp_path) as ground:
        ground.set("NUM_MOTORS", 6)
        assert ground.command(DIALECT.ROSFLIGHT_CMD_WRITE_PARAMS)
    os.truncate(tmp_path / "memory", 100)
    with Connected("tcp", tmp_path) as ground:
        assert ground.value("NUM_MOTORS") == 4


# ---- hostile links --------------------------------------------------------------------------------


def test_a_request_to_another_system_is_not_answered(pty_ground):
    pty_ground.set("NUM_MOTORS", 6, system=7)
    pty_ground.mav.param_request_list_send(7, 1)
    pty_ground.mav.param_request_read_send(7, 1, b"NUM_MOTORS", -1)
    pty_ground.mav.param_request_read_send(1, 1, b"RC_TYPE", -1)  # answered after all of these
    answer = pty_ground.expect("PARAM_VALUE")
    assert answer.param_id == "RC_TYPE"
    assert pty_ground.value("NUM_MOTORS") == 4


def frames_of_a_ground_tool():
    mav = DIALECT.MAVLink(None, srcSystem=255, srcComponent=190)
    messages = [DIALECT.MAVLink_heartbeat_message(6, 0, 0, 0, 0, 2),
                DIALECT.MAVLink_timesync_message(0, 77),
                DIALECT.MAVLink_param_request_read_message(1, 1, b"NUM_MOTORS", -1)]
    return [bytes(message.pack(mav, force_mavlink1=True)) for message in messages]


def test_truncated_and_corrupted_frames_are_survived(ground):
    rng = random.Random(1)
    for _ in range(500):
        frame = bytearray(rng.choice(frames_of_a_ground_tool()))
        if rng.random() < 0.5:
            del frame[rng.randrange(len(frame)):]
        else:
            frame[rng.randrange(len(frame))] ^= 1 << rng.randrange(8)
        ground.write(bytes(frame))
    ground.write(rng.randbytes(20_000))
    ground.write(b"\xfe" * 1000)
    ground.waiting.clear()
    ground.write(b"\x00" * 300)  # ends what the start bytes promised
    assert ground.value("NUM_MOTORS") == 4
    assert ground.expect("HEARTBEAT")
    assert ground.sil.process.poll() is None


def test_a_storm_of_parameter_requests_does_not_stop_the_loop(ground):
    read = frames_of_a_ground_tool()[2]
    ground.mav.heartbeat_send(6, 0, 0, 0, 0, 2)
    first = ground.expect("SMALL_IMU").time_boot_us
    for k in range(300):
        ground.write(read * 30)
        if k % 10 == 0:
            ground.mav.param_request_list_send(1, 1)
        ground.receive(0.0)
    # The control loop went on, and afterwards everything is as ever.
    last = ground.expect("SMALL_IMU", lambda m: m.time_boot_us > first + 500_000)
    assert last is not None
    assert ground.value("NUM_MOTORS") == 4


def test_a_ground_tool_that_never_reads_does_not_stop_the_loop(pty_ground):
    pty_ground.mav.param_request_list_send(1, 1)
    time.sleep(1.0)
    assert pty_ground.value("NUM_MOTORS") == 4
    now = pty_ground.expect("SMALL_IMU", lambda m: m.time_boot_us > 1_000_000)
    assert now is not None


def test_ground_tools_come_and_go(tmp_path):
    with Sil(tmp_path, "--link", f"pty:{tmp_path / 'fcu'}") as sil:
        assert Path(sil.words["symlink"]).resolve() == Path(sil.words["link"][len("pty:"):])
        for _ in range(3):
            ground = Ground(Port(sil))
            assert ground.value("NUM_MOTORS") == 4
            ground.port.close()
    assert not os.path.lexists(tmp_path / "fcu")


def test_tcp_clients_come_and_go(tmp_path):
    with Sil(tmp_path, "--link", "tcp:0") as sil:
        for _ in range(3):
            ground = Ground(Port(sil))
            assert ground.value("NUM_MOTORS") == 4
            ground.port.close()


# ---- starting and ending --------------------------------------------------------------------------


def failed_start(folder, *options):
    done = subprocess.run([str(PROGRAM), "sil", *map(str, options)], capture_output=True, text=True,
                          timeout=TIMEOUT_S, cwd=folder)
    assert done.returncode == 2, done
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1, done.stderr
    return done.stderr


def test_a_taken_udp_port_is_one_line_and_exit_2(tmp_path):
    with udp_socket() as taken:
        port = taken.getsockname()[1]
        error = failed_start(tmp_path, "--link", "udp:127.0.0.1:9", "--listen", port)
    assert f"127.0.0.1:{port}" in error and "Address already in use" in error
    assert list(tmp_path.iterdir()) == []


def test_a_taken_tcp_port_is_one_line_and_exit_2(tmp_path):
    with Sil(tmp_path, "--link", "tcp:0") as sil:
        port = sil.words["link"].rsplit(":", 1)[1]
        error = failed_start(tmp_path, "--link", f"tcp:{port}", "--nvm", "other")
    assert f"127.0.0.1:{port}" in error and "Address already in use" in error
    assert not (tmp_path / "other").exists()


def test_a_memory_in_use_is_one_line_and_exit_2(tmp_path):
    with Sil(tmp_path, "--link", "tcp:0"):
        error = failed_start(tmp_path, "--link", "tcp:0", "--nvm", "memory")
    assert "memory: found it in use by another process" in error


@pytest.mark.parametrize("options, text", [
    (["--link", "serial"], "link 'serial': found 'serial', allowed pty, pty:PATH, udp:HOST:PORT"),
    (["--link", "udp:127.0.0.1:0"], "found port '0'"),
    (["--link", "pty", "--listen", "14525"], "--listen"),
    (["--nvm", "nowhere/memory"], "nowhere/memory: found 'No such file or directory'"),
    (["--vehicle", "none"], "vehicle: found none"),
    (["--set", "vehicle.body.mas_kg=3"], "body.mas_kg"),
    (["--rate", "7"], "--rate"),
    (["--link-protocol", "morse"], "--link-protocol: found morse, allowed mavlink, lean"),
    (["--rc", "nowhere.yaml"], "nowhere.yaml"),
    (["--fault", "imu"], "imu"),
    (["--duration", "-1"], "--duration"),
])
def test_bad_options_are_one_line_and_exit_2(tmp_path, options, text):
    assert text in failed_start(tmp_path, *options)
    assert not list(tmp_path.glob("*.nvm"))


def test_each_vehicle_has_a_memory_of_its_own(tmp_path):
    for vehicle in ("multirotor", "anaconda"):
        subprocess.run([PROGRAM, "sil", "--link", "tcp:0", "--vehicle", vehicle, "--duration", "0.1"], check=True, cwd=tmp_path,
                       capture_output=True, timeout=60)
    assert {path.name for path in tmp_path.glob("*.nvm")} == {"rosflight_multirotor.nvm", "rosflight_anaconda.nvm"}


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_signals_end_it_with_0(tmp_path, how):
    sil = Sil(tmp_path, "--link", "pty")
    assert sil.end(how) == 0


def test_duration_ends_it_with_0(tmp_path):
    sil = Sil(tmp_path, "--link", "pty", "--duration", "0.5")
    assert sil.process.wait(timeout=TIMEOUT_S) == 0


def test_udp_uses_the_ports_of_the_reference_simulator_by_default(tmp_path):
    try:
        with Sil(tmp_path, "--link", "udp:127.0.0.1:14520") as sil:
            assert sil.words["link"] == "udp:127.0.0.1:14520"
            assert sil.words["listen"] == "127.0.0.1:14525"
    except AssertionError as error:
        if "127.0.0.1:14525: found 'Address already in use'" not in str(error):
            raise
        pytest.skip("another program has port 14525")


# ---- the vehicle around it ------------------------------------------------------------------------


def test_a_script_moves_the_pilots_sticks(tmp_path):
    script = tmp_path / "rc.yaml"
    script.write_text("events:\n  - {at_s: 0.5, set: throttle, to: 0.25}\n")
    with Connected("pty", tmp_path, "--rc", script) as ground:
        assert ground.expect("RC_CHANNELS", lambda m: m.chan3_raw == 1000)
        assert ground.expect("RC_CHANNELS", lambda m: m.chan3_raw == 1250)


def test_faults_break_things_at_their_time(tmp_path):
    with Connected("tcp", tmp_path, "--fault", "baro@0", "--fault", "link_cut@0.5:0.5") as ground:
        stamps = []
        while not stamps or stamps[-1] < 1_500_000:
            ground.receive()
            for message in ground.waiting:
                assert message.get_type() != "SMALL_BARO"
                if message.get_type() == "SMALL_IMU":
                    stamps.append(message.time_boot_us)
            ground.waiting.clear()
        gaps = [b - a for a, b in zip(stamps, stamps[1:])]
        assert 490_000 <= max(gaps) <= 600_000

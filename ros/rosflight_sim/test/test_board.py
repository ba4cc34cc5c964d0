# SPDX-License-Identifier: BSD-3-Clause
"""The board, the pilot and the manager of the board's steps, each by itself: the contract of sim_contract.py, memory, and steps by hand and
by simulated time."""

import contextlib
import socket
import time

from sim_contract import MODULES, check_headers, check_module
from geometry_msgs.msg import Vector3
from ros_rig import free_udp_port
from rosflight_msgs.msg import PwmOutput, RCRaw
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu
from sim_rig import ALL, ALL_BEST_EFFORT, BEST_EFFORT, SimPeer, node, stamp
from std_srvs.srv import Trigger

TICK_NS = 2_500_000
START_NS = 100_000_000_000
GRAVITY = 9.80665  # of vehicles/multirotor.yaml


def board(tmp_path, **more):
    return node("sil_board", at_launch="sil_board", memory_folder=tmp_path, simulation_port=free_udp_port(),
                ROS_port=free_udp_port(), **more)


def test_board(peer, tmp_path):
    with board(tmp_path):
        check_module(peer, "board")
        received = peer.listen(PwmOutput, "sim/pwm_output")
        peer.introduce(lambda: peer.call(Trigger, "sil_board/run"), received, "sil_board/run")
        for count in range(1, 11):
            assert peer.call(Trigger, "sil_board/run").success
            peer.wait(lambda c=count: len(received) == c, "pulses of this step")
        check_headers(received, MODULES["board"].outputs["sim/pwm_output"])
        assert all(list(message.values) == [1000] * 14 for message in received)  # disarmed
    assert (tmp_path / "mem.bin").stat().st_size > 1000


def test_a_sample_after_the_step_of_its_time_is_processed(peer, tmp_path):
    """Time may stand until the companion has it: no other step will come."""
    small_imu = 181
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as companion:
        companion.bind(("127.0.0.1", 0))
        companion.settimeout(0.05)

        def sent():
            """Numbers of the frames of ROSflight's MAVLink that have come, each packet a whole number of them."""
            numbers = []
            with contextlib.suppress(TimeoutError):
                while packet := companion.recv(2048):
                    while packet:
                        numbers.append(packet[5])
                        packet = packet[packet[1] + 8:]
            return numbers

        with node("sil_board", at_launch="sil_board", memory_folder=tmp_path, simulation_port=free_udp_port(), use_sim_time="true",
                  ROS_port=companion.getsockname()[1]):
            clock, imu = peer.publisher(Clock, "/clock", ALL_BEST_EFFORT), peer.publisher(Imu, "sim/sensors/imu/data", ALL)
            peer.poll(lambda: clock.get_subscription_count() and imu.get_subscription_count(), "subscribers")
            for tick in range(1, 6):
                message = Clock()
                message.clock.sec, message.clock.nanosec = divmod(START_NS + tick * TICK_NS, 1_000_000_000)
                for _ in range(10):  # best effort
                    clock.publish(message)
                    time.sleep(0.005)
                assert peer.call(Trigger, "sil_board/run").success
                sent()
                imu.publish(stamp(Imu(linear_acceleration=Vector3(z=-GRAVITY)), START_NS + tick * TICK_NS))
                peer.poll(lambda: small_imu in sent(), f"sample {tick} on the link")


def test_a_board_has_a_memory_for_each_namespace_and_vehicle(tmp_path):
    with board(tmp_path, namespace="/air/two"):
        assert (tmp_path / "air/two/mem.bin").exists()
    with board(tmp_path, vehicle_file="/any/anaconda.yaml") as process:
        assert (tmp_path / "anaconda/mem.bin").exists()
        assert "(blank: default parameters)" in process.text()


def test_rc(peer):
    with node("rc"):
        check_module(peer, "rc")
        received = peer.listen(RCRaw, "sim/RC")
        peer.wait(lambda: len(received) >= 20, "frames")
        check_headers(received, MODULES["rc"].outputs["sim/RC"])
        initial = [1500, 1500, 1000, 1500, 1000, 2000, 1500, 1500]  # disarmed, the pilot holds
        assert list(received[-1].values) == initial
        for service, channel in (("toggle_arm", 4), ("toggle_override", 5)):
            assert peer.call(Trigger, service).success
            peer.wait(lambda c=channel: received[-1].values[c] == 3000 - initial[c], f"channel {channel}")
            assert peer.call(Trigger, service).success
            peer.wait(lambda: list(received[-1].values) == initial, "the first state")


class Run:
    """A board that only counts its steps."""

    def __init__(self, peer):
        self.peer, self.count = peer, 0
        peer.node.create_service(Trigger, "sil_board/run", self._answer)

    def _answer(self, _, response):
        with self.peer.changed:
            self.count += 1
            self.peer.changed.notify_all()
        response.success = True
        return response


def test_manager_steps_by_hand(peer):
    with node("rosflight_sil_manager", use_timer="false", service_exists_timeout_ms=200, service_result_timeout_ms=9000):
        check_module(peer, "manager")
        answer = peer.call(Trigger, "rosflight_sil/take_sim_step")
        assert not answer.success and "sil_board/run" in answer.message
        run = Run(peer)
        peer.poll(lambda: peer.call(Trigger, "rosflight_sil/take_sim_step").success, "the first step")
        run.count = 0
        for count in range(1, 6):
            assert peer.call(Trigger, "rosflight_sil/take_sim_step").success
            assert run.count == count


def test_manager_answers_for_a_board_that_takes_too_long(peer):
    limit_s = 0.2

    def late(_, response):
        time.sleep(5 * limit_s)
        response.success = True
        return response
    with node("rosflight_sil_manager", use_timer="false", service_result_timeout_ms=int(1e3 * limit_s)), SimPeer("board") as board:
        board.node.create_service(Trigger, "sil_board/run", late)

        def step():
            return peer.call(Trigger, "rosflight_sil/take_sim_step")
        peer.poll(lambda: "found no service" not in step().message, "the board")
        answer = step()
        assert not answer.success and answer.message == "found no answer of sil_board/run in time"


def test_manager_steps_at_its_rate_in_simulated_time(peer):
    with node("rosflight_sil_manager", use_sim_time="true"):
        run = Run(peer)
        clock = peer.publisher(Clock, "/clock", BEST_EFFORT)
        time_ns = 0

        def ticks(count):
            """So many periods of 2.5 ms; a tick is sent again until it has been seen."""
            nonlocal time_ns
            for _ in range(count):
                time_ns += TICK_NS
                before = run.count
                message = Clock()
                message.clock.sec, message.clock.nanosec = divmod(time_ns, 1_000_000_000)
                for _ in range(200):
                    clock.publish(message)
                    with peer.changed:
                        if peer.changed.wait_for(lambda b=before: run.count > b, 0.2):
                            break
        ticks(5)
        run.count = 0
        ticks(100)
        assert run.count == 100

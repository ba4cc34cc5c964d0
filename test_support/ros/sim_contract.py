# SPDX-License-Identifier: BSD-3-Clause
"""What each module of the simulator owes the others: topics, types, rates, stamps, frames, services.

Names are relative. A node of your own that fulfils its line can stand in for ours; `check_module` asks the ROS graph."""

import contextlib
from dataclasses import dataclass, field

from geometry_msgs.msg import Vector3Stamped, WrenchStamped
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy
from rosflight_msgs.msg import Airspeed, Barometer, BatteryStatus, GNSS, PwmOutput, RCRaw, SimState
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, MagneticField, Range, Temperature
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker

LOOP_HZ = 400


@dataclass
class Out:
    """A topic that a module writes. rate_Hz: of node time; a text names the parameter that says it; None: any. every: so many of them
    make one message."""
    kind: type
    rate_Hz: object = LOOP_HZ
    frame: object = None  # None: the message has no header, or any frame
    best_effort: bool = False
    latched: bool = False
    every: int = 1


@dataclass
class Module:
    node: str  # its name at launch
    outputs: dict
    inputs: dict = field(default_factory=dict)
    services: dict = field(default_factory=dict)


TRIGGER = "std_srvs/srv/Trigger"

MODULES = {
    "time": Module("standalone_time_manager", {"/clock": Out(Clock, None, best_effort=True),
                                              "/clock_steps": Out(Clock, None, best_effort=True)},
                   services={"time_manager/toggle_pause": TRIGGER, "time_manager/take_step": TRIGGER}),
    "manager": Module("rosflight_sil_manager", {}, services={"rosflight_sil/take_sim_step": TRIGGER}),
    "board": Module(
        "sil_board", {"sim/pwm_output": Out(PwmOutput)},
        {"sim/RC": RCRaw, "sim/sensors/imu/data": Imu, "sim/sensors/imu/temperature": Temperature,
         "sim/sensors/mag": MagneticField, "sim/sensors/baro": Barometer, "sim/sensors/gnss": GNSS,
         "sim/sensors/diff_pressure": Airspeed, "sim/sensors/range": Range, "sim/sensors/battery": BatteryStatus},
        {"sil_board/run": TRIGGER}),
    "rc": Module("rc", {"sim/RC": Out(RCRaw, 50)}, services={"toggle_arm": TRIGGER, "toggle_override": TRIGGER}),
    "forces": Module("multirotor_forces_and_moments",
                     {"sim/forces_and_moments": Out(WrenchStamped, LOOP_HZ, "aircraft_body")},
                     {"sim/pwm_output": PwmOutput, "sim/truth_state": SimState, "sim/truth_wind": Vector3Stamped}),
    "dynamics": Module("standalone_dynamics",
                       {"sim/truth_state": Out(SimState, LOOP_HZ, "NED"),
                        "sim/truth_wind": Out(Vector3Stamped, None, "NED")},
                       {"sim/forces_and_moments": WrenchStamped},
                       {"dynamics/set_sim_state": "rosflight_msgs/srv/SetSimState"}),
    "sensors": Module(
        "standalone_sensors",
        {"sim/sensors/imu/data": Out(Imu, "imu_update_frequency", "aircraft_body"),
         "sim/sensors/imu/temperature": Out(Temperature, "imu_update_frequency", "aircraft_body", every=10),
         "sim/truth_imu_bias": Out(Imu, "imu_update_frequency"),
         "sim/sensors/mag": Out(MagneticField, "mag_update_frequency", "aircraft_body"),
         "sim/sensors/baro": Out(Barometer, "baro_update_frequency", "aircraft_body"),
         "sim/sensors/gnss": Out(GNSS, "gnss_update_frequency", "aircraft_body"),
         "sim/sensors/diff_pressure": Out(Airspeed, "diff_pressure_update_frequency", "aircraft_body"),
         "sim/sensors/range": Out(Range, "range_update_frequency", "aircraft_body"),
         "sim/sensors/battery": Out(BatteryStatus, "battery_update_frequency", "aircraft_body")},
        {"sim/truth_state": SimState, "sim/truth_wind": Vector3Stamped}),
    "viz": Module("standalone_viz_transcriber",
                  {"rviz/mesh": Out(Marker, None, "stl_frame"), "rviz/mesh_path": Out(Marker, None, "NED"),
                   "/tf": Out(TFMessage, None), "/tf_static": Out(TFMessage, None, latched=True)},
                  {"sim/truth_state": SimState}),
}


def type_name(kind):
    package, _, _ = kind.__module__.partition(".msg")
    return f"{package}/msg/{kind.__name__}"


def check_module(peer, name):
    """The graph shows every topic and service of a module (of ours by its name), with type and quality of service."""
    module = MODULES[name] if isinstance(name, str) else name

    def ends(look, topic):
        topic = peer.node.resolve_topic_name(topic)
        return [end for end in look(topic) if end.node_name == module.node]
    for topic, out in module.outputs.items():
        peer.poll(lambda t=topic: ends(peer.node.get_publishers_info_by_topic, t), f"{module.node} to publish {topic}")
        end, = ends(peer.node.get_publishers_info_by_topic, topic)
        assert end.topic_type == type_name(out.kind), topic
        assert end.qos_profile.reliability == (ReliabilityPolicy.BEST_EFFORT if out.best_effort
                                               else ReliabilityPolicy.RELIABLE), topic
        assert end.qos_profile.durability == (DurabilityPolicy.TRANSIENT_LOCAL if out.latched
                                              else DurabilityPolicy.VOLATILE), topic
    with contextlib.ExitStack() as readers:  # some subscribe only while somebody reads what they make of it
        for topic, out in module.outputs.items():
            readers.enter_context(peer.reads(out.kind, topic))
        for topic, kind in module.inputs.items():
            peer.poll(lambda t=topic: ends(peer.node.get_subscriptions_info_by_topic, t), f"a subscription of {topic}")
            assert {end.topic_type for end in ends(peer.node.get_subscriptions_info_by_topic, topic)} == {type_name(kind)}, topic

    def services():
        found = {}
        for node_name, namespace in peer.node.get_node_names_and_namespaces():
            if node_name == module.node:
                found |= dict(peer.node.get_service_names_and_types_by_node(node_name, namespace))
        return found
    for service, kind in module.services.items():
        full = peer.node.resolve_service_name(service)
        peer.poll(lambda f=full: f in services(), f"service {service}")
        assert services()[full] == [kind], service


def check_headers(messages, out):
    """Stamps grow and the frame is the one of the contract."""
    stamps = [m.header.stamp.sec * 1_000_000_000 + m.header.stamp.nanosec for m in messages]
    assert all(later > earlier for earlier, later in zip(stamps, stamps[1:])), "stamps must grow"
    if out.frame is not None:
        assert {m.header.frame_id for m in messages} == {out.frame}
    return stamps

# SPDX-License-Identifier: BSD-3-Clause
"""Services and parameters: each answer is the outcome on the firmware."""

import itertools
import os
from pathlib import Path

import pytest
import yaml
from ros_rig import table, table_size, wait_for
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from rosflight_msgs.srv import ParamFile, ParamGet, ParamSet
from std_msgs.msg import Bool
from std_srvs.srv import Trigger


def get(rig, name):
    answer = rig.peer.call(ParamGet, "param_get", name=name)
    return answer.value if answer.exists else None


def test_param_get_knows_and_does_not_know(rig):
    assert get(rig, "RC_MAX_THR") == pytest.approx(0.7)
    assert get(rig, "SYS_ID") == 1
    assert get(rig, "NO_SUCH_THING") is None


def test_param_set_is_true_only_if_the_value_is_in_force(rig):
    assert rig.peer.call(ParamSet, "param_set", name="PID_ROLL_RATE_P", value=0.125).exists
    assert get(rig, "PID_ROLL_RATE_P") == 0.125
    assert not rig.peer.call(ParamSet, "param_set", name="NO_SUCH_THING", value=1.0).exists
    assert not rig.peer.call(ParamSet, "param_set", name="PRIMARY_MIXER", value=99.0).exists
    assert not rig.peer.call(ParamSet, "param_set", name="PRIMARY_MIXER", value=1.5).exists
    assert not rig.peer.call(ParamSet, "param_set", name="PID_ROLL_RATE_P", value=float("nan")).exists
    assert get(rig, "PID_ROLL_RATE_P") == 0.125


def test_changed_parameters_are_announced_and_writing_settles_them(rig):
    # The firmware measures it 5 s after the start: during a write it is a change that the write does not hold.
    wait_for(lambda: get(rig, "DIFF_PRESS_BIAS") != 0.0, "the zero offset of the pitot tube")
    changed = rig.peer.listen(Bool, "status/params_changed")
    unsaved = rig.peer.listen(Bool, "status/unsaved_params", latched=True)
    wait_for(lambda: unsaved, "the latched topic")
    values = itertools.count(26)  # a new one each time: the first announcement may come before the topic is known
    wait_for(lambda: rig.peer.call(ParamSet, "param_set", name="PID_YAW_RATE_P", value=0.01 * next(values)) and changed, "an announcement")
    wait_for(lambda: unsaved[-1][1].data, "unsaved")
    answer = rig.peer.call(Trigger, "param_write")
    assert answer.success, answer.message
    wait_for(lambda: not unsaved[-1][1].data, "saved", lambda: [message.data for _, message in unsaved])


def test_file_of_all_parameters_and_back(rig):
    file = rig.folder / "all.yaml"
    assert rig.peer.call(ParamFile, "param_save_to_file", filename=str(file)).success
    entries = yaml.safe_load(file.read_text())
    assert len(entries) == table_size() and set(entries[0]) == {"name", "type", "value"}
    assert rig.peer.call(ParamFile, "param_load_from_file", filename=str(file)).success


def test_a_path_may_begin_with_the_home_folder(rig):
    """No shell replaces the ~ in a request."""
    name = f".rosflight_test_{os.getpid()}.yaml"
    assert not rig.peer.call(ParamFile, "param_load_from_file", filename=f"~/{name}").success
    try:
        assert rig.peer.call(ParamFile, "param_save_to_file", filename=f"~/{name}").success
        assert (Path.home() / name).stat().st_size > 0
    finally:
        (Path.home() / name).unlink(missing_ok=True)


def test_file_reports_the_refused_entries_and_takes_the_good_ones(rig):
    file = rig.folder / "mixed.yaml"
    file.write_text("- {name: PID_PITCH_RATE_P, type: 9, value: 0.375}\n- {name: NO_SUCH_THING, type: 6, value: 1}\n"
                    "- {name: PRIMARY_MIXER, type: 6, value: 99}\n")
    assert not rig.peer.call(ParamFile, "param_load_from_file", filename=str(file)).success
    assert get(rig, "PID_PITCH_RATE_P") == 0.375
    for part in ("NO_SUCH_THING: no such parameter", "PRIMARY_MIXER: 99 refused", "3 parameters: 1 set, 1 refused, 1 unknown"):
        rig.io.wait_line(part)


@pytest.mark.parametrize("text, part", [("- {name: A, type: six, value: 1}\n", "type"), ("{}", ""), ("\x00\xff", "")])
def test_broken_file_sets_nothing_and_says_why(rig, text, part):
    file = rig.folder / "broken.yaml"
    file.write_text(text)
    assert not rig.peer.call(ParamFile, "param_load_from_file", filename=str(file)).success
    rig.io.wait_line("broken.yaml")


def test_unwritable_and_missing_files_are_no_success(rig):
    assert not rig.peer.call(ParamFile, "param_save_to_file", filename="/no/such/folder/a.yaml").success
    assert not rig.peer.call(ParamFile, "param_load_from_file", filename="/no/such/file.yaml").success


def test_calibrations_answer_with_their_outcome(rig):
    for name in ("calibrate_imu", "calibrate_baro", "calibrate_airspeed"):
        answer = rig.peer.call(Trigger, name)
        assert answer.success, (name, answer.message)


def test_magnetometer_calibration_cannot_run_twice_at_once(rig):
    client = rig.peer.node.create_client(Trigger, "calibrate_mag")
    assert client.wait_for_service(timeout_sec=10)
    first = client.call_async(Trigger.Request())
    rig.io.wait_line("Magnetometer:")
    second = rig.peer.call(Trigger, "calibrate_mag")
    assert not second.success and second.message
    assert not first.done()


def test_list_is_complete_and_mixers_can_be_printed(rig):
    assert rig.peer.call(Trigger, "all_params_received").success
    answer = rig.peer.call(Trigger, "print_mixing_matrix")
    assert answer.success and "PRI mixer" in answer.message and "SEC mixer" in answer.message


# ---- the firmware's parameters as ROS parameters


def ros_set(rig, name, **value):
    kind = ParameterType.PARAMETER_DOUBLE if "double_value" in value else ParameterType.PARAMETER_INTEGER
    parameter = Parameter(name=name, value=ParameterValue(type=kind, **value))
    return rig.peer.call(SetParameters, "rosflight_io/set_parameters", parameters=[parameter]).results[0]


def ros_get(rig, name):
    return rig.peer.call(GetParameters, "rosflight_io/get_parameters", names=[name]).values[0]


def test_every_firmware_parameter_is_a_ros_parameter(rig):
    names = rig.peer.call(ListParameters, "rosflight_io/list_parameters").result.names
    assert {"PID_ROLL_RATE_P", "RC_MAX_THR", "PRI_MIXER_0_0", "SYS_ID", "udp", "port"} <= set(names)
    assert len([name for name in names if name.isupper()]) >= table_size()


def test_every_firmware_parameter_has_its_text_unit_and_range_in_ros(rig):
    """As the firmware's table has them; a value apart from the range widens the interval, which is all that ROS has."""
    rows = {row["name"]: row for row in table()}
    described = rig.peer.call(DescribeParameters, "rosflight_io/describe_parameters", names=list(rows)).descriptors
    assert len(described) == table_size() >= 333
    largest = 3.4028234663852886e38  # of a float: no limit
    for one in described:
        row = rows[one.name]
        assert one.description == row["description"] + (f" [{row['units']}]" if row["units"] else "")
        whole = row["type"] == "int32"
        assert one.type == (ParameterType.PARAMETER_INTEGER if whole else ParameterType.PARAMETER_DOUBLE)
        assert len(one.integer_range if whole else one.floating_point_range) == 1, one
        found = (one.integer_range if whole else one.floating_point_range)[0]
        apart = [float(row["sentinel"])] if row["sentinel"] else [float(row["default"])]
        assert found.from_value == max(min([float(row["min"]), *apart]), -largest), one
        assert found.to_value == min(max([float(row["max"]), *apart]), largest), one
        assert one.additional_constraints.startswith("allowed: ")
    constraints = {one.name: one.additional_constraints for one in described}
    assert constraints["RC_ARM_CHN"] == "allowed: -1, 4 .. 7"


def test_setting_a_ros_parameter_sets_the_firmware(rig):
    result = ros_set(rig, "PID_ROLL_ANG_P", double_value=0.1875)
    assert result.successful, result.reason
    assert get(rig, "PID_ROLL_ANG_P") == 0.1875


def test_what_the_firmware_refuses_the_ros_parameter_refuses_with_the_reason(rig):
    before = ros_get(rig, "PRIMARY_MIXER").integer_value
    result = ros_set(rig, "PRIMARY_MIXER", integer_value=99)
    assert not result.successful and "PRIMARY_MIXER" in result.reason
    assert ros_get(rig, "PRIMARY_MIXER").integer_value == before


def lines_about(rig, name):
    return [line for line in rig.io.lines if name in line]


def test_a_refusal_is_logged_once(rig):
    """Inside the interval that ROS has, outside what the firmware allows: the value goes to the firmware several times, which
    says no each time; the log has it once, whichever way the value came."""
    file = rig.folder / "refused.yaml"
    file.write_text("- {name: RC_ARM_CHN, type: 6, value: 2}\n")
    before = len(lines_about(rig, "RC_ARM_CHN"))
    for count, refused in enumerate((lambda: not ros_set(rig, "RC_ARM_CHN", integer_value=2).successful,
                                     lambda: not rig.peer.call(ParamSet, "param_set", name="RC_ARM_CHN", value=2.0).exists), 1):
        assert refused()
        wait_for(lambda n=count: len(lines_about(rig, "RC_ARM_CHN")) == before + n, "a line", lambda: lines_about(rig, "RC_ARM_CHN"))
    assert not rig.peer.call(ParamFile, "param_load_from_file", filename=str(file)).success
    rig.io.wait_line("1 parameters: 1 refused")  # the summary of a file comes last
    lines = lines_about(rig, "RC_ARM_CHN")[before:]
    assert len(lines) == 3 and all("2 refused, stays at -1" in line for line in lines), lines


def test_change_on_the_firmware_is_seen_in_ros(rig):
    assert rig.peer.call(ParamSet, "param_set", name="PID_ROLL_ANG_D", value=0.0625).exists
    wait_for(lambda: ros_get(rig, "PID_ROLL_ANG_D").double_value == 0.0625, "the ROS parameter")

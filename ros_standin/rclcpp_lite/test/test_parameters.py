# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of a node on rclcpp_lite, asked and set from rclpy and given on the command line."""

import pytest
from rcl_interfaces.msg import Parameter, ParameterEvent, ParameterType, ParameterValue
from rcl_interfaces.srv import (DescribeParameters, GetParameters, GetParameterTypes,
                                ListParameters, SetParameters, SetParametersAtomically)
from rclpy.parameter import Parameter as ClientParameter
from rclpy.parameter import parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient
from ros_peer import LIMIT_S, Process, Tester, lite_program, run, until
from std_srvs.srv import Trigger


def double(name: str, value: float) -> Parameter:
    return Parameter(name=name, value=ParameterValue(type=ParameterType.PARAMETER_DOUBLE,
                                                     double_value=value))


def integer(name: str, value: int) -> Parameter:
    return Parameter(name=name, value=ParameterValue(type=ParameterType.PARAMETER_INTEGER,
                                                     integer_value=value))


def string(name: str, value: str) -> Parameter:
    return Parameter(name=name, value=ParameterValue(type=ParameterType.PARAMETER_STRING,
                                                     string_value=value))


def values(tester, *names: str, node: str = "peer") -> list:
    found = tester.call(GetParameters, f"/{node}/get_parameters", names=list(names)).values
    return [parameter_value_to_python(value) for value in found]


def set_one(tester, parameter: Parameter):
    return tester.call(SetParameters, "/peer/set_parameters", parameters=[parameter]).results[0]


def test_list_has_all_names_and_prefixes(tester, peer):
    found = tester.call(ListParameters, "/peer/list_parameters").result
    assert set(found.names) == {"count", "even", "fixed", "free", "gain", "group.deep.names",
                                "group.flag", "group.numbers", "use_sim_time"}
    assert set(found.prefixes) == {"group", "group.deep"}


@pytest.mark.parametrize("prefixes, depth, names", [
    (["group"], 0, {"group.deep.names", "group.flag", "group.numbers"}),
    (["group"], 1, {"group.flag", "group.numbers"}),
    (["group.deep"], 1, {"group.deep.names"}),
    (["even"], 1, {"even"}),
    (["eve"], 0, set()),
    ([], 1, {"count", "even", "fixed", "free", "gain", "use_sim_time"})])
def test_list_obeys_prefixes_and_depth(tester, peer, prefixes, depth, names):
    found = tester.call(ListParameters, "/peer/list_parameters", prefixes=prefixes, depth=depth)
    assert set(found.result.names) == names


def test_describe_tells_ranges_and_descriptions(tester, peer):
    gain, count, fixed = tester.call(DescribeParameters, "/peer/describe_parameters",
                                     names=["gain", "count", "fixed"]).descriptors
    assert (gain.name, gain.type, gain.description) == ("gain", 3, "a gain")
    span = gain.floating_point_range[0]
    assert (span.from_value, span.to_value, span.step) == (0.0, 2.0, 0.25)
    span = count.integer_range[0]
    assert (span.from_value, span.to_value, span.step) == (-3, 9, 3)
    assert fixed.read_only and not gain.read_only


def test_types_and_values_are_told(tester, peer):
    names = ["gain", "count", "fixed", "group.flag", "group.deep.names", "group.numbers"]
    found = tester.call(GetParameterTypes, "/peer/get_parameter_types", names=names)
    assert list(found.types) == [3, 2, 4, 1, 9, 8]
    fixed, flag, deep, numbers = values(tester, *names[2:])
    assert (fixed, flag, list(deep), list(numbers)) == ("as it is", False, ["a", "b"], [1.0, 2.5])


def test_unknown_names_give_an_empty_answer(tester, peer):
    assert values(tester, "gain", "nothing") == []
    result = set_one(tester, double("nothing", 1.0))
    assert not result.successful and "'nothing' is not declared" in result.reason


@pytest.mark.parametrize("parameter, reason", [
    (double("gain", 2.25), "0.000000 to 2.000000"), (double("gain", 1.1), "in steps of 0.25"),
    (double("gain", float("nan")), "allowed"), (integer("count", 10), "-3 to 9"),
    (integer("count", 4), "in steps of 3"), (integer("count", -2**63), "-3 to 9"),
    (integer("gain", 1), "of type [double], not [integer]"), (string("fixed", "x"), "read-only"),
    (integer("even", 3), "odd"), (Parameter(name="gain"), "not [not set]"),
    (Parameter(name=""), "needs a name")])
def test_bad_values_are_refused_with_the_reason(tester, peer, parameter, reason):
    before = values(tester, "gain", "count", "fixed", "even")
    result = set_one(tester, parameter)
    assert not result.successful
    assert reason in result.reason
    assert values(tester, "gain", "count", "fixed", "even") == before


@pytest.mark.parametrize("parameter", [
    double("gain", 0.0), double("gain", 1.75), double("gain", 2.0), integer("count", -3),
    integer("count", 6), integer("even", 8)])
def test_good_values_are_set_and_told_as_an_event(tester, peer, parameter):
    events = tester.subscribe(ParameterEvent, "/parameter_events")
    tester.matched("/parameter_events", 2)
    value = parameter_value_to_python(parameter.value)

    def told():
        assert set_one(tester, parameter).successful
        return [event for event in events if event.node == "/peer"]
    event = until(told, "an event")[0]
    assert [changed.name for changed in event.changed_parameters] == [parameter.name]
    assert parameter_value_to_python(event.changed_parameters[0].value) == value
    assert event.stamp.sec > 0
    assert values(tester, parameter.name) == [value]


def test_what_a_callback_throws_ends_the_node(tester):
    node = lite_program("peer_node", "--ros-args", "-r", "__ns:=/thrown")
    with pytest.raises(AssertionError, match="the callback threw"), Process(node) as running:
        client = tester.node.create_client(SetParameters, "/thrown/peer/set_parameters")
        assert client.wait_for_service(LIMIT_S)
        client.call_async(SetParameters.Request(parameters=[integer("even", -2)]))
        assert running.process.wait(LIMIT_S) == 2


def test_atomic_set_takes_all_or_none(tester, peer):
    def both(even):
        return tester.call(SetParametersAtomically, "/peer/set_parameters_atomically",
                           parameters=[double("gain", 0.5), integer("even", even)]).result
    assert set_one(tester, double("gain", 1.0)).successful
    assert not both(5).successful
    assert values(tester, "gain") == [1.0]
    assert both(4).successful
    assert values(tester, "gain", "even") == [0.5, 4]


def test_late_declaration_is_told_as_an_event(tester):
    events = tester.subscribe(ParameterEvent, "/parameter_events", 100)
    words = ["--ros-args", "-r", "__ns:=/young", "-p", "late:=6"]
    with Process(lite_program("peer_node", *words)):
        tester.matched("/parameter_events", 2)
        def told():
            tester.call(Trigger, "/young/declare")
            return [parameter_value_to_python(new.value) for event in events
                    if event.node == "/young/peer" for new in event.new_parameters
                    if new.name == "late"]
        until(told, "the declaration")
        assert told()[0] == 6
        assert values(tester, "late", node="young/peer") == [6]


def test_client_of_rclpy_understands_the_node(tester, peer, tmp_path):
    client = AsyncParameterClient(tester.node, "/peer")
    assert client.wait_for_services(LIMIT_S)

    def done(future):
        until(future.done, "an answer")
        return future.result()
    assert "gain" in done(client.list_parameters(["gain"], 1)).result.names
    results = done(client.set_parameters([ClientParameter("gain", value=0.25),
                                          ClientParameter("even", value=1)])).results
    assert [result.successful for result in results] == [True, False]
    assert parameter_value_to_python(done(client.get_parameters(["gain"])).values[0]) == 0.25
    assert done(client.describe_parameters(["gain"])).descriptors[0].description == "a gain"
    file = tmp_path / "more.yaml"
    file.write_text("/**:\n  ros__parameters: {gain: 0.5, even: 12}\n")
    loaded = done(client.load_parameter_file(str(file), use_wildcard=True)).results
    assert [result.successful for result in loaded] == [True, True]
    assert values(tester, "gain", "even") == [0.5, 12]


def test_only_a_parameter_of_free_type_changes_it_or_goes_away(tester, peer):
    client = AsyncParameterClient(tester.node, "/peer")
    assert client.wait_for_services(LIMIT_S)
    events = tester.subscribe(ParameterEvent, "/parameter_events", 100)
    tester.matched("/parameter_events", 2)
    assert set_one(tester, string("free", "now a text")).successful
    assert values(tester, "free") == ["now a text"]
    future = client.delete_parameters(["free"])
    until(future.done, "an answer")
    assert future.result().results[0].successful
    gone = [event for event in events if event.deleted_parameters and event.node == "/peer"]
    until(lambda: gone or [event for event in events if event.deleted_parameters], "the event")
    assert values(tester, "free") == []
    future = client.delete_parameters(["gain"])
    until(future.done, "an answer")
    assert not future.result().results[0].successful


# ---- the command line ----------------------------------------------------------------------------


FILE = """
/**:
  ros__parameters: {even: 10, gain: 0.25, group: {flag: true}}
/here/*:
  ros__parameters: {even: 20}
/here/other:
  ros__parameters:
    even: 30
    group: {numbers: [7.0], deep: {names: [x, u, v]}}
/elsewhere/other:
  ros__parameters: {even: 40}
"""


def test_files_wildcards_names_and_remappings(tmp_path):
    file = tmp_path / "parameters.yaml"
    file.write_text(FILE)
    words = ["--ros-args", "--params-file", str(file), "-p", "gain:=1.5", "-r", "__node:=other",
             "-r", "__ns:=/here", "-r", "reply:=answer"]
    with Process(lite_program("peer_node", *words)), Tester() as tester:
        names = ["even", "gain", "group.flag", "group.numbers", "group.deep.names", "count"]
        even, gain, flag, numbers, deep, count = values(tester, *names, node="here/other")
        assert (even, gain, flag, count) == (30, 1.5, True, 3)
        assert (list(numbers), list(deep)) == ([7.0], ["x", "u", "v"])
        tester.matched("/here/answer")
        assert tester.node.count_publishers("/here/reply") == 0


@pytest.mark.parametrize("words, says", [
    (["-p", "gain:=5.0"], "'gain' is 5.000000"), (["-p", "gain:=one"], "declared as [double]"),
    (["-p", "gain:=1"], "declared as [double], given [integer]"),
    (["-r", "__node:=two words"], "two words"),
    (["-p", "other:gain:=1", "-p", "peer:gain:=9.0"], "'gain' is 9.000000"),
    (["--no-such-word"], "--no-such-word"), (["--params-file", "/none.yaml"], "/none.yaml")])
def test_bad_words_on_the_command_line_end_the_program(words, says):
    done = run(lite_program("peer_node", "--ros-args", *words))
    assert done.returncode == 2, done.stdout
    assert says in done.stdout


def test_file_that_is_no_yaml_ends_the_program(tmp_path):
    file = tmp_path / "bad.yaml"
    file.write_text("/**:\n  ros__parameters: [1, 2\n")
    done = run(lite_program("peer_node", "--ros-args", "--params-file", str(file)))
    assert done.returncode == 2 and str(file) in done.stdout, done.stdout

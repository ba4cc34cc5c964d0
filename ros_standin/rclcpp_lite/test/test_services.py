# SPDX-License-Identifier: BSD-3-Clause
"""Services both ways between rclcpp_lite and rclpy."""

import pytest
from ros_peer import Process, lite_program, until
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger

pytestmark = pytest.mark.usefixtures("peer")


@pytest.mark.parametrize("service, says", [("simple", "simple"), ("with_id", "with id"),
                                           ("deferred", "later")])
@pytest.mark.parametrize("data", [True, False])
def test_every_form_of_service_answers(tester, service, says, data):
    answer = tester.call(SetBool, service, data=data)
    assert (answer.success, answer.message) == (data, says)


def test_client_finds_and_calls_a_service_in_python(tester):
    assert not tester.call(Trigger, "ask_python").success, "nobody serves yet"

    def serve(request, response):
        response.message = f"python got {request.data}"
        return response
    service = tester.node.create_service(SetBool, "server_in_python", serve)
    said = tester.subscribe(String, "python_said")
    until(lambda: tester.call(Trigger, "ask_python").success, "the client sees the service")
    until(lambda: said, "the answer came to the callback")
    assert said[-1].data == "python got True"
    assert tester.call(Trigger, "ask_python").message == "/server_in_python"
    tester.node.destroy_service(service)


def test_plain_code_waits_for_a_service_and_its_answer(tester):
    def serve(request, response):
        response.message = f"python got {request.data}"
        return response
    words = ["call", "--ros-args", "-r", "__ns:=/plain"]
    with Process(lite_program("waiting_program", *words)) as process:
        until(lambda: "not there yet" in process.said(), "a wait without a service ends")
        service = tester.node.create_service(SetBool, "/plain/server_in_python", serve)
        until(lambda: process.process.poll() is not None, "the answer ends the program")
        assert "answer: python got True" in process.said()
    tester.node.destroy_service(service)

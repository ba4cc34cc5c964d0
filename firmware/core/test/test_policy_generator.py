# SPDX-License-Identifier: BSD-3-Clause
"""The generator of a build's policy: its numbers against the reference evaluator of ONNX, and one line for each file it rejects."""
import pathlib
import subprocess
import sys

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper
from onnx.reference import ReferenceEvaluator

CORE = pathlib.Path(__file__).resolve().parents[1]
ROOT = CORE.parents[1]
GENERATOR = CORE / "policy" / "generate.py"
PROGRAM = """
#include <cstdio>
#include "firmware/core/policy.hpp"
int main() {
  const rosflight::core::Policy& policy = *rosflight::core::built_in_policy();
  std::printf("%s %.9g%s\\n", policy.name, double{policy.period_s}, policy.kind == rosflight::core::Policy::Kind::kMotorOutputs ? " motors" : "");
  rosflight::core::Policy::States states{};
  rosflight::core::Policy::Inputs x{};
  for (;;) {
    for (float& value : x) if (std::scanf("%f", &value) != 1) return 0;
    for (const float y : policy.step(states, x)) std::printf("%.9g ", double{y});
  }
}
"""


def draw(random, *shape, spread=0.4):
    return (spread * random.standard_normal(shape)).astype(np.float32)


def graph(nodes, constants, rank=2, outputs=(), inputs=(), first=12):
    """The observation is x, the action y."""
    sizes = [1] * (rank - 1)
    return helper.make_graph(
        nodes, "policy",
        [helper.make_tensor_value_info("x", TensorProto.FLOAT, [*sizes, first]), *inputs],
        [helper.make_tensor_value_info("y", TensorProto.FLOAT, [*sizes, "outputs"]), *outputs],
        [numpy_helper.from_array(value, name) for name, value in constants.items()])


def model_of(*arguments, metadata=(), **keys):
    model = helper.make_model(graph(*arguments, **keys), opset_imports=[helper.make_opsetid("", 17)])
    model.ir_version = 8
    for key, value in metadata:
        helper.set_model_props(model, {key: value})
    return model


def generate(tmp_path, model, name="policy.onnx"):
    file, source = tmp_path / name, tmp_path / "policy.cpp"
    if isinstance(model, bytes):
        file.write_bytes(model)
    else:
        onnx.save(model, file)
    done = subprocess.run([sys.executable, str(GENERATOR), str(file), str(source)], capture_output=True, text=True)
    return done, source


def built(tmp_path, model, inputs=12, outputs=3):
    """@returns the first line of the compiled program, and its outputs for 50 random inputs in a row, with these inputs."""
    done, source = generate(tmp_path, model)
    assert done.returncode == 0, done.stderr
    (tmp_path / "main.cpp").write_text(PROGRAM)
    subprocess.run(["c++", "-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-ffp-contract=off", f"-I{ROOT}",
                    "-isystem", "/usr/include/eigen3", "-o", tmp_path / "policy", tmp_path / "main.cpp", source,
                    CORE / "activation.cpp"], check=True)
    x = np.random.default_rng(2).standard_normal((50, 14)).astype(np.float32)
    text = "\n".join(" ".join(f"{value:.9g}" for value in row) for row in x)
    printed = subprocess.run([tmp_path / "policy"], input=text, capture_output=True, text=True, check=True).stdout
    first, rest = printed.split("\n", 1)
    y = np.array(rest.split(), float).reshape(50, 4)
    assert not y[:, outputs:].any(), "the numbers that it does not have are zeros"
    return first, y[:, :outputs], x[:, :inputs]


def perceptron(random, extra=(), last="Tanh"):
    """Each way to write a layer: MatMul and Add, Gemm with both transpositions, factors, and no bias."""
    nodes = [helper.make_node("MatMul", ["x", "w1"], ["a1"], "first"), helper.make_node("Add", ["b1", "a1"], ["a2"], "bias"),
             helper.make_node("Relu", ["a2"], ["a3"]),
             helper.make_node("Gemm", ["a3", "w2", "b2"], ["a4"], transB=1, alpha=0.5, beta=2.0), helper.make_node("Sigmoid", ["a4"], ["a5"]),
             helper.make_node("Gemm", ["a5", "w3"], ["a6"], "last"), helper.make_node(last, ["a6"], ["y"], "end"), *extra]
    constants = {"w1": draw(random, 12, 20), "b1": draw(random, 20), "w2": draw(random, 17, 20), "b2": draw(random, 1, 17),
                 "w3": draw(random, 17, 3)}
    return nodes, constants


def test_a_perceptron_gives_the_numbers_of_the_reference_evaluator(tmp_path):
    nodes, constants = perceptron(np.random.default_rng(1))
    model = model_of(nodes, constants, metadata=[("rate_hz", "100")])
    onnx.checker.check_model(model)
    first, y, x = built(tmp_path, model)
    assert first == "policy.onnx 0.00999999978"
    reference = ReferenceEvaluator(model)
    for row, found in zip(x, y):
        assert found == pytest.approx(reference.run(None, {"x": row[None]})[0][0], abs=2e-6)


def of_motors(outputs=4):
    random = np.random.default_rng(6)
    nodes = [helper.make_node("Gemm", ["x", "w", "b"], ["a"], "only"), helper.make_node("Tanh", ["a"], ["y"], "end")]
    return model_of(nodes, {"w": draw(random, 14, outputs), "b": draw(random, outputs)}, first=14, metadata=[("outputs", "motors")])


def test_a_policy_of_motors_has_14_inputs_and_4_outputs(tmp_path):
    model = of_motors()
    first, y, x = built(tmp_path, model, inputs=14, outputs=4)
    assert first == "policy.onnx 0 motors"
    reference = ReferenceEvaluator(model)
    for row, found in zip(x, y):
        assert found == pytest.approx(reference.run(None, {"x": row[None]})[0][0], abs=2e-6)


def test_other_sizes_of_a_policy_of_motors_are_rejected(tmp_path):
    assert rejected(tmp_path, of_motors(3)) == "found 3 outputs, allowed 4"
    nodes, constants = perceptron(np.random.default_rng(1))
    model = model_of(nodes, constants, metadata=[("outputs", "motors")])
    assert rejected(tmp_path, model) == "node 'first' (MatMul): found 12 inputs, allowed 14"
    model = model_of(nodes, constants, metadata=[("outputs", "torques")])
    assert rejected(tmp_path, model) == "metadata outputs: found 'torques', allowed rates, motors"


def clipped(low=-1.0, high=1.0):
    nodes, constants = perceptron(np.random.default_rng(1))
    nodes[-1] = helper.make_node("Clip", ["a6", "low", "high"], ["y"], "limit")
    return model_of(nodes, constants | {"w3": draw(np.random.default_rng(4), 17, 3, spread=0.5), "low": np.float32(low), "high": np.float32(high)})


def test_outputs_are_clipped_as_by_the_reference_evaluator(tmp_path):
    model = clipped()
    onnx.checker.check_model(model)
    _, y, x = built(tmp_path, model)
    reference = ReferenceEvaluator(model)
    for row, found in zip(x, y):
        assert found == pytest.approx(reference.run(None, {"x": row[None]})[0][0], abs=1e-5)
    assert 0.1 < np.mean(np.abs(y) == 1.0) < 0.9 and np.abs(y).max() == 1.0


def test_other_limits_are_rejected(tmp_path):
    assert rejected(tmp_path, clipped(low=-2.0)) == "node 'limit' (Clip): found the limits -2 and 1, allowed -1 and 1"
    assert rejected(tmp_path, clipped(high=np.nan)).startswith("node 'limit' (Clip): found a number in 'high' that is not finite")


@pytest.mark.parametrize("reset_after", [0, 1])
def test_a_recurrent_network_gives_the_numbers_of_the_reference_evaluator(tmp_path, reset_after):
    random = np.random.default_rng(3)
    model = recurrent(random, reset_after)
    onnx.checker.check_model(model)
    first, y, x = built(tmp_path, model)
    assert first == "policy.onnx 0"
    reference, h = ReferenceEvaluator(model), np.zeros((1, 1, 10), np.float32)
    for row, found in zip(x, y):
        expected, h = reference.run(None, {"x": row[None, None], "h": h})
        assert found == pytest.approx(expected.reshape(-1), abs=2e-6)


def recurrent(random, reset_after=1, units=10, **attributes):
    nodes = [helper.make_node("GRU", ["x", "w", "r", "b", "", "h"], ["", "h_next"], "memory", hidden_size=units,
                              linear_before_reset=reset_after, **attributes),
             helper.make_node("MatMul", ["h_next", "v"], ["y"], "last")]
    constants = {"w": draw(random, 1, 3 * units, 12), "r": draw(random, 1, 3 * units, units), "b": draw(random, 1, 6 * units),
                 "v": draw(random, units, 3)}
    state = [1, 1, units]
    return model_of(nodes, constants, rank=3, inputs=[helper.make_tensor_value_info("h", TensorProto.FLOAT, state)],
                    outputs=[helper.make_tensor_value_info("h_next", TensorProto.FLOAT, state)])


def rejected(tmp_path, model):
    done, source = generate(tmp_path, model)
    assert done.returncode == 2 and not source.exists() and not list(tmp_path.glob("*.new"))
    assert done.stdout == "" and done.stderr.count("\n") == 1, done.stderr
    return done.stderr.removeprefix(f"{tmp_path}/policy.onnx: ").rstrip("\n")


def changed(**constants):
    nodes, known = perceptron(np.random.default_rng(1))
    return model_of(nodes, known | constants)


def nodes_and(extra=(), last="Tanh"):
    return model_of(*perceptron(np.random.default_rng(1), extra, last))


ALLOWED = "Gemm, MatMul, Add, Tanh, Relu, Sigmoid, Clip, GRU"


def test_another_operator_is_named(tmp_path):
    assert rejected(tmp_path, nodes_and(last="Softmax")) == f"node 'end' (Softmax): found Softmax, allowed {ALLOWED}"


def test_a_node_without_a_name_is_named_by_its_output(tmp_path):
    nodes, constants = perceptron(np.random.default_rng(1))
    nodes[2] = helper.make_node("Elu", ["a2"], ["a3"])
    assert rejected(tmp_path, model_of(nodes, constants)) == f"node 'a3' (Elu): found Elu, allowed {ALLOWED}"


def test_a_branch_is_rejected(tmp_path):
    nodes, constants = perceptron(np.random.default_rng(1))
    nodes[3] = helper.make_node("Gemm", ["a1", "w2", "b2"], ["a4"], "side", transB=1)
    assert rejected(tmp_path, model_of(nodes, constants)) == \
        "node 'side' (Gemm): found the inputs a1, w2, b2, allowed the output of the node before, a3, once"


def test_two_functions_in_a_row_are_rejected(tmp_path):
    nodes, constants = perceptron(np.random.default_rng(1))
    nodes[-1:] = [helper.make_node("Tanh", ["a6"], ["a7"]), helper.make_node("Relu", ["a7"], ["y"], "again")]
    assert rejected(tmp_path, model_of(nodes, constants)) == "node 'again' (Relu): found Relu here, allowed after Gemm, MatMul or Add"


@pytest.mark.parametrize("constants, line", [
    ({"w1": np.ones((11, 20), np.float32)}, "node 'first' (MatMul): found 11 inputs, allowed 12"),
    ({"w3": np.ones((17, 4), np.float32)}, "found 4 outputs, allowed 3"),
    ({"w3": np.ones((16, 3), np.float32)}, "node 'last' (Gemm): found 16 inputs, allowed 17"),
    ({"b1": np.ones(19, np.float32)}, "node 'bias' (Add): found 19 numbers to add, allowed 20 or 1"),
    ({"w1": np.ones((12, 20), np.float64)}, "node 'first' (MatMul): found DOUBLE in 'w1', allowed FLOAT"),
    ({"w1": np.ones((1, 12, 20), np.float32)}, "node 'first' (MatMul): found 3 dimensions in 'w1', allowed 2"),
    ({"w1": np.full((12, 20), np.nan, np.float32)},
     "node 'first' (MatMul): found a number in 'w1' that is not finite, allowed finite numbers"),
])
def test_constants_that_do_not_fit_are_rejected(tmp_path, constants, line):
    assert rejected(tmp_path, changed(**constants)) == line


@pytest.mark.parametrize("attributes, line", [
    ({"direction": "reverse"}, "node 'memory' (GRU): found direction b'reverse', allowed b'forward'"),
    ({"clip": 1.0}, "node 'memory' (GRU): found clip 1.0, allowed none"),
    ({"units": 65}, "node 'memory' (GRU): found 65 recurrent units up to here, allowed at most 64"),
])
def test_a_recurrent_layer_of_another_kind_is_rejected(tmp_path, attributes, line):
    assert rejected(tmp_path, recurrent(np.random.default_rng(1), **attributes)) == line


def test_an_input_that_is_no_state_is_rejected(tmp_path):
    extra = helper.make_tensor_value_info("z", TensorProto.FLOAT, [1])
    model = model_of(*perceptron(np.random.default_rng(1)), inputs=[extra])
    assert rejected(tmp_path, model) == "found the further input 'z', allowed the state of a GRU"


@pytest.mark.parametrize("rate", ["0", "401", "nan", "fast"])
def test_a_rate_out_of_range_is_rejected(tmp_path, rate):
    model = model_of(*perceptron(np.random.default_rng(1)), metadata=[("rate_hz", rate)])
    assert rejected(tmp_path, model) == f"metadata rate_hz: found '{rate}', allowed 1 to 400"


def test_what_is_no_onnx_file_is_rejected(tmp_path):
    assert "found no ONNX model" in rejected(tmp_path, b"\x0a\xffno model")
    assert rejected(tmp_path, b"") == "found no input or no output, allowed a graph with both"
    done = subprocess.run([sys.executable, str(GENERATOR), str(tmp_path / "none.onnx"), str(tmp_path / "policy.cpp")],
                          capture_output=True, text=True)
    assert done.returncode == 2 and "No such file" in done.stderr and done.stderr.count("\n") == 1

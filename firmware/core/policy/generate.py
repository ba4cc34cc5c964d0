#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the policy of a build from an ONNX file: its layers as C++ types, its numbers as a constant table.

usage: generate.py POLICY.onnx SOURCE.cpp

The graph is a chain of Gemm, MatMul, Add, Tanh, Relu, Sigmoid, Clip and GRU in float32, with the inputs and outputs of
firmware/core/policy.hpp; an initial state of a GRU may be a further input, its last state a further output. The model's
metadata may hold rate_hz, inferences per second; without it there is one for each IMU sample; and outputs, rates or motors;
without it they are rates."""
import os
import pathlib
import sys

import numpy as np
import onnx
from google.protobuf.message import DecodeError
from onnx import numpy_helper

MAX_STATES, MAX_RATE_HZ = 64, 400.0
KINDS = {"rates": ("kBodyRates", 12, 3), "motors": ("kMotorOutputs", 14, 4)}  #: In policy.hpp, inputs, outputs.
ACTIVATIONS = {"Tanh": "kTanh", "Relu": "kRelu", "Sigmoid": "kSigmoid"}
ALLOWED = "Gemm, MatMul, Add, Tanh, Relu, Sigmoid, Clip, GRU"


class PolicyError(Exception):
    """One line: what was found where, and what is allowed."""


class Dense:
    """y = f(G x + b); G has a row for each output."""

    def __init__(self, gains, bias):
        self.gains, self.bias, self.activation = gains, bias, None
        self.outputs, self.inputs = gains.shape
        self.states = 0

    def type(self):
        return f"Dense<{self.inputs}, {self.outputs}, Activation::{self.activation or 'kNone'}>"

    def arrays(self):
        return [self.gains.T, self.bias]


class Gru:
    """As in network.hpp: arrays in the order of its table."""

    def __init__(self, w, r, b, reset_after):
        self.states = self.outputs = n = r.shape[1]
        self.inputs, self.reset_after = w.shape[1], reset_after
        bias = b[:3 * n].copy()
        bias[:2 * n] += b[3 * n:5 * n]
        candidate = b[5 * n:]
        if not reset_after:
            bias[2 * n:] += candidate
            candidate = np.zeros_like(candidate)
        self.tables = [w.T, r[:2 * n].T, r[2 * n:].T, bias, candidate]

    def type(self):
        return f"Gru<{self.inputs}, {self.outputs}, {str(self.reset_after).lower()}>"

    def arrays(self):
        return self.tables


def complain(node, found, allowed):
    raise PolicyError(f"node '{node.name or ', '.join(node.output)}' ({node.op_type}): found {found}, allowed {allowed}")


class Reader:
    """Follows the graph from its first input to its first output."""

    def __init__(self, graph, size):
        self.size = size  #: Inputs of the first layer.
        self.constants = {tensor.name: tensor for tensor in graph.initializer}
        inputs = [value.name for value in graph.input if value.name not in self.constants]
        if not inputs or not graph.output:
            raise PolicyError("found no input or no output, allowed a graph with both")
        self.free_inputs = inputs[1:]
        self.current = {inputs[0]}  #: Names of the tensor that the next node takes.
        self.layers, self.last_states = [], set()
        for node in graph.node:
            self.read(node)
        outputs = [value.name for value in graph.output]
        if outputs[0] not in self.current:
            raise PolicyError(f"found the output '{outputs[0]}' elsewhere, allowed at the end of the chain of nodes")
        for what, names, known in (("input", self.free_inputs, set()), ("output", outputs[1:], self.last_states)):
            for name in names:
                if name not in known:
                    raise PolicyError(f"found the further {what} '{name}', allowed the state of a GRU")

    def read(self, node):
        readers = {"Gemm": self.gemm, "MatMul": self.matmul, "Add": self.add, "Clip": self.clip, "GRU": self.gru}
        readers |= dict.fromkeys(ACTIVATIONS, self.activation)
        if node.op_type not in readers or node.domain not in ("", "ai.onnx"):
            complain(node, node.op_type, ALLOWED)
        names = [name for name in node.input if name in self.current]
        if len(names) != 1 or (node.op_type != "Add" and node.input[0] not in self.current):
            before = " or ".join(sorted(self.current))
            complain(node, f"the inputs {', '.join(node.input)}", f"the output of the node before, {before}, once")
        readers[node.op_type](node)
        if node.op_type != "GRU":
            self.current = {node.output[0]}

    def constant(self, node, index, dimensions):
        name = node.input[index] if index < len(node.input) else ""
        if name not in self.constants:
            complain(node, f"'{name}' as input {index}", "an initializer of the graph")
        tensor = self.constants[name]
        if tensor.data_type != onnx.TensorProto.FLOAT:
            complain(node, f"{onnx.TensorProto.DataType.Name(tensor.data_type)} in '{name}'", "FLOAT")
        values = numpy_helper.to_array(tensor)
        if values.ndim != dimensions:
            complain(node, f"{values.ndim} dimensions in '{name}'", dimensions)
        if not np.isfinite(values).all():
            complain(node, f"a number in '{name}' that is not finite", "finite numbers")
        return values

    def append(self, node, layer):
        before = self.layers[-1].outputs if self.layers else self.size
        if layer.inputs != before:
            complain(node, f"{layer.inputs} inputs", before)
        self.layers.append(layer)

    def gemm(self, node):
        known = {"alpha": 1.0, "beta": 1.0, "transA": 0, "transB": 0} | attributes(node)
        if known["transA"]:
            complain(node, "transA 1", 0)
        b = self.constant(node, 1, 2)
        gains = np.float32(known["alpha"]) * (b if known["transB"] else b.T)
        self.append(node, Dense(gains, np.zeros(len(gains), np.float32)))
        if len(node.input) > 2 and node.input[2]:
            self.add_bias(node, np.float32(known["beta"]) * self.bias_of(node, 2))

    def matmul(self, node):
        gains = self.constant(node, 1, 2).T
        self.append(node, Dense(gains, np.zeros(len(gains), np.float32)))

    def add(self, node):
        self.open_layer(node)
        self.add_bias(node, self.bias_of(node, 1 if node.input[0] in self.current else 0))

    def bias_of(self, node, index):
        """A vector, or a matrix of one row."""
        name = node.input[index]
        matrix = name in self.constants and len(self.constants[name].dims) == 2
        return self.constant(node, index, 2 if matrix else 1).reshape(-1)

    def add_bias(self, node, bias):
        layer = self.layers[-1]
        if len(bias) not in (1, layer.outputs):
            complain(node, f"{len(bias)} numbers to add", f"{layer.outputs} or 1")
        layer.bias = layer.bias + bias

    def activation(self, node):
        self.open_layer(node).activation = ACTIVATIONS[node.op_type]

    def clip(self, node):
        limits = [float(self.constant(node, k, 0)) for k in (1, 2)]
        if limits != [-1.0, 1.0]:
            complain(node, f"the limits {limits[0]:g} and {limits[1]:g}", "-1 and 1")
        self.open_layer(node).activation = "kClip"

    def open_layer(self, node):
        """The last layer, where it is a sum that no function has been applied to."""
        if not self.layers or not isinstance(self.layers[-1], Dense) or self.layers[-1].activation:
            complain(node, f"{node.op_type} here", "after Gemm, MatMul or Add")
        return self.layers[-1]

    def gru(self, node):
        given = attributes(node)
        for key, allowed in (("direction", b"forward"), ("activations", [b"Sigmoid", b"Tanh"]), ("layout", 0)):
            if given.get(key, allowed) != allowed:
                complain(node, f"{key} {given[key]}", allowed)
        if "clip" in given:
            complain(node, f"clip {given['clip']}", "none")
        w, r = self.constant(node, 1, 3)[0], self.constant(node, 2, 3)[0]
        n = r.shape[1]
        b = self.constant(node, 3, 2)[0] if len(node.input) > 3 and node.input[3] else np.zeros(6 * n, np.float32)
        if w.shape[0] != 3 * n or r.shape[0] != 3 * n or len(b) != 6 * n:
            complain(node, f"W {w.shape}, R {r.shape}, B {b.shape}", f"{3 * n} and {3 * n} rows, {6 * n} numbers")
        if len(node.input) > 4 and node.input[4]:
            complain(node, f"sequence_lens '{node.input[4]}'", "none")
        if len(node.input) > 5 and node.input[5]:
            self.initial_state(node)
        self.append(node, Gru(w, r, b, given.get("linear_before_reset", 0) != 0))
        if sum(layer.states for layer in self.layers) > MAX_STATES:
            complain(node, f"{sum(layer.states for layer in self.layers)} recurrent units up to here", f"at most {MAX_STATES}")
        self.current = {name for name in node.output if name}  # a sequence of one: the same numbers
        self.last_states |= set(node.output[1:])

    def initial_state(self, node):
        name = node.input[5]
        if name in self.free_inputs:
            self.free_inputs.remove(name)
        elif self.constant(node, 5, 3).any():
            complain(node, f"other numbers than 0 in '{name}'", "zeros, or an input of the graph")


def attributes(node):
    return {entry.name: onnx.helper.get_attribute_value(entry) for entry in node.attribute}


def metadata(model):
    return {entry.key: entry.value for entry in model.metadata_props}


def kind_of(model):
    kind = metadata(model).get("outputs", "rates")
    if kind not in KINDS:
        raise PolicyError(f"metadata outputs: found '{kind}', allowed {', '.join(KINDS)}")
    return kind


def layers_of(model, kind):
    _, inputs, outputs = KINDS[kind]
    layers = Reader(model.graph, inputs).layers
    if not layers:
        raise PolicyError(f"found no layer, allowed {ALLOWED}")
    if layers[-1].outputs != outputs:
        raise PolicyError(f"found {layers[-1].outputs} outputs, allowed {outputs}")
    if not all(np.isfinite(array).all() for layer in layers for array in layer.arrays()):
        raise PolicyError("found sums of constants beyond float32, allowed finite numbers")
    return layers


def period_s(model):
    text = metadata(model).get("rate_hz")
    if text is None:
        return 0.0
    try:
        rate_hz = float(text)
    except ValueError:
        rate_hz = 0.0
    if not 1.0 <= rate_hz <= MAX_RATE_HZ:
        raise PolicyError(f"metadata rate_hz: found '{text}', allowed 1 to {MAX_RATE_HZ:g}")
    return 1.0 / rate_hz


def number(value):
    """Nine digits say which float32 it is."""
    text = f"{float(value):.9g}"
    return text + ("f" if "." in text or "e" in text else ".0f")


def table(layer):
    for array in layer.arrays():
        yield "        {{"
        numbers = [number(value) for value in array.reshape(-1)]
        yield from ("            " + ", ".join(numbers[k:k + 8]) + "," for k in range(0, len(numbers), 8))
        yield "        }},"


def source(name, kind, layers, period):
    yield f"// Generated from {name} by firmware/core/policy/generate.py. Do not edit."
    yield "#include <algorithm>"
    yield '#include "firmware/core/network.hpp"'
    yield '#include "firmware/core/policy.hpp"'
    yield "namespace rosflight::core {"
    yield "namespace {"
    yield f"using Built = Network<{', '.join(layer.type() for layer in layers)}>;"
    yield "static_assert(Built::kStates <= Policy::kMaxStates);"
    yield "constexpr Built::Table kTable{"
    for index, layer in enumerate(layers):
        yield f"    Built::Layer<{index}>::Table{{"
        yield from table(layer)
        yield "    },"
    yield "};"
    yield "Policy::Outputs infer(Policy::States& states, const Policy::Inputs& inputs) {"
    yield "  Built::Inputs x{};"
    yield "  std::copy_n(inputs.begin(), x.size(), x.begin());"
    yield "  const Built::Outputs y = Built::step(kTable, states.data(), x);"
    yield "  Policy::Outputs outputs{};"
    yield "  std::copy(y.begin(), y.end(), outputs.begin());"
    yield "  return outputs;"
    yield "}"
    quoted = name.replace("\\", "\\\\").replace('"', '\\"')
    yield f'constexpr Policy kPolicy{{"{quoted}", {number(np.float32(period))}, infer, Policy::Kind::{KINDS[kind][0]}}};'
    yield "}  // namespace"
    yield "const Policy* built_in_policy() {"
    yield "  return &kPolicy;"
    yield "}"
    yield "}  // namespace rosflight::core"


def main():
    if len(sys.argv) != 3:
        print("usage: generate.py POLICY.onnx SOURCE.cpp", file=sys.stderr)
        return 2
    given, out = sys.argv[1], pathlib.Path(sys.argv[2])
    try:
        model = onnx.load(given)
        kind = kind_of(model)
        text = "\n".join(source(pathlib.Path(given).name, kind, layers_of(model, kind), period_s(model))) + "\n"
        unfinished = out.with_suffix(".new")
        unfinished.write_text(text)
        os.replace(unfinished, out)
    except (PolicyError, OSError) as error:
        print(f"{given}: {error}", file=sys.stderr)
        return 2
    except DecodeError:
        print(f"{given}: found no ONNX model, allowed a file that onnx.save has written", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())

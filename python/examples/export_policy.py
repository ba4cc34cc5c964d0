# SPDX-License-Identifier: BSD-3-Clause
"""Writes a policy that ppo.py has learned for rosflight/Attitude-v0 as an ONNX file, for the inside of the firmware (ROSFLIGHT_POLICY).

    export_policy.py POLICY.npz FILE.onnx

ppo.py brings observations to mean 0 and spread 1: that becomes a part of the first layer. The environment limits actions to -1..1: that
becomes a Clip at the end. The limit of ten spreads on an observation is left out: no input of the firmware gets there in flight.
"""

from __future__ import annotations

import argparse
import os
import sys
import zipfile

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import TensorProto, helper, numpy_helper

Array = NDArray[np.float32]


def model_of(parameters: list[Array], rate_hz: float, end: str = "Tanh") -> onnx.ModelProto:
    """Gains (a row for each input) and biases in turn: layers of tanh. @param end: after the last one, Tanh or Clip."""
    nodes: list[onnx.NodeProto] = []
    constants = [numpy_helper.from_array(value, name) for name, value in (("low", np.array(-1, np.float32)), ("high", np.array(1, np.float32))) if end == "Clip"]
    tensor = "observation"
    for k in range(0, len(parameters), 2):
        layer, last = k // 2 + 1, k + 2 == len(parameters)
        for name, value in ((f"gains_{layer}", parameters[k]), (f"bias_{layer}", parameters[k + 1])):
            constants.append(numpy_helper.from_array(value, name))
        nodes.append(helper.make_node("Gemm", [tensor, f"gains_{layer}", f"bias_{layer}"], [f"sum_{layer}"], f"gemm_{layer}"))
        tensor = "action" if last else f"layer_{layer}"
        inputs = [f"sum_{layer}", "low", "high"] if last and end == "Clip" else [f"sum_{layer}"]
        nodes.append(helper.make_node(end if last else "Tanh", inputs, [tensor], f"end_{layer}"))
    sizes = len(parameters[0]), len(parameters[-1])
    graph = helper.make_graph(nodes, "policy", [helper.make_tensor_value_info("observation", TensorProto.FLOAT, [1, sizes[0]])],
                              [helper.make_tensor_value_info("action", TensorProto.FLOAT, [1, sizes[1]])], constants)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)])
    helper.set_model_props(model, {"rate_hz": f"{rate_hz:g}"})
    return model


def folded(parameters: list[Array], mean: NDArray[np.float64], spread: NDArray[np.float64]) -> list[Array]:
    """The same network for observations as they are: G ((x - m) / s) + b = (G / s) x + (b - (G / s) m)."""
    gains = parameters[0].astype(np.float64) / (spread + 1e-6)[:, None]
    bias = parameters[1] - mean @ gains
    return [gains.astype(np.float32), bias.astype(np.float32), *parameters[2:]]


def read(file: str) -> tuple[list[Array], float]:
    """Parameters for observations as they are, and the rate. @raises ValueError: the file is none of ppo.py."""
    try:
        with np.load(file) as saved:
            parameters = [saved[f"arr_{k}"] for k in range(sum(name.startswith("arr_") for name in saved.files))]
            if not parameters or len(parameters) % 2:
                raise KeyError("arr_0")
            return folded(parameters, saved["mean"], saved["spread"]), float(saved["rate_hz"])
    except (EOFError, KeyError, ValueError, zipfile.BadZipFile):
        raise ValueError(f"{file}: found no policy, allowed a file that ppo.py --out has written") from None


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("policy", help="what ppo.py --out has written")
    parser.add_argument("file", help="where the ONNX file goes")
    given = parser.parse_args()
    try:
        parameters, rate_hz = read(given.policy)
        unfinished = given.file + ".new"
        onnx.save(model_of(parameters, rate_hz, "Clip"), unfinished)
        os.replace(unfinished, given.file)
    except (OSError, ValueError) as error:
        print(f"export_policy: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())

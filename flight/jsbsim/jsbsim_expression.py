# SPDX-License-Identifier: BSD-3-Clause
"""Formulas that print themselves as JSBSim functions: `(2 * P("aero/alpha-rad")).xml()`."""

from dataclasses import dataclass
from xml.sax.saxutils import escape


class Formula:
    """Anything that can be added, multiplied, ... and written as the inside of a <function>."""

    def xml(self) -> str:
        raise NotImplementedError

    def __add__(self, other):
        return Call("sum", self, of(other))

    def __radd__(self, other):
        return Call("sum", of(other), self)

    def __sub__(self, other):
        return Call("difference", self, of(other))

    def __rsub__(self, other):
        return Call("difference", of(other), self)

    def __mul__(self, other):
        return Call("product", self, of(other))

    def __rmul__(self, other):
        return Call("product", of(other), self)

    def __truediv__(self, other):
        return Call("quotient", self, of(other))

    def __rtruediv__(self, other):
        return Call("quotient", of(other), self)

    def __neg__(self):
        return Call("product", Value(-1.0), self)


@dataclass(frozen=True)
class Value(Formula):
    number: float

    def xml(self):
        return f"<value>{self.number!r}</value>"


@dataclass(frozen=True)
class P(Formula):
    """A property of JSBSim's tree."""

    name: str

    def xml(self):
        return f"<property>{escape(self.name)}</property>"


class Call(Formula):
    def __init__(self, name, *arguments):
        self.name, self.arguments = name, [of(a) for a in arguments]

    def xml(self):
        return f"<{self.name}>" + "".join(a.xml() for a in self.arguments) + f"</{self.name}>"


class Table(Formula):
    """Straight lines between points."""

    def __init__(self, argument: P, xs, ys):
        self.argument, self.points = argument, list(zip(xs, ys, strict=True))

    def xml(self):
        rows = "\n".join(f"{float(x)!r} {float(y)!r}" for x, y in self.points)
        return (f'<table><independentVar lookup="row">{escape(self.argument.name)}</independentVar>'
                f"<tableData>\n{rows}\n</tableData></table>")


def of(x) -> Formula:
    return x if isinstance(x, Formula) else Value(float(x))


def low(a, b):
    return Call("min", a, b)


def high(a, b):
    return Call("max", a, b)


def clip(x, least, most):
    return high(least, low(x, most))


def root(x):
    return Call("sqrt", x)


def total(terms) -> Formula:
    terms = list(terms)
    if not terms:
        return Value(0.0)
    return terms[0] if len(terms) == 1 else Call("sum", *terms)

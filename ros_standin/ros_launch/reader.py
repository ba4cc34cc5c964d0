# SPDX-License-Identifier: BSD-3-Clause
"""Reads launch files into a plan; nothing is started here.

As in ROS 2, a file and what it includes share their variables, an `arg` has its default only if nobody
gave it a value before, and a group restores variables and namespace at its end.
"""

from pathlib import Path

import yaml

from .errors import LaunchError, one_of
from .packages import Packages
from .plan import Argument, Node, Plan
from .substitutions import Scope, command_words, substitute, truth
from .xml_tree import Element, read

_WHEN = {"if", "unless"}
_ACTIONS = {"arg", "let", "node", "executable", "group", "include", "push-ros-namespace",
            "push_ros_namespace", "set_env", "set_parameter", "set_remap", "log"}
_AT_EXIT = "shutdown"  # the one value of on_exit that ROS knows
_DEEPEST_INCLUDE = 20


class Reader:
    """Walks one launch file. @raises LaunchError with file and line."""

    def __init__(self, packages: Packages, given: dict[str, str], environment: dict[str, str],
                 lenient: bool = False):
        self.plan = Plan()
        self._scope = Scope(packages, dict(given), dict(environment))
        self._given = given
        self._namespace = ""
        self._environment: dict[str, str] = {}
        self._remappings: list[tuple[str, str]] = []  # of all nodes of the group
        self._parameters: list[str] = []  # of all nodes of the group
        self._depth = 0
        self._lenient = lenient  # for --show-args: required arguments may be missing

    def read(self, file: Path) -> Plan:
        self._file(file)
        for name in self._given:
            if name not in self.plan.arguments:
                raise LaunchError(f"{file}: argument: found {name!r}, allowed "
                                  f"{one_of(self.plan.arguments)}")
        return self.plan

    def _file(self, file: Path) -> None:
        root = read(file)
        if root.tag != "launch":
            raise root.error(f"root: found <{root.tag}>, allowed <launch>")
        root.check(set(), {"version"}, _ACTIONS)
        before = self._scope.folder
        self._scope.folder = file.resolve().parent
        self._walk(root)
        self._scope.folder = before

    def _walk(self, parent: Element) -> None:
        for element in parent.children:
            if self._applies(element):
                getattr(self, "_" + element.tag.replace("-", "_"))(element)

    # ---- attributes -----------------------------------------------------------------------------

    def _text(self, element: Element, name: str, default: str = "") -> str:
        text = element.attributes.get(name)
        if text is None:
            return default
        try:
            return substitute(text, self._scope)
        except LaunchError as why:
            raise element.error(f"{name} of <{element.tag}>: {why}") from why

    def _words(self, element: Element, name: str) -> list[str]:
        text = element.attributes.get(name)
        if text is None:
            return []
        try:
            return command_words(text, self._scope)
        except ValueError as why:
            raise element.error(f"{name} of <{element.tag}>: found {text!r}, allowed quotes that end before the next $( ({why})") from why
        except LaunchError as why:
            raise element.error(f"{name} of <{element.tag}>: {why}") from why

    def _applies(self, element: Element) -> bool:
        if _WHEN <= element.attributes.keys():
            raise element.error(f"<{element.tag}>: found if and unless, allowed one of them")
        for name in _WHEN & element.attributes.keys():
            try:
                return truth(self._text(element, name)) == (name == "if")
            except LaunchError as why:
                text = str(why).removeprefix(element.where + ": ")
                raise element.error(text if text.startswith(name) else f"{name}: {text}") from why
        return True

    # ---- variables ------------------------------------------------------------------------------

    def _arg(self, element: Element) -> None:
        element.check({"name"}, {"default", "description"} | _WHEN, {"choice"})
        name = self._text(element, "name")
        choices = []
        for choice in element.children:
            choice.check({"value"}, set(), set())
            choices.append(self._text(choice, "value"))
        has_default = "default" in element.attributes
        default = self._text(element, "default") if has_default else None
        argument = Argument(name, default, self._text(element, "description"), choices, element.where)
        self.plan.arguments.setdefault(name, argument)
        if name not in self._scope.variables:
            if default is None and not self._lenient:
                raise element.error(f"argument {name}: found no value, allowed {name}:=VALUE"
                                    + (f" with {one_of(choices)}" if choices else ""))
            self._scope.variables[name] = default or ""
        value = self._scope.variables[name]
        if choices and value not in choices and not self._lenient:
            raise element.error(f"argument {name}: found {value!r}, allowed {one_of(choices)}")

    def _let(self, element: Element) -> None:
        element.check({"name", "value"}, _WHEN, set())
        self._scope.variables[self._text(element, "name")] = self._text(element, "value")

    def _set_env(self, element: Element) -> None:
        element.check({"name", "value"}, _WHEN, set())
        name, value = self._text(element, "name"), self._text(element, "value")
        self._environment[name] = self._scope.environment[name] = value

    def _set_remap(self, element: Element) -> None:
        self._remappings.append(self._remapping(element))

    def _set_parameter(self, element: Element) -> None:
        """As ROS passes it on: -p NAME:=VALUE, which rcl refuses without a value and reads as YAML once more."""
        (name, value), = self._parameter(element).items()
        if value == "":
            raise element.error("value of <set_parameter>: found nothing, allowed a value; quotes in quotes keep an empty text: \"''\"")
        self._parameters.append(f"{name}:={value}")

    def _log(self, element: Element) -> None:
        element.check({"message"}, {"level"} | _WHEN, set())
        self.plan.messages.append(self._text(element, "message"))

    # ---- structure ------------------------------------------------------------------------------

    def _group(self, element: Element) -> None:
        element.check(set(), {"scoped"} | _WHEN, _ACTIONS)
        saved = (dict(self._scope.variables), self._namespace, dict(self._environment),
                 dict(self._scope.environment), list(self._remappings), list(self._parameters))
        scoped = truth(self._text(element, "scoped", "true"))
        self._walk(element)
        if scoped:
            (self._scope.variables, self._namespace, self._environment,
             self._scope.environment, self._remappings, self._parameters) = saved

    def _push_ros_namespace(self, element: Element) -> None:
        element.check({"namespace"}, _WHEN, set())
        self._namespace = _join(self._namespace, self._text(element, "namespace"))

    def _include(self, element: Element) -> None:
        element.check({"file"}, _WHEN, {"arg"})
        file = Path(self._text(element, "file"))
        if file.suffix == ".py":
            raise element.error(f"include: found {file.name!r}, allowed XML launch files")
        if not file.is_file():
            raise element.error(f"include: found {str(file)!r}, allowed a launch file that is there")
        self._depth += 1
        if self._depth > _DEEPEST_INCLUDE:
            raise element.error(f"include: found {self._depth} files inside each other, "
                                f"allowed {_DEEPEST_INCLUDE}")
        passed = []
        for arg in element.children:
            arg.check({"name", "value"}, _WHEN, set())
            if self._applies(arg):
                name = self._text(arg, "name")
                passed.append((name, arg))
                self._scope.variables[name] = self._text(arg, "value")
        outer, self.plan.arguments = self.plan.arguments, {}
        self._file(file)
        inner, self.plan.arguments = self.plan.arguments, outer
        for name, arg in passed:
            if name not in inner:
                raise arg.error(f"argument of {file.name}: found {name!r}, allowed {one_of(inner)}")
        for name, argument in inner.items():
            if name not in [name for name, _ in passed]:
                self.plan.arguments.setdefault(name, argument)
        self._depth -= 1

    # ---- processes ------------------------------------------------------------------------------

    def _node(self, element: Element) -> None:
        element.check({"pkg", "exec"}, {"name", "namespace", "args", "ros_args", "output", "on_exit"} | _WHEN,
                      {"param", "remap", "env"})
        at_exit = self._text(element, "on_exit", _AT_EXIT)
        if at_exit != _AT_EXIT:
            raise element.error(f"on_exit of <node>: found {at_exit!r}, allowed {_AT_EXIT}")
        package, executable = self._text(element, "pkg"), self._text(element, "exec")
        try:
            program = self._scope.packages.executable(package, executable)
        except LaunchError as why:
            if self._lenient:
                return
            raise element.error(str(why)) from why
        name = self._text(element, "name")
        if name and not name.replace("_", "a").isalnum():
            raise element.error(f"name of <node>: found {name!r}, allowed letters, digits and _")
        namespace = _join(self._namespace, self._text(element, "namespace"))
        node = Node(name=self._label(namespace, name or executable),
                    command=[str(program), *self._words(element, "args")],
                    where=element.where, what=f"{package}/{executable}", node_name=name or None,
                    full_name=_join("/", _join(namespace, name)) if name else None,
                    namespace=namespace, ros_arguments=self._words(element, "ros_args"),
                    parameters=list(self._parameters), remappings=list(self._remappings), environment=dict(self._environment))
        for child in element.children:
            if self._applies(child):
                getattr(self, "_node_" + child.tag)(child, node)
        self.plan.nodes.append(node)

    def _label(self, namespace: str, name: str) -> str:
        label = name if namespace in ("", "/") else f"{namespace.strip('/')}/{name}"
        taken = {node.name for node in self.plan.nodes}
        if label not in taken:
            return label
        return next(f"{label}-{n}" for n in range(2, len(taken) + 3) if f"{label}-{n}" not in taken)

    def _node_param(self, element: Element, node: Node) -> None:
        if "from" in element.attributes:
            element.check({"from"}, {"allow_substs"} | _WHEN, set())
            file = Path(self._text(element, "from"))
            _check_parameter_file(element, file)
            node.parameters.append(file)
            return
        node.parameters.append(self._parameter(element))

    def _parameter(self, element: Element) -> dict[str, object]:
        element.check({"name", "value"}, _WHEN, set())
        return {self._text(element, "name"): _typed(self._text(element, "value"))}

    def _node_remap(self, element: Element, node: Node) -> None:
        node.remappings.append(self._remapping(element))

    def _remapping(self, element: Element) -> tuple[str, str]:
        element.check({"from", "to"}, _WHEN, set())
        names = (self._text(element, "from"), self._text(element, "to"))
        if not all(names):
            raise element.error(f"<{element.tag}>: found an empty name, allowed a name of a topic or service")
        return names

    def _node_env(self, element: Element, node: Node) -> None:
        element.check({"name", "value"}, _WHEN, set())
        node.environment[self._text(element, "name")] = self._text(element, "value")

    def _executable(self, element: Element) -> None:
        element.check({"cmd"}, {"name", "output"} | _WHEN, {"env"})
        command = self._words(element, "cmd")
        if not command[0]:
            raise element.error("cmd of <executable>: found nothing, allowed a program")
        node = Node(name=self._label("", self._text(element, "name") or Path(command[0]).name),
                    command=command, where=element.where, what=command[0], is_ros=False,
                    environment=dict(self._environment))
        for child in element.children:
            self._node_env(child, node)
        self.plan.nodes.append(node)


def _join(namespace: str, more: str) -> str:
    if not more or more.startswith("/"):
        return more or namespace
    return f"{namespace.rstrip('/')}/{more}" if namespace else more


def _typed(text: str) -> object:
    """A value with the type that YAML sees in it; a list only if all its entries are of one type."""
    try:
        value = yaml.safe_load(text)
    except yaml.YAMLError:
        return text
    if isinstance(value, list) and value and len({type(x) for x in value}) == 1 \
            and isinstance(value[0], (bool, int, float, str)):
        return value
    return value if isinstance(value, (bool, int, float, str)) else text


def _check_parameter_file(element: Element, file: Path) -> None:
    try:
        document = yaml.safe_load(file.read_text())
    except OSError as why:
        raise element.error(f"from of <param>: found {str(file)!r} ({why.strerror}), "
                            "allowed a parameter file") from why
    except yaml.YAMLError as why:
        line = getattr(getattr(why, "problem_mark", None), "line", 0) + 1
        raise LaunchError(f"{file}:{line}: found no YAML, allowed a parameter file") from why
    named = isinstance(document, dict) and all(
        _has_parameters(entry) for entry in document.values())
    if not named:
        raise LaunchError(f"{file}:1: found no node with ros__parameters, allowed "
                          "NODE: {ros__parameters: {NAME: VALUE}}")


def _has_parameters(entry: object) -> bool:
    if not isinstance(entry, dict):
        return False
    if "ros__parameters" in entry:
        return isinstance(entry["ros__parameters"], dict)
    return bool(entry) and all(_has_parameters(inner) for inner in entry.values())


def find(words: list[str], packages: Packages) -> tuple[Path, dict[str, str]]:
    """FILE [NAME:=VALUE...] or PACKAGE FILE [NAME:=VALUE...] as a file and its arguments."""
    plain = [word for word in words if ":=" not in word]
    given: dict[str, str] = {}
    for word in (word for word in words if ":=" in word):
        name, value = word.split(":=", 1)
        if not name:
            raise LaunchError(f"argument: found {word!r}, allowed NAME:=VALUE")
        given[name] = value
    if len(plain) == 1:
        file = Path(plain[0])
        if not file.is_file():
            raise LaunchError(f"launch file: found {plain[0]!r}, allowed a file that is there, or "
                              "PACKAGE FILE")
    elif len(plain) == 2:
        file = packages.launch_file(*plain)
    else:
        raise LaunchError(f"launch: found {len(plain)} names, allowed FILE or PACKAGE FILE and then "
                          "NAME:=VALUE")
    return _xml_of(file), given


def _xml_of(file: Path) -> Path:
    """The plain data behind NAME.launch.py, which includes NAME.launch.xml."""
    if file.suffix != ".py":
        return file
    data = file.with_suffix(".xml")
    if not data.is_file():
        raise LaunchError(f"launch file: found {file.name!r} without {data.name} beside it, "
                          "allowed XML launch files")
    return data

# SPDX-License-Identifier: BSD-3-Clause
"""Launch files to plans, and what is said about wrong ones."""

import pytest

from ros_launch.errors import LaunchError
from ros_launch.packages import Packages
from ros_launch.reader import Reader, find
from ros_launch.test.installed import Installed


@pytest.fixture
def installed(tmp_path):
    place = Installed(tmp_path)
    place.package("world", talker="", listener="")
    return place


def read(installed, text, given=None, environment=None, **options):
    packages = Packages([installed.prefix])
    file = installed.launch_file(text)
    return Reader(packages, given or {}, environment or {}, **options).read(file)


def refusal(installed, text, given=None):
    with pytest.raises(LaunchError) as why:
        read(installed, text, given)
    assert "\n" not in str(why.value)
    return str(why.value)


def test_a_node_has_all_that_the_file_says(installed):
    parameters = installed.prefix / "p.yaml"
    parameters.write_text("/**: {ros__parameters: {a: 1}}")
    node, = read(installed, f"""<launch>
      <node pkg="world" exec="talker" name="t" namespace="air" args="-v 'two words'" output="screen">
        <param from="{parameters}"/>
        <param name="rate" value="2.5"/>
        <remap from="a" to="b"/>
        <env name="X" value="1"/>
      </node></launch>""").nodes
    assert node.command == [str(installed.prefix / "lib/world/talker"), "-v", "two words"]
    assert (node.full_name, node.name, node.namespace) == ("/air/t", "air/t", "air")
    assert node.parameters == [parameters, {"rate": 2.5}]
    assert node.remappings == [("a", "b")]
    assert node.environment == {"X": "1"}
    assert node.where.endswith(":2")


def test_remappings_and_parameters_of_a_group_hold_for_its_nodes_only(installed):
    within, after = read(installed, """<launch>
      <group><set_remap from="/clock" to="/steps"/><set_parameter name="rate" value="2.5"/>
        <set_parameter name="text" value="&quot;''&quot;"/>
        <node pkg="world" exec="talker" name="within" on_exit="shutdown"><remap from="a" to="b"/></node></group>
      <node pkg="world" exec="talker" name="after"/></launch>""").nodes
    assert within.remappings == [("/clock", "/steps"), ("a", "b")]
    assert within.parameters == ["rate:=2.5", "text:=''"]
    assert not after.remappings and not after.parameters


@pytest.mark.parametrize("text, value", [
    ("1", 1), ("1.0", 1.0), ("true", True), ("word", "word"), ("'14520'", "14520"), ("[1, 2]", [1, 2]),
    ("[1, a]", "[1, a]"), ("", ""), ("{a: 1}", "{a: 1}")])
def test_values_have_the_type_that_yaml_sees(installed, text, value):
    node, = read(installed, f"""<launch><node pkg="world" exec="talker">
      <param name="p" value="{text}"/></node></launch>""").nodes
    assert node.parameters == [{"p": value}]
    assert type(node.parameters[0]["p"]) is type(value)


def test_arguments_come_from_the_command_line_or_their_default(installed):
    text = """<launch><arg name="n" default="x"/><arg name="m" default="$(var n)y"/>
      <node pkg="world" exec="talker" name="$(var m)"/></launch>"""
    assert read(installed, text).nodes[0].node_name == "xy"
    assert read(installed, text, {"n": "a"}).nodes[0].node_name == "ay"
    assert read(installed, text, {"m": "b"}).nodes[0].node_name == "b"


@pytest.mark.parametrize("condition, starts", [
    ('if="true"', True), ('if="0"', False), ('unless="False"', True), ('unless="1"', False),
    ('if="$(var flag)"', True), ('if="$(not $(var flag))"', False),
    ('if="$(and $(var flag) $(or false true))"', True),
    ("""if="$(eval '&quot;$(var flag)&quot; == &quot;true&quot; and 2 * 3 > 5')" """, True)])
def test_conditions(installed, condition, starts):
    plan = read(installed, f"""<launch><arg name="flag" default="true"/>
      <node pkg="world" exec="talker" {condition}/></launch>""")
    assert bool(plan.nodes) == starts


@pytest.mark.parametrize("text, words", [
    ("$(var two)", ["one two"]), ("-d $(var two)", ["-d", "one two"]), ("$(var two) $(var two)", ["one two", "one two"]),
    ("-p=$(var two)/x y", ["-p=one two/x", "y"]), ("a $(var none) b", ["a", "", "b"]), ("$(var none)", [""]), ("", [""]),
    ("  $(var two) ", ["", "one two"]), ("a 'b c' d$(var two)", ["a", "b c", "done two"]), ("$(var quote)", ["it's"]),
    ("$(env B 'two words')\\ x", ["two words", "x"]), ("\\$(var two)", ["$(var", "two)"])])
def test_only_what_the_file_says_is_split_into_arguments(installed, text, words):
    """The words are those that launch 3.4.3 makes of the same texts."""
    node, = read(installed, f"""<launch><let name="two" value="one two"/><let name="none" value=""/><let name="quote" value="it's"/>
      <node pkg="world" exec="talker" args="{text}"/></launch>""").nodes
    assert node.command[1:] == words


def test_a_group_gives_a_namespace_and_takes_it_back(installed):
    plan = read(installed, """<launch><let name="v" value="out"/>
      <group><push-ros-namespace namespace="one"/><let name="v" value="in"/>
        <group><push-ros-namespace namespace="two"/><node pkg="world" exec="talker" name="a"/></group>
        <node pkg="world" exec="talker" name="b_$(var v)"/>
        <node pkg="world" exec="talker" name="c" namespace="/else"/>
      </group>
      <node pkg="world" exec="talker" name="d_$(var v)"/></launch>""")
    assert [node.full_name for node in plan.nodes] == ["/one/two/a", "/one/b_in", "/else/c", "/d_out"]


def test_an_included_file_gets_arguments_and_finds_its_own_folder(installed):
    share = installed.package("world", talker="")
    (share / "launch/inner.launch.xml").write_text("""<launch><arg name="who"/>
      <node pkg="world" exec="talker" name="$(var who)" args="$(dirname)"/></launch>""")
    plan = read(installed, """<launch>
      <include file="$(find-pkg-share world)/launch/inner.launch.xml"><arg name="who" value="me"/></include>
      </launch>""")
    assert plan.nodes[0].node_name == "me"
    assert plan.nodes[0].command[1] == str((share / "launch").resolve())
    assert not plan.arguments  # it has its value: nothing for the command line


def test_arguments_of_included_files_can_be_given_from_outside(installed):
    (installed.prefix / "inner.xml").write_text("""<launch><arg name="who" default="x"/>
      <node pkg="world" exec="talker" name="$(var who)"/></launch>""")
    text = '<launch><include file="$(dirname)/inner.xml"/></launch>'
    assert read(installed, text, {"who": "me"}).nodes[0].node_name == "me"


def test_variables_of_the_environment(installed):
    plan = read(installed, """<launch><node pkg="world" exec="talker" name="$(env A)_$(env B none)"/>
      </launch>""", environment={"A": "a"})
    assert plan.nodes[0].node_name == "a_none"


def test_two_nodes_of_one_name_have_two_labels(installed):
    node = '<node pkg="world" exec="talker"/>'
    assert [n.name for n in read(installed, f"<launch>{node}{node}</launch>").nodes] == \
        ["talker", "talker-2"]


@pytest.mark.parametrize("text, line, words", [
    ('<launch><node pkg="wrld" exec="talker"/></launch>', 1, ["'wrld'", "such as world"]),
    ('<launch>\n<node pkg="world" exec="tlker"/></launch>', 2, ["'tlker'", "one of listener, talker"]),
    ('<launch><node pkg="world"/></launch>', 1, ["'exec'"]),
    ('<launch><node pkg="world" exec="talker" nmae="x"/></launch>', 1, ["'nmae'", "name"]),
    ('<launch><node pkg="world" exec="talker" name="a b"/></launch>', 1, ["'a b'"]),
    ("<launch>\n\n<nod/></launch>", 3, ["<nod>", "<node>"]),
    ("<launch>\n<arg name='a'></launch>", 2, ["mismatched tag"]),
    ("<lunch/>", 1, ["<lunch>", "<launch>"]),
    ("<launch>words</launch>", 1, ["'words'"]),
    ("<launch><arg name='a'/></launch>", 1, ["argument a", "a:=VALUE"]),
    ("<launch><let name='a' value='$(var b)'/></launch>", 1, ["'b'", "nothing"]),
    ("<launch><let name='a' value='$(vra b)'/></launch>", 1, ["$(vra)", "var"]),
    ("<launch><let name='a' value='$(var'/></launch>", 1, ["'$(var'"]),
    ("<launch><let name='a' value='$(eval &quot;1 +&quot;)'/></launch>", 1, ["'1 +'"]),
    ("<launch><let name='a' value='$(eval 1 + 2)'/></launch>", 1, ["$(eval) with 3 arguments", "allowed 1"]),
    ("<launch><let name='a' value='$(eval &quot;int(2)&quot;)'/></launch>", 1, ["int(2)", "numbers"]),
    ("<launch><let name='a' value='$(eval (1+2))'/></launch>", 1, ["one blank before each argument"]),
    ("<launch><let name='a' value='$(env  A b)'/></launch>", 1, ["one blank before each argument"]),
    ("<launch><let name='a' value='$( env A b)'/></launch>", 1, ["after $("]),
    ("<launch><let name='a' value='$(env A b&quot;c&quot;)'/></launch>", 1, ["quotes around a whole argument"]),
    ("<launch><let name='a' value='$(env A &quot;b)'/></launch>", 1, ['two " around']),
    ("<launch>\n<node pkg='world' exec='talker' args='-d &quot;$(env A b)&quot;'/></launch>", 2, ["args of <node>", "before the next $("]),
    ("<launch><let name='a' value='$(eval &quot;&apos;a&apos; * 99999&quot;)'/></launch>", 1,
     ["product of texts"]),
    ("<launch><let name='a' value='x' if='maybe'/></launch>", 1, ["'maybe'", "true"]),
    ("<launch><let name='a' value='x' if='1' unless='1'/></launch>", 1, ["if and unless"]),
    ("<launch><include file='none.xml'/></launch>", 1, ["'none.xml'"]),
    ('<launch><node pkg="world" exec="talker"><param from="no.yaml"/></node></launch>', 1,
     ["'no.yaml'"]),
    ('<launch><node pkg="world" exec="talker"><remap from="" to="b"/></node></launch>', 1, ["empty"]),
    ('<launch><set_remap from="a" to=""/></launch>', 1, ["<set_remap>", "empty"]),
    ("""<launch><set_parameter name="a" value="''"/></launch>""", 1, ["<set_parameter>", "nothing", "quotes in quotes"]),
    ('<launch><node pkg="world" exec="talker" on_exit="respawn"/></launch>', 1, ["on_exit", "'respawn'", "shutdown"]),
])
def test_a_mistake_is_one_line_with_its_place(installed, text, line, words):
    said = refusal(installed, text)
    assert f"it.launch.xml:{line}: " in said
    for word in words:
        assert word in said


def test_an_argument_must_be_one_of_its_choices(installed):
    text = """<launch><arg name="mode" default="a"><choice value="a"/><choice value="b"/></arg></launch>"""
    assert read(installed, text, {"mode": "b"})
    assert "'c', allowed one of a, b" in refusal(installed, text, {"mode": "c"})


def test_an_argument_that_nobody_declares_is_refused(installed):
    said = refusal(installed, '<launch><arg name="rate" default="1"/></launch>', {"rte": "2"})
    assert "'rte', allowed one of rate" in said


def test_an_include_may_only_be_given_what_it_declares(installed):
    (installed.prefix / "inner.xml").write_text('<launch><arg name="who" default="x"/></launch>')
    said = refusal(installed, """<launch><include file="$(dirname)/inner.xml">
      <arg name="whom" value="1"/></include></launch>""")
    assert "'whom', allowed one of who" in said and ":2: " in said


def test_a_file_that_includes_itself_is_refused(installed):
    assert "inside each other" in refusal(
        installed, '<launch><include file="$(dirname)/it.launch.xml"/></launch>')


@pytest.mark.parametrize("text", ["a: 1", "- 1", "n: {ros__parameters: 3}", "a: [", ""])
def test_a_parameter_file_must_be_one(installed, text):
    (installed.prefix / "p.yaml").write_text(text)
    assert "p.yaml:1: " in refusal(installed, """<launch><node pkg="world" exec="talker">
      <param from="$(dirname)/p.yaml"/></node></launch>""")


def test_entities_are_refused(installed):
    assert "ENTITY" in refusal(
        installed, '<!DOCTYPE launch [<!ENTITY a "aaaa">]><launch><arg name="&a;"/></launch>')


def test_show_reads_past_missing_values(installed):
    plan = read(installed, '<launch><arg name="a"/><node pkg="none" exec="$(var a)"/></launch>',
                lenient=True)
    assert plan.arguments["a"].default is None


def test_a_python_file_stands_for_the_xml_beside_it(installed):
    xml = installed.launch_file("<launch/>")
    script = xml.with_suffix(".py")
    script.touch()
    packages = Packages([installed.prefix])
    assert find([str(script), "a:=b"], packages) == (xml, {"a": "b"})
    xml.unlink()
    with pytest.raises(LaunchError, match="beside it"):
        find([str(script)], packages)


def test_launch_files_of_a_package(installed):
    share = installed.package("world")
    (share / "launch/x.launch.xml").write_text("<launch/>")
    packages = Packages([installed.prefix])
    assert find(["world", "x.launch.xml"], packages)[0] == share / "launch/x.launch.xml"
    with pytest.raises(LaunchError, match="'y', allowed one of x.launch.xml"):
        find(["world", "y"], packages)
    with pytest.raises(LaunchError, match="such as world"):
        find(["wrld", "y"], packages)
    with pytest.raises(LaunchError, match="found 0 names"):
        find([], packages)

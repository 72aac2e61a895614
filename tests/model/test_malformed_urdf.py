"""Malformed URDFs: each one InputError that names what is wrong and where, and nothing else."""

from __future__ import annotations

import contextlib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spacerobot.model.library import load
from spacerobot.model.reading import MAX_BYTES, parse
from spacerobot.support.errors import InputError

GOOD = """<?xml version="1.0"?>
<robot name="good">
  <link name="base"/>
  <link name="arm">
    <inertial><origin xyz="0 0 0.1" rpy="0 0 0"/><mass value="2"/>
      <inertia ixx="0.1" iyy="0.1" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><cylinder radius="0.1" length="0.2"/></geometry></visual>
    <collision><geometry><box size="0.1 0.1 0.2"/></geometry></collision>
  </link>
  <link name="tip"/>
  <joint name="turn" type="revolute">
    <parent link="base"/><child link="arm"/><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="10" velocity="2"/><dynamics damping="0.1" friction="0"/>
  </joint>
  <joint name="end" type="fixed"><parent link="arm"/><child link="tip"/></joint>
  <transmission name="t"><joint name="turn"/><actuator name="m"><mechanicalReduction>50</mechanicalReduction>
    <d:rotor_inertia xmlns:d="http://drake.mit.edu" value="1e-4"/></actuator></transmission>
</robot>
"""


def test_the_good_one_is_good() -> None:
    robot = load(GOOD)
    assert robot.chain == ("turn",)
    assert robot.model.armature == pytest.approx([0.25])


BOX = '<box size="0.1 0.1 0.2"/>'
HEAD = '<?xml version="1.0"?>'
END = '<joint name="end" type="fixed"><parent link="arm"/><child link="tip"/></joint>'
LEAVES = "mesh of link 'arm' leaves its folder"

EDITS = {
    # numbers
    "mass NaN": ('mass value="2"', 'mass value="nan"', "line 5: mass of link 'arm'"),
    "mass infinite": ('mass value="2"', 'mass value="inf"', "mass of link 'arm'"),
    "mass overflows": ('mass value="2"', 'mass value="1e999"', "mass of link 'arm'"),
    "mass huge": ('mass value="2"', 'mass value="1e12"', "out of range"),
    "mass negative": ('mass value="2"', 'mass value="-2"', "mass of link 'arm' is negative"),
    "mass is a word": ('mass value="2"', 'mass value="two"', "mass of link 'arm'"),
    "mass with a comma": ('mass value="2"', 'mass value="2,5"', "mass of link 'arm'"),
    "mass in Python's spelling": ('mass value="2"', 'mass value="2_0"', "mass of link 'arm'"),
    "mass in hexadecimal": ('mass value="2"', 'mass value="0x2"', "mass of link 'arm'"),
    "mass empty": ('mass value="2"', 'mass value=""', "mass of link 'arm'"),
    "mass without value": ('<mass value="2"/>', "<mass/>", "mass of link 'arm' is missing"),
    "no mass": ('<mass value="2"/>', "", "mass of link 'arm' is missing"),
    "mass zero behind a joint": ('mass value="2"', 'mass value="0"', "link 'arm'.*not positive"),
    "no inertia": (
        '<inertia ixx="0.1" iyy="0.1" izz="0.02" ixy="0" ixz="0" iyz="0"/>', "", "inertia of link 'arm' is missing",
    ),
    "inertia entry missing": (' iyz="0"', "", "iyz of link 'arm' is missing"),
    "inertia NaN": ('ixx="0.1"', 'ixx="NaN"', "ixx of link 'arm'"),
    "inertia negative": ('izz="0.02"', 'izz="-0.02"', "link 'arm'.*positive definite"),
    "inertia zero": ('ixx="0.1" iyy="0.1" izz="0.02"', 'ixx="0" iyy="0" izz="0"', "link 'arm'.*positive definite"),
    "inertia not definite": ('ixy="0"', 'ixy="0.2"', "link 'arm'.*positive definite"),
    "triangle inequality": ('izz="0.02"', 'izz="0.3"', "link 'arm'.*triangle"),
    "two inertials": ("<inertial>", "<inertial/><inertial>", "two inertials"),
    "origin too short": ('xyz="0 0 0.5"', 'xyz="0 0"', "origin xyz of joint 'turn' needs 3 numbers"),
    "origin too long": ('xyz="0 0 0.5"', 'xyz="0 0 0.5 1"', "origin xyz of joint 'turn'"),
    "origin NaN": ('xyz="0 0 0.5"', 'xyz="0 nan 0.5"', "origin xyz of joint 'turn'"),
    "origin empty": ('xyz="0 0 0.5"', 'xyz=""', "origin xyz of joint 'turn'"),
    "rpy infinite": ('rpy="0 0 0"', 'rpy="0 0 -inf"', "origin rpy of link 'arm'"),
    "axis zero": ('axis xyz="0 1 0"', 'axis xyz="0 0 0"', "axis of joint 'turn' is zero"),
    "axis short": ('axis xyz="0 1 0"', 'axis xyz="1"', "axis of joint 'turn'"),
    "axis empty": ('axis xyz="0 1 0"', "axis", "axis of joint 'turn'"),
    "radius negative": ('radius="0.1"', 'radius="-0.1"', "radius of cylinder of link 'arm' is negative"),
    "length missing": (' length="0.2"', "", "length of cylinder of link 'arm'"),
    "box with two edges": ('size="0.1 0.1 0.2"', 'size="0.1 0.1"', "size of box of link 'arm'"),
    "no geometry": ('<geometry><box size="0.1 0.1 0.2"/></geometry>', "", "collision of link 'arm' has no geometry"),
    "empty geometry": (BOX, "", "geometry of link 'arm' is not one shape"),
    "two shapes in one": (BOX, BOX + BOX, "geometry of link 'arm' is not one shape"),
    "unknown shape": (BOX, "<torus/>", "unknown shape.*torus"),
    # limits and dynamics
    "no limit": ('<limit lower="-1" upper="1" effort="10" velocity="2"/>', "", "joint 'turn' is revolute and has no"),
    "limits swapped": ('lower="-1" upper="1"', 'lower="1" upper="-1"', "limits of joint 'turn' are swapped"),
    "limit NaN": ('lower="-1"', 'lower="nan"', "lower limit of joint 'turn'"),
    "limit infinite": ('upper="1"', 'upper="inf"', "upper limit of joint 'turn'"),
    "effort missing": (' effort="10"', "", "effort limit of joint 'turn' is missing"),
    "effort negative": ('effort="10"', 'effort="-10"', "effort limit of joint 'turn' is negative"),
    "velocity is a word": ('velocity="2"', 'velocity="fast"', "velocity limit of joint 'turn'"),
    "damping negative": ('damping="0.1"', 'damping="-0.1"', "damping of joint 'turn' is negative"),
    "dynamics without content": ('damping="0.1" friction="0"', "", "neither damping nor friction"),
    "friction NaN": ('friction="0"', 'friction="nan"', "friction of joint 'turn'"),
    # rotors
    "rotor NaN": ('value="1e-4"', 'value="nan"', "rotor inertia of joint 'turn'"),
    "rotor negative": ('value="1e-4"', 'value="-1e-4"', "rotor inertia of joint 'turn' is negative"),
    "rotor without value": (' value="1e-4"', "", "rotor inertia of joint 'turn' is missing"),
    "rotor of a stranger": ('"t"><joint name="turn"', '"t"><joint name="trn"', "did you mean 'turn'"),
    "gear is a word": (">50<", ">fifty<", "mechanical reduction of joint 'turn'"),
    # names and types
    "two links of a name": ('link name="tip"', 'link name="base"', "two links have the same name"),
    "two joints of a name": ('joint name="end"', 'joint name="turn"', "two joints have the same name"),
    "link without name": ('<link name="tip"/>', "<link/>", "link has no name"),
    "link with a blank name": ('<link name="tip"/>', '<link name=" "/>', "link has no name"),
    "link with a line break": ('<link name="tip"/>', '<link name="t&#10;ip"/>', "unprintable"),
    "joint without name": ('joint name="end" ', "joint ", "joint has no name"),
    "unknown joint type": ('type="revolute"', 'type="screw"', "joint 'turn' has an unknown type.*prismatic"),
    "no joint type": (' type="revolute"', "", "joint 'turn' has an unknown type"),
    # tree
    "unknown parent": ('parent link="base"', 'parent link="bse"', "parent link of joint 'turn'.*did you mean 'base'"),
    "unknown child": ('child link="tip"', 'child link="tipp"', "child link of joint 'end'.*did you mean 'tip'"),
    "no parent": ('<parent link="base"/>', "", "joint 'turn' has no parent link"),
    "no child": ('<child link="tip"/>', "", "joint 'end' has no child link"),
    "two parents": ('"arm"/><child link="tip"', '"base"/><child link="arm"', "link 'arm' has two parents"),
    "its own parent": ('parent link="arm"/><child link="tip"', 'parent link="tip"/><child link="tip"', "loop"),
    "loop": ('parent link="base"', 'parent link="tip"', "loop"),
    "two roots": (END, "", "more than one root.*tip"),
    # meshes
    "mesh climbs out": (BOX, '<mesh filename="../../etc/passwd"/>', LEAVES),
    "mesh climbs out of a package": (BOX, '<mesh filename="package://a/../../b.stl"/>', LEAVES),
    "mesh climbs out, encoded": (BOX, '<mesh filename="package://a/%2e%2e/%2e%2e/b.stl"/>', LEAVES),
    "mesh absolute": (BOX, '<mesh filename="/etc/passwd"/>', "absolute path outside"),
    "mesh file://": (BOX, '<mesh filename="file:///etc/passwd"/>', "absolute path outside"),
    "mesh from the net": (BOX, '<mesh filename="http://example.com/a.stl"/>', "scheme http"),
    "mesh with backslashes": (BOX, '<mesh filename="..\\..\\a.stl"/>', "strange characters"),
    "mesh without file": (BOX, "<mesh/>", "mesh of link 'arm' has no file name"),
    "mesh scale": (BOX, '<mesh filename="a.stl" scale="1 1"/>', "scale of mesh of link 'arm'"),
    # document
    "DOCTYPE": (HEAD, '<?xml version="1.0"?><!DOCTYPE robot>', "line 1: .*document type"),
    "entity bomb": (
        HEAD, '<!DOCTYPE r [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;&a;">]>', "document type",
    ),
    "external entity": (
        HEAD, '<?xml version="1.0"?>\n<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/passwd">]>', "line 2",
    ),
    "lower-case doctype": (HEAD, "<!doctype robot>", "document type"),
    "undeclared entity": ('mass value="2"', 'mass value="&two;"', "not well-formed"),
    "other encoding": (HEAD, '<?xml version="1.0" encoding="utf-16"?>', "encoding"),
    "unclosed": ("</robot>", "", "not well-formed"),
    "undeclared prefix": ('<link name="base"/>', '<xacro:link name="base"/>', "not well-formed"),
    "other root": ("robot", "sdf", "not a URDF"),
    "NUL": ('name="good"', 'name="go\0od"', "NUL"),
    "no links": (GOOD[GOOD.index("<robot") :], "<robot name='empty'/>", "no link"),
    "default namespace": ("<robot ", '<robot xmlns="http://example.com/robot" ', "not a URDF"),
}  # fmt: skip


@pytest.mark.parametrize("name", EDITS)
def test_each_fault_is_one_clear_error(name: str) -> None:
    old, new, message = EDITS[name]
    assert old in GOOD
    with pytest.raises(InputError, match=f"(?s){message}") as caught:
        load(GOOD.replace(old, new))
    assert caught.value.exit_code == 2
    assert "\n" not in str(caught.value)


def test_errors_say_the_line() -> None:
    with pytest.raises(InputError, match=r"URDF text, line 5: mass of link 'arm' is negative"):
        load(GOOD.replace('mass value="2"', 'mass value="-2"'))


@pytest.mark.parametrize(
    "raw",
    [
        GOOD.encode("utf-16"),
        b"\xff\xfe<robot/>",
        GOOD.replace("good", "b\u00e4r").encode("latin-1"),
        b"",
        b"<",
        b"<robot><link name='a'/>" + b" " * MAX_BYTES + b"</robot>",
        b"<robot>" + b"<a>" * 5000 + b"</a>" * 5000 + b"</robot>",
    ],
)
def test_bytes_that_are_no_urdf(raw: bytes, tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    path.write_bytes(raw)
    with pytest.raises(InputError, match=r"robot\.urdf"):
        load(path)


def test_too_many_links() -> None:
    links = "".join(f'<link name="l{i}"/>' for i in range(1500))
    joints = "".join(
        f'<joint name="j{i}" type="fixed"><parent link="l{i}"/><child link="l{i + 1}"/></joint>' for i in range(1499)
    )
    with pytest.raises(InputError, match="too many links"):
        load(f"<robot name='long'>{links}{joints}</robot>")


def test_an_element_on_the_way_is_not_read_as_more_than_it_is() -> None:
    root = parse("<robot name='r'><!-- <link name='ghost'/> --><?xml-stylesheet href='x'?><link name='a'/></robot>")
    assert [link.get("name") for link in root.findall("link")] == ["a"]


@settings(max_examples=200, derandomize=True, deadline=None)
@given(data=st.data())
def test_damaged_text_is_read_or_refused(data: st.DataObject) -> None:
    """Cut, doubled or overwritten anywhere: a robot or an InputError, nothing else."""
    start = data.draw(st.integers(0, len(GOOD) - 1))
    end = data.draw(st.integers(start, min(len(GOOD), start + 40)))
    patch = data.draw(st.sampled_from(["", '"', "<", ">", "/>", "nan", "-", "1e308", "&", "\0", GOOD[start:end] * 2]))
    text = GOOD[:start] + patch + GOOD[end:]
    with contextlib.suppress(InputError):
        robot = load(text if text.lstrip().startswith("<") else "<" + text)
        assert robot.configuration().shape == (robot.model.nq,)

"""URDF files no arm can be made of: the error names the file, the joint or link, and what to do."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from rotatum.errors import DeviceError, ExtraError
from rotatum.models.robot.packaged import read_urdf, urdf_names
from rotatum.models.robot.urdf import UrdfRobot
from tests.models.robot_cases import planar_2r

PLAIN = """<robot name="two">
  <link name="base"/>
  <link name="upper"><inertial><origin xyz="0 0 -0.2"/><mass value="2"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="lower"><inertial><origin xyz="0 0 -0.1"/><mass value="1"/>
    <inertia ixx="0.02" iyy="0.02" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tool"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="10" velocity="5"/></joint>
  <joint name="elbow" type="continuous"><origin xyz="0 0 -0.4"/><parent link="upper"/>
    <child link="lower"/><axis xyz="0 1 0"/></joint>
  <joint name="mount" type="fixed"><parent link="lower"/><child link="tool"/></joint>
</robot>"""

UPPER = '<link name="upper"><inertial><origin xyz="0 0 -0.2"/><mass value="2"/>'
SECOND = """<link name="wing"><inertial><mass value="1"/>
  <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="flap" type="revolute"><parent link="upper"/><child link="wing"/></joint></robot>"""

_REFUSED = [
    ("<robot", "<robot", "<robot><", r"two\.urdf: is not valid XML"),
    ("robot", "<robot name", "<sdf name", "is not valid XML"),
    ("root", PLAIN, "<sdf/>", r"outermost element must be <robot>, got 'sdf'"),
    ("xacro", '<link name="tool"/>', '<link name="tool"/><xacro.arm/>', "is a xacro file"),
    ("mimic", '"0 0 -0.4"/>', '"0 0 -0.4"/><mimic joint="shoulder"/>',
     r'two\.urdf: joint "elbow" mimics "shoulder".*Make it fixed'),
    ("floating", 'name="shoulder" type="revolute"', 'name="shoulder" type="floating"',
     'joint "shoulder" is floating. Fix it: the base of the arm must be fixed'),
    ("planar", 'name="shoulder" type="revolute"', 'name="shoulder" type="planar"',
     'joint "shoulder" is planar. Fix it'),
    ("kind", 'name="shoulder" type="revolute"', 'name="shoulder" type="hinge"',
     "joint \"shoulder\" has an unknown type, got 'hinge'; allowed: revolute, continuous"),
    ("prismatic", 'name="elbow" type="continuous"', 'name="elbow" type="prismatic"',
     'joint "elbow" is prismatic; the joints of an arm turn. Leave it out'),
    ("no-inertial", PLAIN[PLAIN.index("<inertial>") : PLAIN.index("</link>")], "",
     'link "upper" moves with joint "shoulder" and has no <inertial>'),
    ("no-mass", '<mass value="2"/>', "", 'link "upper": <inertial> has no <mass>'),
    ("zero", '<mass value="2"/>', '<mass value="0"/>', 'mass must be greater than 0, got 0.0'),
    ("negative", '<mass value="2"/>', '<mass value="-2"/>', "greater than 0, got -2.0"),
    ("text", '<mass value="2"/>', '<mass value="heavy"/>',
     "link \"upper\": <mass> value must be 1 number, got 'heavy'"),
    ("nan", '<mass value="2"/>', '<mass value="nan"/>', "must be 1 number, got 'nan'"),
    ("flat", 'izz="0.01" ixy="0"', 'izz="0" ixy="0"',
     r'link "upper": inertia must be positive about every axis, got \[0\.0, 0\.1, 0\.1\]'),
    ("product", 'ixy="0"', 'ixy="0.2"', r"positive about every axis, got \[-0\.1, 0\.01, 0\.3\]"),
    ("centre", 'xyz="0 0 -0.2"', 'xyz="0 0"', "<inertial> <origin> xyz must be 3 numbers"),
    ("origin", 'xyz="0 0 -0.4"', 'xyz="0 0 far"', 'joint "elbow": <origin> xyz must be 3 numbers'),
    ("axis", '<axis xyz="0 1 0"/>', '<axis xyz="0 0 0"/>', 'joint "shoulder" has no axis'),
    ("parent", 'parent link="upper"', 'parent link="uper"',
     "joint \"elbow\" has no parent among the links, got 'uper'"),
    ("twice", 'link name="lower"', 'link name="upper"', 'joint "elbow" has no child'),
    ("names", 'joint name="mount"', 'joint name="elbow"', "two joints have the same name"),
    ("links", '<link name="tool"/>', '<link name="tool"/><link name="tool"/>',
     "two links have the same name, got 'tool'"),
    ("nameless", 'joint name="mount"', "joint", "a <joint> has no name"),
    ("island", '<link name="tool"/>', '<link name="tool"/><link name="lost"/>',
     r"one tree with one base, got \['base', 'lost'\]"),
    ("two-parents", '<child link="tool"/>', '<child link="upper"/>', 'hangs on two joints'),
    ("branches", "</robot>", SECOND, 'joints "elbow" and "flap" are on different branches'),
]  # fmt: skip


@pytest.mark.parametrize(
    ("old", "new", "told"), [r[1:] for r in _REFUSED], ids=[r[0] for r in _REFUSED]
)
def test_what_is_refused(old: str, new: str, told: str) -> None:
    assert old in PLAIN
    with pytest.raises(DeviceError, match=told) as caught:
        UrdfRobot(PLAIN.replace(old, new, 1), source="two.urdf")
    assert caught.value.where == "two.urdf"


def test_a_loop_is_refused() -> None:
    text = PLAIN.replace('<parent link="base"/><child link="upper"/>',
                         '<parent link="tool"/><child link="upper"/>')  # fmt: skip
    with pytest.raises(DeviceError, match=r"joints form a loop, got \['shoulder', 'elbow', "):
        UrdfRobot(text)


def test_joints_that_are_asked_for() -> None:
    with pytest.raises(DeviceError, match=r"no such joint, got 'sholder'.*mean \"shoulder\""):
        UrdfRobot(PLAIN, ("sholder", "elbow"))
    with pytest.raises(DeviceError, match=r"in the order along the arm.*allowed: shoulder, elbow"):
        UrdfRobot(PLAIN, ("elbow", "shoulder"))
    with pytest.raises(DeviceError, match="a joint is named twice"):
        UrdfRobot(PLAIN, ("elbow", "elbow"))
    with pytest.raises(DeviceError, match='joint "mount" is fixed; the joints of an arm turn'):
        UrdfRobot(PLAIN, ("shoulder", "elbow", "mount"))
    with pytest.raises(DeviceError, match="no joint of the URDF turns"):
        UrdfRobot(PLAIN, ())
    with pytest.raises(DeviceError, match=r"no such joint to lock, got 'elbo'.*\"elbow\""):
        UrdfRobot(PLAIN, ("shoulder",), {"elbo": 1.0})
    with pytest.raises(DeviceError, match="a joint of the arm cannot be locked, got 'elbow'"):
        UrdfRobot(PLAIN, locked={"elbow": 1.0})
    with pytest.raises(DeviceError, match='locked joint "elbow" must be a number, got nan'):
        UrdfRobot(PLAIN, ("shoulder",), {"elbow": float("nan")})
    with pytest.raises(DeviceError, match="gravity must be at least 0, got -1"):
        UrdfRobot(PLAIN, gravity=-1.0)


def test_what_is_taken() -> None:
    # A branch that is locked, a tool without mass, a continuous joint, meshes, odd names.
    text = PLAIN.replace("</robot>", SECOND).replace('name="tool"', 'name="elbow"')
    text = text.replace('<child link="tool"/>', '<child link="elbow"/>')
    text = text.replace('<link name="base"/>', '<link name="base"><visual><geometry><mesh '
                        'filename="package://none.stl"/></geometry></visual></link>')  # fmt: skip
    robot = UrdfRobot(text, ("shoulder", "elbow"))
    assert robot.names == ("shoulder", "elbow")
    # The frame is the link of that name, not the joint.
    assert robot.pose("elbow", np.zeros(2)).position == pytest.approx([0.0, 0.0, -0.4])
    # 0.1 + 2 0.04, 0.02 + 0.25 of the second, and the wing's 0.1 at the first joint.
    assert robot.mass(np.zeros(2))[0, 0] == pytest.approx(0.18 + 0.27 + 0.1, rel=1e-12)
    # Two turns of a continuous joint are none.
    still, turned = np.array([0.1, 0.2]), np.array([0.1, 0.2 + 4 * np.pi])
    np.testing.assert_allclose(robot.mass(turned), robot.mass(still), rtol=1e-13)


def test_an_axis_of_any_length() -> None:
    long = UrdfRobot(PLAIN.replace('xyz="0 1 0"', 'xyz="0 2 0"'))
    q = np.array([0.3, 0.4])
    np.testing.assert_allclose(long.mass(q), UrdfRobot(PLAIN).mass(q), rtol=1e-14)


@pytest.mark.parametrize("robot", [planar_2r(), UrdfRobot(PLAIN)], ids=["planar", "urdf"])
def test_payloads_that_cannot_be(robot: UrdfRobot) -> None:
    frame = robot.frames[1]
    for mass in (0.0, -1.0, float("nan")):
        with pytest.raises(DeviceError, match=r"payload: mass must be greater than 0, got"):
            robot.with_payload(frame, mass)
    with pytest.raises(DeviceError, match="position must be three finite numbers"):
        robot.with_payload(frame, 1.0, (0.0, 0.0))
    for rows, told in (
        ([[1.0]], "three rows of three"),
        ([[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "must be symmetric"),
        (np.diag([1.0, -1.0, 1.0]).tolist(), "must not be negative about any axis"),
    ):
        with pytest.raises(DeviceError, match=told):
            robot.with_payload(frame, 1.0, (0.0, 0.0, 0.0), rows)


def test_without_pinocchio_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pinocchio", None)
    with pytest.raises(
        ExtraError, match=r'need pinocchio.*pip install "rotatum\[urdf\]"'
    ) as caught:
        UrdfRobot(PLAIN)
    assert caught.value.extra == "urdf"


def test_files(tmp_path: Path) -> None:
    assert urdf_names() == ("manutec-r3", "planar-2r", "seven-axis")
    (tmp_path / "two.urdf").write_text(PLAIN)
    assert read_urdf("two.urdf", tmp_path) == PLAIN
    with pytest.raises(DeviceError, match=r"no such URDF file.*mean \"seven-axis\""):
        read_urdf("seven-axes", tmp_path)
    (tmp_path / "bytes.urdf").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(DeviceError, match="not a text file in UTF-8"):
        read_urdf("bytes.urdf", tmp_path)
    with pytest.raises(DeviceError, match="cannot be read"):
        read_urdf(".", tmp_path)

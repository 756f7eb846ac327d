"""Arms of our URDF files built once more in MuJoCo, with a rotor and a spring at every joint.

Each joint is one body on two hinges with one axis: the first turns by the motor's angle theta and
carries the reflected rotor inertia as armature, the second by q - theta and carries the spring.
An armature adds nothing but B theta'' at its own joint: no gyroscopic coupling. The files are read
here with xml.etree, so that nothing is shared with the code under test.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
GRAVITY = (0.0, 0.0, -9.81)


@dataclass(frozen=True)
class Elastic:
    """What an elastic joint adds: tau = stiffness phi + cubic phi^3 + damping phi', and rotor B."""

    rotor: float
    stiffness: float
    cubic: float = 0.0
    damping: float = 0.0


@dataclass(frozen=True)
class Payload:
    """A body fixed to a frame (a link of the URDF); its inertia is about its centre of mass."""

    frame: str
    mass: float
    position: Sequence[float] = (0.0, 0.0, 0.0)
    inertia: ArrayLike = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@dataclass(frozen=True)
class Arm:
    """URDF text, and what is done to it."""

    urdf: str
    locked: Mapping[str, float]
    gravity: Sequence[float] = GRAVITY
    payloads: tuple[Payload, ...] = ()


@dataclass(frozen=True)
class Twin:
    """A compiled model whose degrees of freedom are theta_1, phi_1, theta_2, phi_2, ..."""

    model: Any
    names: tuple[str, ...]

    def state(self, q: ArrayLike, theta: ArrayLike, dq: ArrayLike, dtheta: ArrayLike) -> Any:
        """Return MuJoCo's data at a state, everything computed but the forces of contacts."""
        data = mujoco.MjData(self.model)
        data.qpos[0::2], data.qpos[1::2] = theta, np.subtract(q, theta)
        data.qvel[0::2], data.qvel[1::2] = dtheta, np.subtract(dq, dtheta)
        mujoco.mj_forward(self.model, data)
        return data

    def mass(self, q: ArrayLike, theta: ArrayLike) -> Array:
        """Return the (2n, 2n) mass matrix of (q, theta), from that of (theta, q - theta)."""
        n = len(self.names)
        data = self.state(q, theta, np.zeros(n), np.zeros(n))
        M, column = np.empty((2 * n, 2 * n)), np.empty(2 * n)
        for k, unit in enumerate(np.eye(2 * n)):
            mujoco.mj_mulM(self.model, data, column, unit)
            M[k] = column
        change = np.zeros((2 * n, 2 * n))  # rates of (theta, phi) from those of (q, theta)
        change[0::2, n:] = np.eye(n)
        change[1::2, :n], change[1::2, n:] = np.eye(n), -np.eye(n)
        return change.T @ M @ change

    def bias(self, q: ArrayLike, theta: ArrayLike, dq: ArrayLike, dtheta: ArrayLike) -> Array:
        """Return C q' + g of the links and, behind them, of the motors (where it should be 0)."""
        bias = self.state(q, theta, dq, dtheta).qfrc_bias
        return np.concatenate([bias[1::2], bias[0::2] - bias[1::2]])


def build_twin(arm: Arm, joints: Mapping[str, Elastic], step: float = 1e-4) -> Twin:
    """Return the arm in MuJoCo; URDF joints that are not in `joints` are welded where locked."""
    root = ElementTree.fromstring(arm.urdf)
    links = {link.attrib["name"]: link for link in root.iter("link")}
    below: dict[str, list[Any]] = {name: [] for name in links}
    children = set()
    for joint in root.findall("joint"):
        below[_name(joint, "parent")].append(joint)
        children.add(_name(joint, "child"))
    spec = mujoco.MjSpec()
    spec.option.gravity = arm.gravity
    spec.option.timestep = step
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    inertias: dict[str, Array] = {}
    names: list[str] = []
    (base,) = set(links) - children
    waiting = [(base, spec.worldbody.add_body(name=base))]
    while waiting:
        name, body = waiting.pop()
        inertias[name] = _give_inertia(body, links[name])
        for payload in arm.payloads:
            if payload.frame == name:
                _add_payload(body, payload, inertias)
        for joint in below[name]:
            child = _name(joint, "child")
            waiting.append((child, _add_joint(body, joint, child, joints, arm.locked, names)))
    assert set(names) == set(joints)
    return Twin(_compile(spec, inertias), tuple(names))


def free_motion(
    arm: Arm,
    joints: Mapping[str, Elastic],
    start: tuple[ArrayLike, ArrayLike],
    *,
    samples: int,
    period: float,
    step: float,
) -> tuple[Array, Array]:
    """Return q and theta, (samples, n) each, of the arm let go of at rest at angles (q, theta)."""
    twin = build_twin(arm, joints, step)
    every = round(period / step)
    assert np.isclose(every * step, period, rtol=1e-12)
    assert twin.names == tuple(joints)  # the columns are in this order
    rest = np.zeros(len(joints))
    data = twin.state(*start, rest, rest)
    states = np.empty((samples, 2 * len(joints)))
    for row in states:
        row[:] = data.qpos
        mujoco.mj_step(twin.model, data, nstep=every)
    return states[:, 0::2] + states[:, 1::2], states[:, 0::2]


def _add_joint(
    parent: Any,
    joint: ElementTree.Element,
    child: str,
    elastic: Mapping[str, Elastic],
    locked: Mapping[str, float],
    names: list[str],
) -> Any:
    """Add the body below a joint, with its two hinges or, for a fixed or locked joint, welded."""
    position, rotation = _origin(joint)
    axis, name = _vector(joint.find("axis"), "xyz", (1.0, 0.0, 0.0)), joint.attrib["name"]
    axis = axis / np.linalg.norm(axis)
    if name in elastic:
        body = parent.add_body(name=child, pos=position, quat=_quaternion(rotation))
        own, hinge = elastic[name], mujoco.mjtJoint.mjJNT_HINGE
        body.add_joint(name=f"{name}.motor", type=hinge, axis=axis, armature=own.rotor)
        body.add_joint(
            name=f"{name}.spring",
            type=hinge,
            axis=axis,
            stiffness=[own.stiffness, 0.0, own.cubic],
            damping=[own.damping, 0.0, 0.0],
        )
        names.append(name)
        return body
    if joint.attrib["type"] != "fixed":
        assert joint.attrib["type"] in ("revolute", "continuous")
        rotation = rotation * Rotation.from_rotvec(locked[name] * axis)
    return parent.add_body(name=child, pos=position, quat=_quaternion(rotation))


def _give_inertia(body: Any, link: ElementTree.Element) -> Array:
    """Give a body its link's mass; return its principal moments."""
    inertial = link.find("inertial")
    if inertial is None:
        return _set_inertia(body, 0.0, np.zeros(3), Rotation.identity(), np.zeros((3, 3)))
    position, rotation = _origin(inertial)
    mass, entries = inertial.find("mass"), inertial.find("inertia")
    assert mass is not None
    assert entries is not None
    tensor = np.zeros((3, 3))
    for key, value in entries.attrib.items():
        i, j = "xyz".index(key[1]), "xyz".index(key[2])
        tensor[i, j] = tensor[j, i] = float(value)
    return _set_inertia(body, float(mass.attrib["value"]), position, rotation, tensor)


def _add_payload(body: Any, payload: Payload, inertias: dict[str, Array]) -> None:
    """Weld one body more to a body."""
    name = f"payload{len(inertias)}"
    added, tensor = body.add_body(name=name), np.asarray(payload.inertia, dtype=float)
    place = np.asarray(payload.position, dtype=float)
    inertias[name] = _set_inertia(added, payload.mass, place, Rotation.identity(), tensor)


def _set_inertia(
    body: Any, mass: float, position: Array, rotation: Rotation, tensor: Array
) -> Array:
    """Set mass and principal axes; return the moments, which are set after the compilation."""
    moments, axes = np.linalg.eigh(tensor)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] *= -1.0
    body.mass, body.ipos = mass, position
    body.iquat = _quaternion(rotation * Rotation.from_matrix(axes))
    body.inertia, body.explicitinertial = np.ones(3), True
    return moments


def _compile(spec: Any, inertias: Mapping[str, Array]) -> Any:
    """Compile, then set the moments: MuJoCo's compiler refuses the r3's first link (A + B < C)."""
    model = spec.compile()
    for name, moments in inertias.items():
        model.body(name).inertia[:] = moments
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model


def _name(joint: ElementTree.Element, end: str) -> str:
    """Return the link at one end of a joint."""
    found = joint.find(end)
    assert found is not None
    return found.attrib["link"]


def _origin(element: ElementTree.Element) -> tuple[Array, Rotation]:
    """Return the pose in <origin>: R = Rz(yaw) Ry(pitch) Rx(roll)."""
    origin = element.find("origin")
    rpy = _vector(origin, "rpy", (0.0, 0.0, 0.0))
    return _vector(origin, "xyz", (0.0, 0.0, 0.0)), Rotation.from_euler("xyz", rpy)


def _vector(element: ElementTree.Element | None, key: str, default: Sequence[float]) -> Array:
    """Return three numbers of an attribute."""
    text = None if element is None else element.attrib.get(key)
    return np.array(default if text is None else text.split(), dtype=float)


def _quaternion(rotation: Rotation) -> Array:
    """Return a rotation as MuJoCo wants it: the scalar first."""
    return np.roll(rotation.as_quat(), 1)

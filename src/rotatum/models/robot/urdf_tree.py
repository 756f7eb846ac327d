"""What a URDF text says, read and checked before anything else sees it."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from xml.etree.ElementTree import Element

import numpy as np

from rotatum.errors import DeviceError
from rotatum.models.robot.names import no_such

__all__ = ["UrdfJoint", "UrdfTree", "read_tree"]

_TURNING = ("revolute", "continuous")
_REFUSED = {
    "floating": "the base of the arm must be fixed",
    "planar": "the base of the arm must be fixed",
}


@dataclass(frozen=True)
class UrdfJoint:
    """A joint of the file: its type, the links it joins, and its element."""

    name: str
    kind: str
    parent: str
    child: str
    element: Element

    @property
    def moves(self) -> bool:
        """Whether it is not fixed."""
        return self.kind != "fixed"


@dataclass(frozen=True)
class UrdfTree:
    """The links and joints of a URDF text, joints sorted from the base outwards.

    Attributes
    ----------
    source : where the text is from, for messages.
    links : name -> element.
    joints : name -> joint.
    """

    source: str
    links: dict[str, Element]
    joints: dict[str, UrdfJoint]

    @property
    def movable(self) -> tuple[str, ...]:
        """Names of the joints that are not fixed."""
        return tuple(j.name for j in self.joints.values() if j.moves)

    def arm(self, names: Sequence[str] | None) -> tuple[str, ...]:
        """Return the names of an arm's joints, if they are one; None: all that move.

        Raises
        ------
        DeviceError for joints that do not exist, do not turn, are not in the order along the arm
        or on different branches, and for links they move that are without mass.
        """
        chosen = self.movable if names is None else tuple(names)
        for name in chosen:
            self._turns(name)
        if not chosen:
            raise DeviceError("no joint of the URDF turns", where=self.source)
        if len(set(chosen)) < len(chosen):
            raise DeviceError("a joint is named twice", where=self.source, value=list(chosen))
        along = [name for name in self.joints if name in chosen]
        for before, after in pairwise(along):
            if before not in self._ancestors(after):
                what = f'joints "{before}" and "{after}" are on different branches'
                hint = "An arm is one chain; leave one of the branches out of its joints."
                raise DeviceError(what, where=self.source, hint=hint)
        if list(chosen) != along:
            what = "joints must be in the order along the arm, from the base"
            raise DeviceError(what, where=self.source, value=list(chosen), allowed=along)
        for name in chosen:
            self._check_masses(name, chosen)
        return chosen

    def check_locked(self, chosen: Sequence[str], locked: Mapping[str, float]) -> dict[str, float]:
        """Return the joints that are not the arm's -> where they are locked [rad, or m].

        Parameters
        ----------
        chosen : the arm's.
        locked : some of the others -> where; 0 for the rest.

        Raises
        ------
        DeviceError for a locked joint that does not exist, does not move, or is the arm's.
        """
        others = tuple(name for name in self.movable if name not in chosen)
        for name, angle in locked.items():
            if name in chosen:
                what = "a joint of the arm cannot be locked"
                raise DeviceError(what, where=self.source, value=name)
            if name not in others:
                raise no_such("joint to lock", name, others, where=self.source)
            if not np.isfinite(angle):
                what = f'angle of the locked joint "{name}" must be a number'
                raise DeviceError(what, where=self.source, value=angle)
        return {name: float(locked.get(name, 0.0)) for name in others}

    def _turns(self, name: str) -> None:
        """Refuse a joint an arm cannot have."""
        if name not in self.joints:
            raise no_such("joint", name, self.movable, where=self.source)
        joint = self.joints[name]
        if joint.kind not in _TURNING:
            what = f'joint "{name}" is {joint.kind}; the joints of an arm turn'
            hint = "Leave it out of the joints: it is then locked." if joint.moves else None
            raise DeviceError(what, where=self.source, hint=hint)

    def _ancestors(self, name: str) -> set[str]:
        """Return the joints between the base and a joint."""
        into = {joint.child: joint for joint in self.joints.values()}
        found: set[str] = set()
        link = self.joints[name].parent
        while link in into:
            found.add(into[link].name)
            link = into[link].parent
        return found

    def _check_masses(self, name: str, chosen: Sequence[str]) -> None:
        """Refuse a joint that moves nothing, or links that no body can be."""
        moved = list(self._fixed_to(self.joints[name].child, chosen))
        heavy = [link for link in moved if self.links[link].find("inertial") is not None]
        if not heavy:
            what = f'link "{moved[0]}" moves with joint "{name}" and has no <inertial>'
            if len(moved) > 1:
                what += ", nor has anything fixed to it"
            raise DeviceError(what, where=self.source)
        for link in heavy:
            _check_inertial(self.links[link], link, self.source)

    def _fixed_to(self, link: str, chosen: Sequence[str]) -> Iterator[str]:
        """Yield a link and all that move with it."""
        yield link
        for joint in self.joints.values():
            if joint.parent == link and joint.name not in chosen:
                yield from self._fixed_to(joint.child, chosen)


def read_tree(text: str, source: str) -> UrdfTree:
    """Read a URDF text.

    Raises
    ------
    DeviceError for text that is no URDF, joints that mimic, float or slide in a plane, and links
    that are not one tree.
    """
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise DeviceError(f"is not valid XML ({error})", where=source) from None
    if root.tag != "robot":
        what = "is no URDF: its outermost element must be <robot>"
        raise DeviceError(what, where=source, value=root.tag)
    if any("xacro" in element.tag for element in root.iter()):
        raise DeviceError("is a xacro file", where=source, hint="Turn it into URDF with xacro.")
    links = {_name(element, source): element for element in root.findall("link")}
    joints = [_joint(element, links, source) for element in root.findall("joint")]
    for kind, names in (
        ("link", [_name(element, source) for element in root.findall("link")]),
        ("joint", [joint.name for joint in joints]),
    ):
        for name in names:
            if names.count(name) > 1:
                raise DeviceError(f"two {kind}s have the same name", where=source, value=name)
    return UrdfTree(source, links, _sorted(links, joints, source))


def _joint(element: Element, links: dict[str, Element], source: str) -> UrdfJoint:
    """Read a joint, refusing those that no serial arm has."""
    name = _name(element, source)
    kind = element.get("type", "")
    where = f'joint "{name}"'
    if kind in _REFUSED:
        raise DeviceError(f"{where} is {kind}", where=source, hint=f"Fix it: {_REFUSED[kind]}.")
    allowed = (*_TURNING, "fixed", "prismatic")
    if kind not in allowed:
        what = f"{where} has an unknown type"
        raise DeviceError(what, where=source, value=kind, allowed=allowed)
    mimic = element.find("mimic")
    if mimic is not None:
        what = f'{where} mimics "{mimic.get("joint")}", which is not an arm\'s joint'
        raise DeviceError(what, where=source, hint="Make it fixed, or remove its branch.")
    ends = []
    for role in ("parent", "child"):
        end = element.find(role)
        link = None if end is None else end.get("link")
        if link not in links:
            what = f"{where} has no {role} among the links"
            raise DeviceError(what, where=source, value=link, allowed=tuple(links))
        ends.append(link)
    _check_geometry(element, where, source, turns=kind != "fixed")
    return UrdfJoint(name, kind, ends[0], ends[1], element)


def _sorted(
    links: dict[str, Element], joints: list[UrdfJoint], source: str
) -> dict[str, UrdfJoint]:
    """Return the joints from the base outwards, along each branch in turn."""
    children = [joint.child for joint in joints]
    for link in children:
        if children.count(link) > 1:
            raise DeviceError(f'link "{link}" hangs on two joints', where=source)
    roots = [link for link in links if link not in children]
    if len(roots) != 1:
        what = "the links must be one tree with one base"
        raise DeviceError(what, where=source, value=roots)
    found: dict[str, UrdfJoint] = {}
    waiting = roots
    while waiting:
        link = waiting.pop(0)
        below = [joint for joint in joints if joint.parent == link]
        found.update((joint.name, joint) for joint in below)
        waiting = [joint.child for joint in below] + waiting
    if len(found) < len(joints):
        loose = [joint.name for joint in joints if joint.name not in found]
        raise DeviceError("joints form a loop", where=source, value=loose)
    return found


def _check_geometry(element: Element, where: str, source: str, *, turns: bool) -> None:
    """Refuse an origin or an axis that is not three numbers."""
    origin, axis = element.find("origin"), element.find("axis")
    for given, key in ((origin, "xyz"), (origin, "rpy"), (axis, "xyz")):
        if given is not None and given.get(key) is not None:
            _numbers(given, key, 3, f"{where}: <{given.tag}>", source)
    if turns and axis is not None:
        direction = _numbers(axis, "xyz", 3, f"{where}: <axis>", source)
        if not np.any(direction):
            raise DeviceError(f"{where} has no axis", where=source, value=axis.get("xyz"))


def _check_inertial(link: Element, name: str, source: str) -> None:
    """Refuse a mass or an inertia that no body has."""
    inertial = link.find("inertial")
    where = f'link "{name}"'
    mass = None if inertial is None else inertial.find("mass")
    inertia = None if inertial is None else inertial.find("inertia")
    if inertial is None or mass is None or inertia is None:
        missing = "mass" if mass is None else "inertia"
        raise DeviceError(f"{where}: <inertial> has no <{missing}>", where=source)
    (heavy,) = _numbers(mass, "value", 1, f"{where}: <mass>", source)
    if heavy <= 0.0:
        what = f"{where}: mass must be greater than 0"
        raise DeviceError(what, where=source, value=heavy)
    origin = inertial.find("origin")
    for key in ("xyz", "rpy"):
        if origin is not None and origin.get(key) is not None:
            _numbers(origin, key, 3, f"{where}: <inertial> <origin>", source)
    keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    xx, yy, zz, xy, xz, yz = (
        _numbers(inertia, key, 1, f"{where}: <inertia>", source)[0] for key in keys
    )
    principal = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if not principal[0] > 0.0:
        what = f"{where}: inertia must be positive about every axis"
        rounded = [float(f"{value:.4g}") for value in principal]
        raise DeviceError(what, where=source, value=rounded)


def _name(element: Element, source: str) -> str:
    """Return an element's name."""
    name = element.get("name")
    if not name:
        raise DeviceError(f"a <{element.tag}> has no name", where=source)
    return name


def _numbers(element: Element, key: str, count: int, where: str, source: str) -> list[float]:
    """Return the numbers of an attribute."""
    text = element.get(key)
    try:
        numbers = [float(part) for part in (text or "").split()]
    except ValueError:
        numbers = []
    if len(numbers) != count or not np.isfinite(numbers).all():
        what = f"{where} {key} must be {count} number{'s' if count > 1 else ''}"
        raise DeviceError(what, where=source, value=text)
    return numbers

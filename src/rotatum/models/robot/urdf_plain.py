"""A URDF text with nothing in it but what dynamics need."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from xml.etree.ElementTree import Element, SubElement

from rotatum.models.robot.urdf_tree import UrdfTree

__all__ = ["plain_urdf"]

_KEPT = ("origin", "parent", "child", "axis")


def plain_urdf(tree: UrdfTree) -> str:
    """Return the text for pinocchio: no meshes, no colours, no limits.

    A continuous joint becomes a revolute one without limits: pinocchio would describe it by cosine
    and sine, and q would have more numbers than the arm has joints. Inertia of the base, which
    never moves, is left out.
    """
    root = Element("robot", name="arm")
    moving = {joint.child for joint in tree.joints.values()}
    for name, link in tree.links.items():
        plain = SubElement(root, "link", name=name)
        inertial = link.find("inertial")
        if inertial is not None and name in moving:
            plain.append(inertial)
    for joint in tree.joints.values():
        kind = "revolute" if joint.kind == "continuous" else joint.kind
        plain = SubElement(root, "joint", name=joint.name, type=kind)
        plain.extend(child for child in joint.element if child.tag in _KEPT)
        if joint.moves:
            SubElement(plain, "limit", lower="-1e9", upper="1e9", effort="1e9", velocity="1e9")
    return ElementTree.tostring(root, encoding="unicode")

"""An arm to control, and the period it is controlled at."""

from __future__ import annotations

from rotatum.models.device import Device, device_from_tables

PERIOD = 1e-3


def planar_arm() -> Device:
    """Return a planar 2R arm of series joints, its second rotor coupled to the first link."""
    joint = {
        "motor": {"inertia": 0.05},
        "transmission": {"law": "linear", "stiffness": 400.0, "damping": 0.8},
    }
    tables = {
        "name": "planar",
        "joint": [{"name": "shoulder", **joint}, {"name": "elbow", **joint}],
        "robot": {
            "model": "planar",
            "lengths": [0.4, 0.3],
            "masses": [2.0, 1.0],
            "coupling": [[0.0, 0.01], [0.0, 0.0]],
        },
    }
    return device_from_tables(tables, "planar.toml")

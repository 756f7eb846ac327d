"""What an arm's dynamics say of a sample: momentum and forces, or the elastic rotatum."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import MethodError, check_names
from rotatum.estimators.observers.stage import observer_params, observer_stage
from rotatum.estimators.tuning import Prepared
from rotatum.models import Device
from rotatum.models.robot.interface import Robot
from rotatum.record import Records
from rotatum.runtime.bank import Bank

Array = NDArray[np.float64]


Views = Mapping[str, NDArray[Any]]
"""Fields of an array of records, each an array: reading a record itself is ten times slower."""


def views(records: Records) -> Views:
    """Return the fields of an array of records."""
    return {name: records[name] for name in records.dtype.names or ()}


class Load(NamedTuple):
    """What the arm's dynamics say at one instant, all (n,).

    Args:
        momentum: ``p = M(q) q'``, N m s.
        force: ``C^T q' - g``, N m.
        payload_momentum, payload_force: what 1 kg at the payload's frame adds to them.
    """

    momentum: Array
    force: Array
    payload_momentum: Array
    payload_force: Array


Provider = Callable[[Array, Array], Load]
"""Link positions and velocities, (n,) each, to the load."""


def load_provider(robot: Robot, payload: Robot | None) -> Provider:
    """Return the load of an arm: ``p' - C^T q' + g`` is what its links ask of the joints.

    Args:
        robot: the arm as known.
        payload: the same arm with 1 kg where a payload is fitted; None: none is.
    """
    none = np.zeros(robot.size)

    def load(q: Array, dq: Array) -> Load:
        momentum, force = robot.momentum(q, dq)
        force = force - robot.gravity(q)
        if payload is None:
            return Load(momentum, force, none, none)
        more, pull = payload.momentum(q, dq)
        return Load(momentum, force, more - momentum, pull - payload.gravity(q) - force)

    return load


class ArmTerms(Protocol):
    """What the rows of a method need of the whole arm."""

    def reset(self) -> None:
        """Forget everything."""

    def fill(self, to: Views, row: int, steps: Views, i: int, k: int) -> None:
        """Fill the arm's fields of the joints' samples.

        Args:
            to: (S, n) samples of the joints, ``fresh`` filled in.
            row: of them.
            steps: (N,) ``ArmSteps``.
            i, k: which sample's, which of its steps.
        """


def arm_terms(device: Device, robot: Robot, prepared: Sequence[Prepared]) -> ArmTerms:
    """Return what the joints' method needs of their arm.

    Raises:
        MethodError: the payload's frame is not one of the arm's; joints differ in their method.
    """
    methods = {p.settings.method for p in prepared}
    if len(methods) > 1:
        raise MethodError(
            "the joints of an arm are estimated by one method from the link side",
            where=device.source,
            value=sorted(methods),
        )
    if "rotatum" in methods:
        return RotatumTerms(device, robot, prepared)
    return MomentumTerms(load_provider(robot, _with_payload(device, robot, prepared)))


class MomentumTerms:
    """The load of an arm, of two samples ago: link velocities are differences across it.

    Args:
        provider: of the load.
    """

    def __init__(self, provider: Provider) -> None:
        self.provider = provider

    def reset(self) -> None:
        """Nothing is remembered."""

    def fill(self, to: Views, row: int, steps: Views, i: int, k: int) -> None:
        """Fill momentum and force where link velocities are known."""
        if steps["known"][i, k]:
            load = self.provider(steps["q_past"][i, k], steps["dq_past"][i, k])
            to["momentum"][row], to["force"][row] = load.momentum, load.force
            to["payload_momentum"][row] = load.payload_momentum
            to["payload_force"][row] = load.payload_force


class RotatumTerms:
    """``p_e = -d/dt (M q'' + C q' + g)``, of the instant every joint's observer tells.

    trumic2022 eq. 9 with its signs corrected: one observer a link (Corollary 1), then the rate of
    the arm's inverse dynamics along the motion.

    Args:
        device: for messages.
        robot: the arm as known.
        prepared: its joints.

    Raises:
        MethodError: joints differ in the observer.
    """

    def __init__(self, device: Device, robot: Robot, prepared: Sequence[Prepared]) -> None:
        operators = dict.fromkeys(p.settings.operator for p in prepared)
        if len(operators) > 1:
            raise MethodError(
                "rotatum needs one cutoff for all joints of an arm: they are differentiated "
                "together",
                where=device.source,
                value=[str(operator) for operator in operators],
            )
        recursion = next(iter(operators)).observer.recursion
        stage = observer_stage(recursion, inputs=1)
        self.robot = robot
        self.bank = Bank(stage, observer_params(stage, recursion, len(prepared)))
        self._u = stage.input.zeros(len(prepared))
        self._out = stage.output.zeros(len(prepared))
        sample, observed = views(self._u), views(self._out)
        self._q, self._fresh = sample["y"][:, 0], sample["fresh"]
        self._motion = tuple(observed["x"].T)
        self._jerk, self._valid = observed["u"][:, 0], observed["valid"]

    def reset(self) -> None:
        """Forget what the links did."""
        self.bank.reset()

    def fill(self, to: Views, row: int, steps: Views, i: int, k: int) -> None:
        """Observe the links, and fill the rotatum where they are known."""
        self._q[:] = steps["q"][i, k]
        self._fresh[:] = to["fresh"][row]
        self.bank.update(self._u, self._out)
        if self._valid[0]:
            q, dq, ddq = self._motion
            rate = self.robot.inverse_dynamics_rate(q, dq, ddq, self._jerk)
            to["acceleration"][row] = ddq
            np.negative(rate, out=to["rotatum"][row])


def _with_payload(device: Device, robot: Robot, prepared: Sequence[Prepared]) -> Robot | None:
    """The arm with 1 kg where a payload is fitted; None: none is."""
    fitting = [p.joint.estimator for p in prepared if "payload" in p.settings.fit]
    if not fitting:
        return None
    places = {(own.payload_frame, own.payload_position) for own in fitting}
    if len(places) > 1:
        raise MethodError(
            "an arm carries its payload at one place",
            where=device.source,
            value=sorted(map(str, places)),
        )
    frame, position = places.pop()
    if frame is not None:
        what = "the arm has no such frame for its payload"
        check_names([frame], robot.frames, what=what, where=device.source)
    return robot.with_payload(frame or robot.frames[-1], 1.0, position or (0.0, 0.0, 0.0))

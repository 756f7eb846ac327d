"""The estimator in a loop: joints grouped into banks, one sample at a time or a batch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.errors import MethodError
from rotatum.estimators.settings import Request, settle
from rotatum.estimators.shapes import roles
from rotatum.estimators.tuning import Prepared, prepare
from rotatum.kernels.status import VERDICTS
from rotatum.models import Device
from rotatum.record import Records
from rotatum.runtime.bank import Bank


class Group:
    """Joints that share a stage: their bank, their places in the device, their input and output."""

    def __init__(self, prepared: Sequence[Prepared], places: Sequence[int]) -> None:
        self.prepared = tuple(prepared)
        self.places = np.array(places)
        stage = prepared[0].stage
        self.bank = Bank(stage, np.concatenate([p.params for p in prepared]))
        self.u = stage.input.zeros(len(prepared))
        self.u["enable"] = 1
        self.out = stage.output.zeros(len(prepared))

    @property
    def roles(self) -> tuple[str, ...]:
        """Channels of the log this group's input record is made of."""
        shape = self.prepared[0].shape
        return roles(shape.actuation, shape.torque)


class Readings:
    """What one ``Estimator.update`` returns: arrays over the device's joints, in its order.

    ``readings["stiffness"]`` (or any scalar field of ``Reading``) is an ``(n,)`` array; the usual
    ones are properties. The arrays are filled anew by the next update.
    """

    def __init__(self, groups: Sequence[Group], joints: int) -> None:
        self._groups = groups
        self._joints = joints

    def __getitem__(self, field: str) -> NDArray[Any]:
        if len(self._groups) == 1:
            return np.asarray(self._groups[0].out[field])
        first = self._groups[0].out[field]
        values = np.empty(self._joints, first.dtype)
        for group in self._groups:
            values[group.places] = group.out[field]
        return values

    @property
    def stiffness(self) -> NDArray[np.float64]:
        """Stiffness, N m/rad."""
        return self["stiffness"]

    @property
    def stiffness_std(self) -> NDArray[np.float64]:
        """Its standard deviation, N m/rad."""
        return self["stiffness_std"]

    @property
    def torque(self) -> NDArray[np.float64]:
        """Elastic torque from the fitted law, N m."""
        return self["torque"]

    @property
    def dstiffness(self) -> NDArray[np.float64]:
        """Derivative of the stiffness by deflection, N m/rad^2."""
        return self["dstiffness"]

    @property
    def status(self) -> NDArray[np.int64]:
        """Status bits, see ``rotatum.kernels.status``."""
        return self["status"]

    @property
    def verdict(self) -> tuple[str, ...]:
        """One of ``starved``, ``converging``, ``informative``, ``inconsistent`` per joint."""
        return tuple(VERDICTS[int(v)] for v in self["verdict"])


class Estimator:
    """Online stiffness estimation for all joints of a device.

    >>> import rotatum as rt
    >>> loop = rt.Estimator(rt.load_device("series-demo"), period=1e-3)  # doctest: +SKIP
    >>> out = loop.update(q=0.01, theta=0.0, tau=0.2)                    # doctest: +SKIP
    >>> out.stiffness, out.verdict                                       # doctest: +SKIP

    Args:
        device: from ``load_device``.
        period: sample period, s.
        method: ``"weak"`` or ``"residual"``; ``None``: the device file's, then ``"weak"``.
        torque: ``"estimated"``, ``"sensor"`` or ``"model"``.
        cutoff: rad/s.
        fit: columns fitted beside the stiffness.
        forgetting: weight of a row relative to the next one, 0.998 to 1.
        solver: ``"ud"`` or ``"covariance"``.
        shrinkage: whether high orders are shrunk as far as the data do not ask for them.
        holds: joint to role to ``"held"`` or ``"sampled"``; ``None``: the device's channels.
        zeros: joint to deflection at rest of each transmission, rad; ``None``: the device
            file's rule.

    Raises:
        MethodError: a setting, or something the device lacks; names joint, value and allowed ones.
    """

    def __init__(
        self,
        device: Device,
        *,
        period: float,
        method: str | None = None,
        side: str | None = None,
        torque: str | None = None,
        cutoff: float | None = None,
        fit: Sequence[str] | None = None,
        forgetting: float | None = None,
        solver: str | None = None,
        shrinkage: bool | None = None,
        holds: Mapping[str, Mapping[str, str]] | None = None,
        zeros: Mapping[str, Sequence[float]] | None = None,
    ) -> None:
        if not period > 0.0:
            raise MethodError("period must be positive (s)", where=device.source, value=period)
        columns = None if fit is None else tuple(fit)
        request = Request(method, side, torque, cutoff, columns, forgetting, solver, shrinkage)
        self.device = device
        self.period = float(period)
        self.prepared = tuple(
            prepare(
                joint,
                settle(joint, device, period, request),
                period=period,
                holds=_holds(joint.name, joint.channels, holds),
                zeros=(zeros or {}).get(joint.name),
            )
            for joint in device.joints
        )
        shapes = dict.fromkeys(p.shape for p in self.prepared)
        self.groups = tuple(
            Group(
                [p for p in self.prepared if p.shape == shape],
                [i for i, p in enumerate(self.prepared) if p.shape == shape],
            )
            for shape in shapes
        )
        self._readings = Readings(self.groups, len(self.prepared))
        self._samples = 0

    def update(
        self,
        *,
        q: ArrayLike,
        theta: ArrayLike | None = None,
        theta1: ArrayLike | None = None,
        theta2: ArrayLike | None = None,
        setpoint: ArrayLike | None = None,
        tau: ArrayLike | None = None,
        tau1: ArrayLike | None = None,
        tau2: ArrayLike | None = None,
        torque_measured: ArrayLike | None = None,
        torque_measured1: ArrayLike | None = None,
        torque_measured2: ArrayLike | None = None,
        time: float | None = None,
        enable: ArrayLike = 1,
    ) -> Readings:
        """Take one sample of every joint; a bad one is skipped and said in ``status``.

        Every array has one value per joint of the device; which are needed follows from the
        joints' actuation and torque source, and values of joints that do not have them are unused.

        Args:
            q: link positions, rad.
            theta: motor positions at the joint, rad (series and serial joints).
            theta1, theta2: agonist's and antagonist's, rad (antagonistic joints).
            setpoint: set-points as logged (serial joints).
            tau, tau1, tau2: motor torques at the joint, N m (torque estimated).
            torque_measured, torque_measured1, torque_measured2: measured elastic torques, N m
                (torque from a sensor).
            time: of the sample, s; ``None``: one period after the one before.
            enable: 0 stops learning (not filtering), per joint or for all.

        Returns:
            Readings over the joints; the same object every time.

        Raises:
            MethodError: a channel that some joint needs is missing; names it and the joint.
        """
        now = self._samples * self.period if time is None else time
        given = {
            "q": q,
            "theta": theta,
            "theta1": theta1,
            "theta2": theta2,
            "setpoint": setpoint,
            "tau": tau,
            "tau1": tau1,
            "tau2": tau2,
            "torque_measured": torque_measured,
            "torque_measured1": torque_measured1,
            "torque_measured2": torque_measured2,
        }
        n, alone = len(self.prepared), len(self.groups) == 1
        for group in self.groups:
            u = group.u
            u["time"] = now
            for role in group.roles:
                value = given[role]
                if value is None:
                    raise MethodError(
                        f"update needs {role} for joint {group.prepared[0].joint.name}"
                    )
                u[role] = value if alone else np.broadcast_to(value, (n,))[group.places]
            u["enable"] = enable if alone else np.broadcast_to(enable, (n,))[group.places]
        self._samples += 1
        for group in self.groups:
            group.bank.update(group.u, group.out)
        return self._readings

    def reset(self) -> None:
        """Forget everything: every joint in its initial state, time back at 0."""
        self._samples = 0
        for group in self.groups:
            group.bank.reset()

    def __repr__(self) -> str:
        methods = ", ".join(f"{p.joint.name}: {p.settings.method}" for p in self.prepared)
        return f"Estimator({self.device.name}, {self.period:g} s, {methods})"


def _holds(
    name: str, channels: Mapping[str, Any], given: Mapping[str, Mapping[str, str]] | None
) -> Mapping[str, str]:
    if given is not None and name in given:
        return given[name]
    return {role: channel.hold for role, channel in channels.items()}


def batch_records(group: Group, samples: int) -> Records:
    """Input records for a batch of ``samples`` of a group, ``enable`` set."""
    u = group.bank.stage.input.zeros(samples, len(group.prepared))
    u["enable"] = 1
    return u

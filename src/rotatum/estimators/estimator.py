"""The estimator in a loop: joints grouped into banks, one sample at a time or a batch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.errors import MethodError
from rotatum.estimators.settings import Request, settle
from rotatum.estimators.tuning import Prepared, prepare
from rotatum.kernels.status import VERDICTS
from rotatum.models import Device
from rotatum.record import Records
from rotatum.runtime.bank import Bank

CHANNELS = {"estimated": "tau", "sensor": "torque_measured"}


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
    def torque_field(self) -> str:
        """Name of the torque in this group's input record."""
        return "tau" if "tau" in self.bank.stage.input.fields else "torque"


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
        torque: ``"estimated"`` or ``"sensor"``.
        cutoff: rad/s.
        fit: columns fitted beside the stiffness.
        forgetting: weight of a row relative to the next one, 0.998 to 1.
        solver: ``"ud"`` or ``"covariance"``.
        holds: joint to role to ``"held"`` or ``"sampled"``; ``None``: the device's channels.
        zeros: joint to deflection at rest, rad; ``None``: the device file's rule.

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
        holds: Mapping[str, Mapping[str, str]] | None = None,
        zeros: Mapping[str, float] | None = None,
    ) -> None:
        if not period > 0.0:
            raise MethodError("period must be positive (s)", where=device.source, value=period)
        columns = None if fit is None else tuple(fit)
        request = Request(method, side, torque, cutoff, columns, forgetting, solver)
        self.device = device
        self.period = float(period)
        self.prepared = tuple(
            prepare(
                joint,
                settle(joint, device, period, request),
                period=period,
                holds=_holds(joint.name, joint.channels, holds),
                zero=(zeros or {}).get(joint.name),
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
        theta: ArrayLike,
        tau: ArrayLike | None = None,
        torque_measured: ArrayLike | None = None,
        time: float | None = None,
        enable: ArrayLike = 1,
    ) -> Readings:
        """Take one sample of every joint; a bad one is skipped and said in ``status``.

        Args:
            q: link positions, rad, one per joint of the device.
            theta: motor positions at the joint, rad.
            tau: motor torques at the joint, N m (for joints whose torque is estimated).
            torque_measured: measured elastic torques, N m (for joints with a sensor).
            time: of the sample, s; ``None``: one period after the one before.
            enable: 0 stops learning (not filtering), per joint or for all.

        Returns:
            Readings over the joints; the same object every time.
        """
        now = self._samples * self.period if time is None else time
        self._samples += 1
        n, alone = len(self.prepared), len(self.groups) == 1
        for group in self.groups:
            torque = tau if group.torque_field == "tau" else torque_measured
            if torque is None:
                raise MethodError(
                    f"update needs {CHANNELS[group.prepared[0].settings.torque]} for joint "
                    f"{group.prepared[0].joint.name}"
                )
            u = group.u
            u["time"] = now
            for field, value in (
                ("q", q),
                ("theta", theta),
                (group.torque_field, torque),
                ("enable", enable),
            ):
                u[field] = value if alone else np.broadcast_to(value, (n,))[group.places]
            group.bank.update(u, group.out)
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

"""The estimator in a loop: joints grouped into banks, one sample at a time or a batch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.errors import MethodError
from rotatum.estimators.armfront import ArmFront
from rotatum.estimators.fitted_law import FittedLaw, fitted_laws, zeros_of
from rotatum.estimators.groups import Group, run_alone, run_arm
from rotatum.estimators.measured import Measured
from rotatum.estimators.preparing import prepare_all
from rotatum.estimators.readings import Readings
from rotatum.estimators.settings import Request
from rotatum.models import Device
from rotatum.record import Records

Array = NDArray[np.float64]
ALL = slice(None)


class Estimator:
    """Online stiffness estimation for all joints of a device.

    >>> import rotatum as rt
    >>> loop = rt.Estimator(rt.load_device("series-demo"), period=1e-3)  # doctest: +SKIP
    >>> out = loop.update(q=0.01, theta=0.0, tau=0.2)                    # doctest: +SKIP
    >>> out.stiffness, out.verdict                                       # doctest: +SKIP

    Args:
        device: from ``load_device``.
        period: sample period, s.
        method: ``"weak"``, ``"algebraic"``, ``"residual"`` or ``"rotatum"``; ``None``: the device
            file's, then ``"weak"``.
        side: of the torque balance, ``"motor"`` or ``"link"``.
        torque: ``"estimated"``, ``"sensor"`` or ``"model"``.
        cutoff: of the low-pass, or of the observer of ``rotatum`` (infinite: deadbeat), rad/s; or
        window: that rows look back, s.
        order: poles of the low-pass (2, 3), power of the window (2 to 5), or samples by which the
            observer is late.
        stride: samples from one row of a window to the next.
        fit: columns fitted beside the stiffness.
        forgetting: weight of a row relative to the next one, 0.998 to 1.
        solver: ``"ud"`` or ``"covariance"``.
        shrinkage: whether high orders are shrunk as far as the data do not ask for them.
        selective: link speed below which nothing is learnt, rad/s; 0: all is.
        measured: joint to what is known of its signals' noise; what the encoders' counts make is
            known anyway.
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
        window: float | None = None,
        order: int | None = None,
        stride: int | None = None,
        fit: Sequence[str] | None = None,
        forgetting: float | None = None,
        solver: str | None = None,
        shrinkage: bool | None = None,
        selective: float | None = None,
        measured: Mapping[str, Measured] | None = None,
        holds: Mapping[str, Mapping[str, str]] | None = None,
        zeros: Mapping[str, Sequence[float]] | None = None,
    ) -> None:
        if not period > 0.0:
            raise MethodError("period must be positive (s)", where=device.source, value=period)
        columns = None if fit is None else tuple(fit)
        request = Request(
            method=method,
            side=side,
            torque=torque,
            cutoff=cutoff,
            window=window,
            order=order,
            stride=stride,
            fit=columns,
            forgetting=forgetting,
            solver=solver,
            shrinkage=shrinkage,
            selective=selective,
        )
        self.device = device
        self.period = float(period)
        self.prepared = prepare_all(
            device, self.period, request, measured or {}, holds, zeros or {}
        )
        arm = any(p.shape.arm for p in self.prepared)
        self._arm = ArmFront(device, self.prepared) if arm else None
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
            if self._arm is None:
                u["time"] = now
            for role in group.roles:
                value = given[role]
                if value is None:
                    raise MethodError(
                        f"update needs {role} for joint {group.prepared[0].joint.name}"
                    )
                own = value if alone else np.broadcast_to(value, (n,))[group.places]
                if self._arm is None:
                    u[role] = own
                else:
                    self._arm.put(role, ALL if alone else group.places, own)
            learn = enable if alone else np.broadcast_to(enable, (n,))[group.places]
            if self._arm is None:
                u["enable"] = learn
            else:
                self._arm.enable(ALL if alone else group.places, learn)
        self._samples += 1
        if self._arm is not None:
            self._update_arm(self._arm, now)
            return self._readings
        for group in self.groups:
            group.bank.update(group.u, group.out)
        return self._readings

    def _update_arm(self, arm: ArmFront, now: float) -> None:
        for k in range(arm.advance(now)):
            arm.fill(k, now)
            if len(self.groups) == 1:
                self.groups[0].bank.update(arm.joints, self.groups[0].out)
                continue
            for group in self.groups:
                np.take(arm.joints, group.places, out=group.u, mode="clip")
                group.bank.update(group.u, group.out)

    def run(self, time: Array, channels: Sequence[Mapping[str, Array]]) -> list[Records]:
        """Take a batch: the same steps as ``update``, one after the other.

        Args:
            time: (N,) s.
            channels: per joint of the device, role to (N,).

        Returns:
            (N, m) records of readings per group of ``groups``, m joints in each.
        """
        self._samples += len(time)
        if self._arm is not None:
            return run_arm(self.groups, self._arm, time, channels)
        return [run_alone(group, time, channels) for group in self.groups]

    def part_states(self, place: int) -> tuple[Any, ...]:
        """Return the state records of the parts of a joint, as its ``prepared.parts``.

        Args:
            place: of the joint in the device.

        Raises:
            IndexError: there is no such joint.
        """
        group, i = self._find(place)
        return _parts(group.bank.state[i]["inner"], group.prepared[i].apart)

    def laws(self, place: int = 0) -> tuple[FittedLaw, ...]:
        """Return what is known now of each transmission of a joint, for any deflection.

        Args:
            place: of the joint in the device.

        Raises:
            IndexError: there is no such joint.
            MethodError: its law depends on a set-point.
        """
        group, i = self._find(place)
        # fields of arrays, not of records: a loop asks at every sample
        parts = _parts(group.bank.state["inner"], group.prepared[i].apart)
        return fitted_laws(
            group.prepared[i],
            group.out["coefficients"][i].tolist(),
            [x for part in parts for x in zeros_of(part["rows"][i : i + 1])],
        )

    def _find(self, place: int) -> tuple[Group, int]:
        """Return a joint's group, and its place in it."""
        for group in self.groups:
            for i, own in enumerate(group.places):
                if own == place:
                    return group, i
        raise IndexError(place)

    def reset(self) -> None:
        """Forget everything: every joint in its initial state, time back at 0."""
        self._samples = 0
        if self._arm is not None:
            self._arm.reset()
        for group in self.groups:
            group.bank.reset()

    def __repr__(self) -> str:
        methods = ", ".join(f"{p.joint.name}: {p.settings.method}" for p in self.prepared)
        return f"Estimator({self.device.name}, {self.period:g} s, {methods})"


def _parts(inner: Any, apart: bool) -> tuple[Any, ...]:
    """Records of each transmission that has its own solver."""
    return (inner["first"], inner["second"]) if apart else (inner,)

"""Position and stiffness of an antagonistic joint controlled on what an estimator says of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rotatum.control.antagonistic_joint import AntagonisticJoint, JointState
from rotatum.control.decoupling import DecouplingGains, DecouplingLaw, Target
from rotatum.control.motor_position import MotorPosition
from rotatum.control.pole_placement import PolePair
from rotatum.control.stiffness_control import StiffnessControl
from rotatum.errors import MethodError
from rotatum.estimators.estimator import Estimator
from rotatum.estimators.readings import Readings as Told
from rotatum.evaluation.loop.motion_filter import MotionFilter
from rotatum.evaluation.loop.stiffness_run import LoopSettings, StiffnessRun
from rotatum.evaluation.loop.stiffness_task import CALM, StiffnessTask
from rotatum.simulation import simulate
from rotatum.simulation.drivers.arm_control import ArmControl
from rotatum.simulation.drivers.feedback import Seen
from rotatum.simulation.sensing.live import LiveSensors

if TYPE_CHECKING:
    from rotatum.models.device import Device
    from rotatum.models.elastic import ElasticLaw

__all__ = ["StiffnessLoop", "run_stiffness_loop"]

Array = NDArray[np.float64]
_HELD = {"tau1": "held", "tau2": "held"}
_NARROW = 0.1  # half interval over the estimate, as of the verdict "informative"
_COLUMNS = (
    "q_d", "sigma_d", "sigma_estimated", "sigma_std", "tau1", "tau2",
)  # fmt: skip


class StiffnessLoop:
    """The controller of one antagonistic joint: sensors, filters, estimator, law; once a period.

    At an instant the law takes the positions read then and the estimate of the instant before; the
    estimator then takes these positions and the torque just decided, which is held.

    Parameters
    ----------
    device
        One antagonistic joint.
    task
        What it is to do.
    settings
        Of the loop.
    estimator
        Arguments of `rotatum.Estimator` beside the period.
    seed
        Of the sensors' noise.

    Raises `MethodError` for several joints, `DeviceError` as `AntagonisticJoint.of`.
    """

    def __init__(
        self,
        device: Device,
        task: StiffnessTask,
        settings: LoopSettings,
        estimator: Mapping[str, Any],
        *,
        seed: int = 0,
    ) -> None:
        if len(device.joints) != 1:
            what = "this loop controls a device of one joint"
            raise MethodError(what, where=device.name, value=len(device.joints), allowed="1")
        self.device, self.task, self.settings, self.seed = device, task, settings, seed
        joint = device.joints[0]
        full = AntagonisticJoint.of(joint)
        a, b = full.limits
        limits = settings.share * a, settings.share * b
        self.joint = replace(full, limits=limits)
        self.estimator = Estimator(
            device, period=settings.period, holds={joint.name: _HELD}, **estimator
        )
        pair = PolePair(settings.motion)
        gains = DecouplingGains.of_poles((pair, pair), PolePair(settings.stiffness))
        reach = joint.basis.deflection_range or 1.0
        held = self.joint.held(settings.period)
        self.control = StiffnessControl(
            DecouplingLaw(held, gains, reach),
            MotorPosition(held, settings.motor),
            settings.period,
            settings.switching,
        )
        self.rows: list[tuple[float, ...]] = []
        self.restart()

    def restart(self) -> None:
        """Forget everything; a simulation that has to be run anew begins again."""
        self.sensors = LiveSensors(self.device, seed=self.seed, period=self.settings.period)
        self.estimator.reset()
        self.control.reset()
        self.rows.clear()
        self.filter = MotionFilter(self.joint, self.settings.velocity, self.settings.period)
        self._told: Told | None = None
        self._trusted = False
        self.handed_over: float | None = None
        self._still: float | None = None
        self._from = (0.0, 0.0)

    def __call__(self, seen: Seen) -> Array:
        """Return the torques (1, 2) [N m] of an instant."""
        if seen.time == 0.0 and self.rows:
            self.restart()
        shown = self.sensors.read(seen).joints
        q, *theta = (float(shown[role][0]) for role in ("q", "theta1", "theta2"))
        state = self.filter.look(q, (theta[0], theta[1]))
        laws = self._laws()
        target, calm = self._target(seen.time, state), self._calm(seen.time)
        given = self.control.step(
            state,
            laws,
            target,
            trusted=calm,
            search=self.task.excitation.at(seen.time, self._still),
        )
        if given.decoupled and self.handed_over is None:
            self.handed_over = seen.time
        one, two = given.torques.tolist()
        told = self.estimator.update(q=q, theta1=theta[0], theta2=theta[1], tau1=one, tau2=two)
        self._judge(told)
        if calm:
            self.filter.push(state, laws, (one, two))
        self.rows.append((
            target.q[0], target.sigma[0], float(told.stiffness[0]), float(told.stiffness_std[0]),
            one, two, float(told["verdict"][0]), float(given.decoupled), float(given.flags),
        ))  # fmt: skip
        return given.torques[np.newaxis]

    def _calm(self, time: float) -> bool:
        """Return whether the estimate is trusted, and the excitation that made it so is over."""
        if self._still is None and self._trusted and time >= self.task.excite:
            self._still = time + CALM
        return self._trusted and self._still is not None and time >= self._still

    def _laws(self) -> tuple[ElasticLaw, ElasticLaw]:
        first, second = self.estimator.laws(0)
        return first, second

    def _target(self, time: float, state: JointState) -> Target:
        if self.handed_over is None:
            sigma = 0.0 if self._told is None else float(self._told.stiffness[0])
            self._from = (state.q, sigma)
            return self.task.target(0.0, *self._from)
        return self.task.target(time - self.handed_over, *self._from)

    def _judge(self, told: Told) -> None:
        """Trust an estimate from when it is informative until it is starved or inconsistent."""
        self._told = told
        verdict = told.verdict[0]
        if verdict == "inconsistent" and self.settings.lenient:
            narrow = 1.96 * told.stiffness_std[0] < _NARROW * told.stiffness[0]
            self._trusted = bool(narrow)
        else:
            self._trusted = verdict == "informative" or (self._trusted and verdict == "converging")


def run_stiffness_loop(
    device: Device,
    task: StiffnessTask,
    estimator: Mapping[str, Any],
    *,
    seconds: float,
    settings: LoopSettings | None = None,
    plant: Device | None = None,
    seed: int = 0,
    substeps: int | None = None,
) -> StiffnessRun:
    """Return what a simulated joint does under control on its estimated stiffness.

    It starts at rest, the springs relaxed. Encoders show the device's counts.

    Parameters
    ----------
    device
        One antagonistic joint, as controller and estimator know it.
    task
        Excitation and references.
    estimator
        Arguments of `rotatum.Estimator` beside the period: method, cutoff, ...
    seconds
        Of the run.
    settings
        Of the loop.
    plant
        The joint that is simulated; None: `device`.
    seed
        Of the sensors' noise.
    substeps
        Integration steps a period; chosen for the plant if not given.

    Raises as `StiffnessLoop` and `rotatum.simulation.simulate` do.
    """
    used = settings or LoopSettings()
    loop = StiffnessLoop(device, task, used, estimator, seed=seed)
    log = simulate(
        plant or device,
        seconds=seconds,
        period=used.period,
        drives=ArmControl(loop, device.joints).drives(),
        substeps=substeps,
        seed=seed,
    )
    joint = log.joints[device.joints[0].name]
    rows = np.array(loop.rows[: log.samples])
    return StiffnessRun(
        time=log.time,
        q=joint["q_true"],
        sigma=joint["stiffness_true"],
        columns=dict(zip(_COLUMNS, rows.T, strict=False)),
        verdict=rows[:, 6].astype(np.int64),
        decoupled=rows[:, 7].astype(np.bool_),
        flags=rows[:, 8].astype(np.int64),
        handed_over=loop.handed_over,
    )

"""Poles and constants of an observer, tuned together until its states match known ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import LogError, MethodError, check_names
from rotatum.estimators.full_state.design import Design
from rotatum.estimators.full_state.links import links_of
from rotatum.estimators.full_state.poles import Pair
from rotatum.estimators.full_state.stage import (
    designs_of,
    fill_luenberger,
    luenberger_params,
    luenberger_stage,
    pole_pairs,
)
from rotatum.evaluation.inputs import log_names
from rotatum.kernels.status import SETTLING
from rotatum.logs import Log
from rotatum.models import Device
from rotatum.models.joint import Joint
from rotatum.record import Records
from rotatum.runtime.bank import Bank

__all__ = ["Matched", "match_observer"]

Array = NDArray[np.float64]

POLES = ("frequency", "damping")
CONSTANTS = ("stiffness", "inertia", "spring_damping", "motor_damping")
VARIED = (*POLES, *CONSTANTS)
_FIELDS = {"stiffness": "stiffness", "inertia": "inertia", "spring_damping": "damping",
           "motor_damping": "motor_damping"}  # fmt: skip
_STATES = (
    ("deflection", "phi"),
    ("dq_hat", "dq"),
    ("theta_hat", "theta"),
    ("dtheta_hat", "dtheta"),
)
_FASTEST = 0.3  # of pi / period
_SLOWEST = 10.0  # rad/s
_DAMPINGS = (0.4, 1.5)
_AT = 1e-3  # of the way: a value nearer to its bound is at it


class Matched(NamedTuple):
    """What one joint's observer came to.

    Args:
        design: its poles and constants.
        varied: name to value: ``frequency`` [rad/s], ``damping``, ``stiffness`` [N m/rad],
            ``inertia`` [kg m^2], ``spring_damping``, ``motor_damping`` [N m s/rad], at the joint.
        at_bound: names of those that ended at a bound: the data ask for more.
        before, after: state to the root mean square of its error, over the largest true one.
    """

    design: Design
    varied: dict[str, float]
    at_bound: tuple[str, ...]
    before: dict[str, float]
    after: dict[str, float]


def match_observer(
    log: Log,
    device: Device,
    *,
    vary: Sequence[str] = ("frequency", "damping", "stiffness"),
    within: float = 0.3,
    accelerations: str | None = None,
) -> dict[str, Matched]:
    """Tune poles and constants of each joint's observer on a log with known states.

    Least squares of the errors of deflection, link and motor velocity and motor position, each over
    the largest true one; joint by joint, because the observers are decoupled once the links'
    accelerations are known, here from the sensors at the true poses (deluca2007 section V-A, whose
    objectives and bounds are not printed). Both pairs of poles are alike. The poles start at the
    defaults, the constants at the device's, and stay within ``within`` of it.

    Args:
        log: with ``q_true``, ``dq_true``, ``theta_true`` and ``dtheta_true`` of every joint
            (``read_log(..., true_states=True)``, or named in ``[channels]``).
        device: as for ``observe``; laws are taken at rest, as straight lines.
        vary: of `VARIED`. Spring damping can only be varied where it is not 0, as motor damping.
        within: constants stay between 1 / (1 + within) and 1 + within times the device's.
        accelerations: as for ``observe``.

    Returns:
        Joint to what it came to.

    Raises:
        MethodError: no such quantity, nothing to vary, or a device that cannot be observed.
        LogError: the log lacks a true state.
    """
    if not vary:
        raise MethodError("nothing is to be varied", where="vary", allowed=VARIED)
    check_names(vary, VARIED, what="no such quantity", where="vary")
    if not within > 0.0:
        raise MethodError("must be above 0", where="within", value=within)
    names = log_names(log, device)
    links = links_of(device, accelerations, None, gyroscopes=False)
    own = [log.joints[names[joint.name]] for joint in device.joints]
    for joint, roles in zip(device.joints, own, strict=True):
        missing = [r for r in ("q_true", "dq_true", "theta_true", "dtheta_true", "theta", "tau")
                   if r not in roles]  # fmt: skip
        if missing:
            raise LogError(f"joint {joint.name} lacks {', '.join(missing)}", where=log.source)
    readings = np.column_stack([_column(log, names, column) for column in links.columns])
    q, dq = (np.column_stack([roles[role] for roles in own]) for role in ("q_true", "dq_true"))
    told = [links.tell(q[k], dq[k], readings[k]) for k in range(log.samples)]
    pairs = pole_pairs(device.joints, log.period, None, Pair().damping, {})
    holds = {j.name: log.holds.get(names[j.name], {}).get("tau") == "held" for j in device.joints}
    designs = designs_of(device.joints, log.period, pairs, gyro=0.0,
                         turning=np.zeros(len(own), dtype=bool), holds=holds)  # fmt: skip
    found = {}
    for i, (joint, roles, design) in enumerate(zip(device.joints, own, designs, strict=True)):
        run = _Joint(joint, design, log.time, roles)
        run.u["acceleration"][:, 0] = [each.acceleration[i] for each in told]
        run.u["coupling"][:, 0] = [each.coupling[i] for each in told]
        found[joint.name] = run.matched(tuple(vary), within)
    return found


class _Joint:
    """One joint's observer and its inputs, run again and again."""

    def __init__(
        self, joint: Joint, design: Design, time: Array, roles: Mapping[str, Array]
    ) -> None:
        stage = luenberger_stage(guard=False)
        self.design = design
        self.bank = Bank(stage, luenberger_params(stage, [joint], [design]))
        self.u = stage.input.zeros(len(time), 1)
        self.u["time"][:, 0], self.u["seen"] = time, 1
        zero = joint.transmission.zero
        shift = float(zero) if isinstance(zero, float | int) else 0.0
        self.u["theta"][:, 0] = roles["theta"] + shift
        self.u["torque"][:, 0] = roles["tau"]
        self.u["rest"] = roles["q_true"][0] - self.u["theta"][0, 0]
        self.true = {
            "phi": roles["q_true"] - roles["theta_true"] - shift, "dq": roles["dq_true"],
            "theta": roles["theta_true"] + shift, "dtheta": roles["dtheta_true"],
        }  # fmt: skip
        self.size = {k: float(np.ptp(x)) or 1.0 for k, x in self.true.items()}

    def states(self, design: Design) -> Records:
        """(N,) records of the observer of a design."""
        fill_luenberger(self.bank.params[0], design)
        self.bank.reset()
        return self.bank.run(self.u)[:, 0]

    def errors(self, design: Design) -> dict[str, Array]:
        """Errors over the range of the truth, of samples past the slowest start."""
        states = self.states(design)
        late = slice(int(np.argmax((states["status"] & SETTLING) == 0)), None)
        return {
            key: ((states[field] - self.true[key]) / self.size[key])[late] for field, key in _STATES
        }

    def matched(self, vary: tuple[str, ...], within: float) -> Matched:
        from scipy.optimize import least_squares

        start, low, high = self._range(vary, within)

        def residuals(x: Array) -> Array:
            errors = self.errors(self._at(vary, x))
            # From the end: a slower start leaves fewer samples.
            return np.concatenate([self._padded(each) for each in errors.values()])

        fit = least_squares(residuals, np.log(start), bounds=(np.log(low), np.log(high)),
                            x_scale=0.1, diff_step=1e-4)  # fmt: skip
        values = np.exp(fit.x)
        edge = _AT * (np.log(high) - np.log(low))
        ends = (fit.x - np.log(low) < edge) | (np.log(high) - fit.x < edge)
        design = self._at(vary, fit.x)
        return Matched(
            design, dict(zip(vary, values.tolist(), strict=True)),
            tuple(name for name, end in zip(vary, ends, strict=True) if end),
            _rms(self.errors(self.design)), _rms(self.errors(design)),
        )  # fmt: skip

    def _padded(self, errors: Array) -> Array:
        found = np.zeros(len(self.u))
        found[len(found) - len(errors) :] = errors
        return found

    def _range(self, vary: tuple[str, ...], within: float) -> tuple[Array, Array, Array]:
        """Where each quantity starts, and between what it stays."""
        rows = []
        for name in vary:
            if name == "frequency":
                fastest = _FASTEST * np.pi / self.design.period
                at = min(self.design.pairs[0].frequency, 0.9 * fastest)
                rows.append((at, _SLOWEST, fastest))
            elif name == "damping":
                rows.append((self.design.pairs[0].damping, *_DAMPINGS))
            else:
                value = getattr(self.design.drivetrain, _FIELDS[name])
                if not value > 0.0:
                    raise MethodError("a constant that is 0 cannot be varied by a factor",
                                      where=name, value=value)  # fmt: skip
                rows.append((value, value / (1.0 + within), value * (1.0 + within)))
        start, low, high = np.array(rows, dtype=np.float64).T
        return start, low, high

    def _at(self, vary: tuple[str, ...], x: Array) -> Design:
        values = dict(zip(vary, np.exp(x).tolist(), strict=True))
        first = self.design.pairs[0]
        pair = Pair(values.get("frequency", first.frequency), values.get("damping", first.damping))
        own = {_FIELDS[name]: values[name] for name in CONSTANTS if name in values}
        drivetrain = self.design.drivetrain._replace(**own)
        return self.design._replace(pairs=(pair, pair), drivetrain=drivetrain)


def _rms(errors: dict[str, Array]) -> dict[str, float]:
    return {key: float(np.sqrt(np.mean(each**2))) for key, each in errors.items()}


def _column(log: Log, names: dict[str, str], column: str) -> Array:
    """Return what a column of the links' sensors holds."""
    owner, _, axis = column.rpartition(".")
    source = log.joints[names[owner]] if axis == "acc" else log.inertial.get(owner, {})
    if axis not in source:
        raise LogError(f"the log lacks the readings {column}", where=log.source)
    return source[axis]

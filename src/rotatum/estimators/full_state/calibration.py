"""What is wrong with a mounted accelerometer: bias, misalignment, scale and delay."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import MethodError
from rotatum.estimators.full_state.regression import NAMES, PRIOR, TOLD, fit_readings, fitted_mask
from rotatum.models.inertial import Accelerometer
from rotatum.models.robot.accelerations import AccelerometerMap
from rotatum.models.robot.interface import Robot
from rotatum.models.rotations import rotation_about, rotation_of, rpy_of

__all__ = ["Calibration", "calibrate_static", "prior_of", "whole_sensor"]

Array = NDArray[np.float64]

_UNITS = ("m/s^2",) * 3 + ("rad",) * 3 + ("",) * 3 + ("s",)
ANGLE = 1e-4
"""rad: how well the links' angles are known at rest, springs and encoders together."""


@dataclass(frozen=True, eq=False)
class Calibration:
    """Errors of one accelerometer: ``y = (1 + s) * R(e)^T f(t - delay) + b`` of the force f.

    f is the specific force in the axes the device file gives; e turns the sensor in its own axes.

    Attributes:
        sensor: as the device file has it.
        values: (10,) bias b [m/s^2], misalignment e [rad], scale s, each of x, y, z; delay of the
            readings behind the encoders [s]. What the data do not tell, or was not fitted, is 0.
        covariance: (10, 10), for serially correlated residuals too; a parameter that is not told
            has the prior's variance.
        residual: rms of what is left of the readings [m/s^2].
        rows: number of readings used, per axis.
    """

    sensor: Accelerometer
    values: Array
    covariance: Array
    residual: float
    rows: int

    @property
    def std(self) -> Array:
        """Standard deviations, (10,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def bias(self) -> Array:
        """(3,) m/s^2, to be subtracted."""
        return self.values[:3]

    @property
    def misalignment(self) -> Array:
        """(3,) rad, rotation vector in the sensor's own axes."""
        return self.values[3:6]

    @property
    def delay(self) -> float:
        """How late the readings are against the encoders [s]."""
        return float(self.values[9])

    @property
    def determined(self) -> tuple[str, ...]:
        """Names of the parameters whose deviation the data shrank below a tenth of the prior's."""
        told = self.std < TOLD * PRIOR
        return tuple(name for name, yes in zip(NAMES, told, strict=True) if yes)

    def mounted(self) -> Accelerometer:
        """Return the sensor as it really sits, for the device file."""
        turn = rotation_of(self.sensor.rpy) @ rotation_about(self.misalignment)
        return self.sensor.model_copy(update={"rpy": rpy_of(turn)})

    def correct(self, readings: Array) -> Array:
        """Return readings (..., axes of the sensor) [m/s^2] without bias and scale.

        They are those of `mounted`, `delay` ago.
        """
        at = ["xyz".index(axis) for axis in self.sensor.axes]
        corrected: Array = (readings - self.bias[at]) / (1.0 + self.values[6:9][at])
        return corrected

    def to_json(self) -> dict[str, Any]:
        """Its object in ``--json``: name to value and standard deviation, of what the data tell."""
        numbers = zip(NAMES, self.values.tolist(), self.std.tolist(), strict=True)
        return {name: [value, std] for name, value, std in numbers if name in self.determined}

    def text(self) -> str:
        """Return a table: value, standard deviation, and whether the data tell it."""
        told = self.determined
        lines = [f"{self.sensor.name}: {self.rows} rows, {self.residual:.3g} m/s^2 left"]
        for name, value, std, unit in zip(NAMES, self.values, self.std, _UNITS, strict=True):
            if name in told:
                lines.append(f"  {name:15s} {value:+.6f} +- {std:.6f} {unit}".rstrip())
        untold = [name for name in NAMES if name not in told]
        if untold:
            lines.append(f"  not told, or not fitted: {', '.join(untold)}")
        return "\n".join(lines)


def calibrate_static(
    robot: Robot,
    sensor: Accelerometer,
    q: Array,
    readings: Array,
    std: Array | float,
    *,
    fit: Sequence[str] = ("bias", "misalignment"),
    angle_std: float = ANGLE,
    prior: Calibration | None = None,
) -> Calibration:
    """Fit what a sensor shows in static poses to gravity in its axes, ``R^T g0``.

    Weighted least squares with a prior, at 0 and as wide as `PRIOR`: what the poses tell hardly
    feels it, and what they do not stays there, with its deviation. A pose tells three numbers at
    most. Three poses that turn the sensor about a level axis by different angles tell all six of
    bias and misalignment; the arm's first axis, if upright, tells nothing.

    Args:
        robot: the arm.
        sensor: as the device file has it.
        q: (K, n) rad, links; `links_at_rest` has them from motors.
        readings: (K, A) m/s^2, means over each pose, of the sensor's axes.
        std: (K, A) or one, m/s^2, of these means.
        fit: some of "bias", "misalignment", "scale".
        angle_std: rad, of the links' angles.
        prior: an earlier calibration of the same sensor; None: `PRIOR`.

    Raises:
        MethodError: readings of another size, no pose, or an unknown parameter.
    """
    if not len(q) or readings.shape != (len(q), len(sensor.axes)):
        raise MethodError(
            "static poses need a reading for each axis",
            where=sensor.name,
            value=readings.shape,
            allowed=f"({len(q)}, {len(sensor.axes)}), at least one pose",
        )
    at = AccelerometerMap(robot, [whole_sensor(sensor)])
    still = np.zeros(robot.size)
    force = np.array([at.rest(pose, still) for pose in q])
    weight = float(np.linalg.norm(robot.gravity_vector))
    deviation = np.broadcast_to(np.hypot(std, weight * angle_std), readings.shape)
    found = fit_readings(
        lambda _: (force, np.zeros_like(force)),
        readings,
        deviation,
        ["xyz".index(axis) for axis in sensor.axes],
        fitted_mask(fit, ("bias", "misalignment", "scale")),
        *prior_of(prior),
        colour=None,
    )
    return Calibration(sensor, found.values, found.covariance, found.residual, len(q))


def prior_of(earlier: Calibration | None) -> tuple[Array, Array]:
    """Return mean and covariance to start from."""
    if earlier is None:
        return np.zeros(len(NAMES)), np.diag(PRIOR**2)
    return earlier.values, earlier.covariance


def whole_sensor(sensor: Accelerometer) -> Accelerometer:
    """Return the sensor with all three axes: a misalignment mixes them."""
    return sensor.model_copy(update={"axes": ("x", "y", "z")})

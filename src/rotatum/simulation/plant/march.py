"""A plant at an instant, and how it moves on."""

from __future__ import annotations

from collections.abc import Mapping

from rotatum.record import Records
from rotatum.runtime.bank import Bank
from rotatum.simulation.plant.bodies import Plant
from rotatum.simulation.plant.params import drive_of, plant_params
from rotatum.simulation.plant.records import QUASI_STATIC
from rotatum.simulation.plant.stage import plant_stage
from rotatum.simulation.plant.steps import choose_substeps

__all__ = ["March", "at_rest"]


def at_rest(plant: Plant, start: Mapping[str, float]) -> tuple[float, ...]:
    """Return the stiffness of each transmission [N m/rad] at no deflection, where it starts."""
    return plant.rest_stiffness(plant.offset + plant.slope * start.get("setpoint_angle", 0.0))


class March:
    """A plant at an instant, moved on sample by sample, so that its drives can look at it between.

    Parameters
    ----------
    plant
        What moves.
    period
        Of the samples [s].
    start
        Positions [rad] under their roles ("q", "theta", "setpoint_angle") and velocities [rad/s]
        under "d" and the role; what is not named is zero.
    substeps
        Runge-Kutta steps per sample; chosen for the plant at rest if not given.
    prescribed
        Whether the set-point's angle is given, not a torque on its motor.

    Attributes
    ----------
    substeps
        Runge-Kutta steps per sample.
    quasi_static
        Whether the set-point motor is taken without its inertia.

    Raises `RotatumError` as `choose_substeps` does, and for a start the joint does not have.
    """

    def __init__(
        self,
        plant: Plant,
        period: float,
        *,
        start: Mapping[str, float] | None = None,
        substeps: int | None = None,
        prescribed: bool = True,
    ) -> None:
        start = start or {}
        self.substeps = choose_substeps(plant, period, at_rest(plant, start), substeps)
        step = period / self.substeps
        drive = drive_of(plant, step, prescribed=prescribed)
        self.quasi_static = drive == QUASI_STATIC
        params = plant_params(plant, start, step=step, substeps=self.substeps, drive=drive)
        self._bank = Bank(plant_stage(plant.springs), params)

    @property
    def state(self) -> Records:
        """Its state (1,), `rotatum.simulation.plant.records.PlantState`; a view."""
        return self._bank.state

    def inputs(self, samples: int) -> Records:
        """Return inputs (samples,), all zero; `rotatum.simulation.plant.run.write_inputs` fills."""
        return self._bank.stage.input.zeros(samples)

    def outputs(self, samples: int) -> Records:
        """Return outputs (samples,) to be written to."""
        return self._bank.stage.output.zeros(samples)

    def step(self, u: Records, out: Records) -> None:
        """Write where the plant is to `out` (1,), and move it on by a sample under `u` (1,)."""
        self._bank.update(u, out)

    def run(self, u: Records) -> Records:
        """Return where the plant was at each of N samples under `u` (N,)."""
        return self._bank.run(u.reshape(-1, 1))[:, 0]

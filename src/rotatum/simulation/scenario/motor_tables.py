"""Laws that drive all motors of a joint, as a scenario writes them under `drives.motors`."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from rotatum.models.table import Real
from rotatum.simulation.drivers.commands import co_contraction, position_drives
from rotatum.simulation.drivers.compensation import GravityCompensation
from rotatum.simulation.drivers.control import Gains
from rotatum.simulation.drivers.feedback import Feedback
from rotatum.simulation.scenario.drive_tables import AnyDrive, as_path
from rotatum.simulation.scenario.part import Part

if TYPE_CHECKING:
    from rotatum.models.joint import Joint

__all__ = ["AnyLaw", "LawTable"]


class GainsTable(Part):
    """Gains of one motor at the joint: `kp` [N m/rad], `kd` [N m s/rad]."""

    kp: Real
    kd: Real


class LawTable(Part):
    """A law for all motors of a joint.

    bandwidth [rad/s] and damping: one for all motors, or one for each; gains: in their place;
    gravity: at which angle it is compensated, left out: not at all.
    """

    damping: Real | tuple[Real, ...] = 1.0
    gravity: Literal["link", "motor"] | None = None

    @abstractmethod
    def feedback(
        self, joint: Joint, index: int, gravity: GravityCompensation | None, seed: int
    ) -> dict[str, Feedback]:
        """Make role -> feedback.

        Parameters
        ----------
        joint, index : of the device, and its place there.
        gravity : that of the device, at the angles `self.gravity` asks for.
        seed : of random paths that give none themselves.

        Raises `RotatumError` for a law the joint cannot have.
        """


class PositionTable(LawTable):
    """Follow a path; antagonistic joints with a preset between their motors."""

    kind: Literal["position"]
    path: AnyDrive
    preset: AnyDrive | None = None
    bandwidth: Real | tuple[Real, ...] | None = None
    gains: tuple[GainsTable, ...] | None = None

    def feedback(
        self, joint: Joint, index: int, gravity: GravityCompensation | None, seed: int
    ) -> dict[str, Feedback]:
        """Make the controllers."""
        preset = self.preset
        return dict(
            position_drives(
                joint,
                as_path(self.path.drive(seed), self.path.kind),
                bandwidth=self.bandwidth,
                damping=self.damping,
                gains=None if self.gains is None else [Gains(g.kp, g.kd) for g in self.gains],
                preset=None if preset is None else as_path(preset.drive(seed + 1), preset.kind),
                gravity=gravity,
                index=index,
            )
        )


class CoContractionTable(LawTable):
    """Stand at a position while the preset moves."""

    kind: Literal["co-contraction"]
    preset: AnyDrive
    bandwidth: Real | tuple[Real, ...]
    position: Real = 0.0

    def feedback(
        self, joint: Joint, index: int, gravity: GravityCompensation | None, seed: int
    ) -> dict[str, Feedback]:
        """Make the controllers."""
        return dict(
            co_contraction(
                joint,
                position=self.position,
                bandwidth=self.bandwidth,
                damping=self.damping,
                preset=as_path(self.preset.drive(seed), self.preset.kind),
                gravity=gravity,
                index=index,
            )
        )


AnyLaw = Annotated[PositionTable | CoContractionTable, Field(discriminator="kind")]
"""Any law, told apart by its `kind`."""

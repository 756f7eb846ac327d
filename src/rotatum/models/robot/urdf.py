"""Serial arms from URDF files, through pinocchio."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotatum.errors import DeviceError, ExtraError
from rotatum.models.robot.interface import FrameMotion, Pose, Robot
from rotatum.models.robot.names import no_such
from rotatum.models.robot.payload import Payload
from rotatum.models.robot.urdf_plain import plain_urdf
from rotatum.models.robot.urdf_tree import read_tree

__all__ = ["UrdfRobot"]

Array = NDArray[np.float64]


class UrdfRobot(Robot):
    """A serial arm of revolute (or continuous) joints; its frames are the links of the file.

    The world is the base link's frame, gravity along its -z. Nothing is done by differences: rates
    are made of the analytic derivatives of inverse dynamics (Carpentier and Mansard 2018). One
    object must not be used by two threads at once.

    Parameters
    ----------
    text : of the URDF.
    joints : names of its joints, in the order along the arm; None: all that are not fixed.
    locked : the others -> angle they are locked at [rad], 0 if not named.
    gravity : m/s^2.
    source : where the text is from, for messages.
    payloads : bodies fixed to its frames.
    names : what to call the joints; None: as the file does.

    Raises
    ------
    DeviceError for a text that is no serial arm with positive masses and inertias; ExtraError where
    pinocchio is not installed.
    """

    def __init__(
        self,
        text: str,
        joints: Sequence[str] | None = None,
        locked: Mapping[str, float] | None = None,
        gravity: float = 9.81,
        source: str = "URDF",
        payloads: tuple[Payload, ...] = (),
        names: Sequence[str] | None = None,
    ) -> None:
        if not (np.isfinite(gravity) and gravity >= 0.0):
            raise DeviceError("gravity must be at least 0", where=source, value=gravity)
        tree = read_tree(text, source)
        chosen = tree.arm(joints)
        held = tree.check_locked(chosen, locked or {})
        self.names = chosen if names is None else tuple(names)
        self.frames = tuple(tree.links)
        self.gravity_vector = np.array([0.0, 0.0, -float(gravity)])
        self._recipe = (text, chosen, held, gravity, source, payloads, self.names)
        self._pin = pin = _pinocchio()
        self._model = model = self._build(plain_urdf(tree), held, payloads, source)
        model.gravity.linear = self.gravity_vector
        self._data = model.createData()
        self._free = free = model.copy()
        free.gravity.linear = np.zeros(3)
        self._free_data = free.createData()
        self._still = np.zeros(self.size)
        self._lower = np.tril_indices(self.size, -1)
        self._ids = {name: model.getFrameId(name, pin.FrameType.BODY) for name in self.frames}

    def __reduce__(self) -> tuple[type[UrdfRobot], tuple[Any, ...]]:
        return UrdfRobot, self._recipe

    def _build(
        self, plain: str, held: Mapping[str, float], payloads: tuple[Payload, ...], source: str
    ) -> Any:
        """Return pinocchio's model of the arm."""
        pin = self._pin
        try:
            whole = pin.buildModelFromXML(plain)
        except (RuntimeError, ValueError) as error:
            raise DeviceError(f"pinocchio cannot read it ({error})", where=source) from None
        at = np.zeros(whole.nq)
        for name, angle in held.items():
            at[whole.joints[whole.getJointId(name)].idx_q] = angle
        model = pin.buildReducedModel(whole, [whole.getJointId(name) for name in held], at)
        for load in payloads:
            frame = model.frames[model.getFrameId(load.frame, pin.FrameType.BODY)]
            body = pin.Inertia(load.mass, load.position, load.inertia)
            model.appendBodyToJoint(frame.parentJoint, body, frame.placement)
        return model

    def mass(self, q: Array) -> Array:
        """Return M(q), (n, n) kg m^2."""
        m: Array = self._pin.crba(self._model, self._data, q).copy()
        # Some versions fill the upper triangle only.
        m[self._lower] = m.T[self._lower]
        return m

    def coriolis(self, q: Array, dq: Array) -> Array:
        """Return C(q, q') of the Christoffel symbols, (n, n) N m s/rad."""
        c: Array = self._pin.computeCoriolisMatrix(self._model, self._data, q, dq)
        return c.copy()

    def gravity(self, q: Array) -> Array:
        """Return g(q), (n,) N m."""
        g: Array = self._pin.computeGeneralizedGravity(self._model, self._data, q)
        return g.copy()

    def bias(self, q: Array, dq: Array) -> Array:
        """Return C(q, q') q' + g(q), (n,) N m."""
        b: Array = self._pin.nonLinearEffects(self._model, self._data, q, dq)
        return b.copy()

    def coriolis_transposed(self, q: Array, dq: Array) -> Array:
        """Return C(q, q')^T q', (n,) N m, as dT/dq: P^T q' / 2, P = d(M(q) w)/dq at w = q'."""
        slopes = self._pin.computeRNEADerivatives(self._free, self._free_data, q, self._still, dq)
        product: Array = dq @ slopes[0]
        return 0.5 * product

    def momentum(self, q: Array, dq: Array) -> tuple[Array, Array]:
        """Return p = M(q) q' and C(q, q')^T q', (n,) N m s and (n,) N m, from one call."""
        force = self.coriolis_transposed(q, dq)
        # What was differentiated is M(q) w at w = q'.
        p: Array = self._free_data.tau.copy()
        return p, force

    def mass_rate(self, q: Array, dq: Array) -> Array:
        """Return dM/dt = C + C^T, (n, n) kg m^2/s."""
        c: Array = self._pin.computeCoriolisMatrix(self._model, self._data, q, dq)
        return c + c.T

    def gravity_gradient(self, q: Array) -> Array:
        """Return dg/dq, (n, n) N m/rad."""
        slope: Array = self._pin.computeGeneralizedGravityDerivatives(self._model, self._data, q)
        return slope.copy()

    def coriolis_rate(self, q: Array, dq: Array, ddq: Array) -> Array:
        """Return (dC/dt) q' = d(C q')/dt - C q'', (n,) N m/s."""
        by_q, by_dq, _ = self._pin.computeRNEADerivatives(
            self._free, self._free_data, q, dq, self._still
        )
        whole: Array = by_q @ dq + by_dq @ ddq
        return whole - self.coriolis(q, dq) @ ddq

    def inverse_dynamics(self, q: Array, dq: Array, ddq: Array) -> Array:
        """Return M q'' + C q' + g, (n,) N m."""
        tau: Array = self._pin.rnea(self._model, self._data, q, dq, ddq)
        return tau

    def inverse_dynamics_rate(self, q: Array, dq: Array, ddq: Array, dddq: Array) -> Array:
        """Return d/dt (M q'' + C q' + g) along the motion, (n,) N m/s (trumic2022 eq. 9)."""
        slopes = self._pin.computeRNEADerivatives(self._model, self._data, q, dq, ddq)
        rate: Array = slopes[0].dot(dq)
        rate += slopes[1].dot(ddq)
        rate += slopes[2].dot(dddq)
        return rate

    def accelerate(self, q: Array, dq: Array, torque: Array) -> Array:
        """Return q'' = M^-1 (torque - C q' - g), (n,) rad/s^2."""
        ddq: Array = self._pin.aba(self._model, self._data, q, dq, torque)
        return ddq

    def kinetic_energy(self, q: Array, dq: Array) -> float:
        """Return q'^T M q' / 2 [J]."""
        return float(self._pin.computeKineticEnergy(self._model, self._data, q, dq))

    def potential_energy(self, q: Array) -> float:
        """Return the energy of gravity [J], 0 with every centre of mass at the base's height."""
        return float(self._pin.computePotentialEnergy(self._model, self._data, q))

    def pose(self, frame: str, q: Array) -> Pose:
        """Return where a frame is."""
        at = self._id(frame)
        self._pin.forwardKinematics(self._model, self._data, q)
        placed = self._pin.updateFramePlacement(self._model, self._data, at)
        return Pose(np.array(placed.rotation), np.array(placed.translation))

    def jacobian(self, frame: str, q: Array) -> Array:
        """Return the (6, n) Jacobian of a frame's origin: velocity, then angular velocity."""
        axes = self._pin.LOCAL_WORLD_ALIGNED
        at = self._id(frame)
        return np.array(self._pin.computeFrameJacobian(self._model, self._data, q, at, axes))

    def motion(self, frame: str, q: Array, dq: Array, ddq: Array) -> FrameMotion:
        """Return how a frame moves."""
        pin, model, data, at = self._pin, self._model, self._data, self._id(frame)
        pin.forwardKinematics(model, data, q, dq, ddq)
        pin.updateFramePlacement(model, data, at)
        speed = pin.getFrameVelocity(model, data, at, pin.LOCAL_WORLD_ALIGNED)
        change = pin.getFrameClassicalAcceleration(model, data, at, pin.LOCAL_WORLD_ALIGNED)
        return FrameMotion(
            np.array(speed.linear), np.array(speed.angular),
            np.array(change.linear), np.array(change.angular),
        )  # fmt: skip

    def with_payload(
        self,
        frame: str,
        mass: float,
        position: Sequence[float] = (0.0, 0.0, 0.0),
        inertia: Sequence[Sequence[float]] | None = None,
    ) -> Robot:
        """Return the arm with a body fixed to a frame.

        Raises
        ------
        DeviceError if there is no such frame, or no such body.
        """
        load = Payload.checked(frame, mass, position, inertia, self.frames)
        text, chosen, held, gravity, source, payloads, names = self._recipe
        return UrdfRobot(text, chosen, held, gravity, source, (*payloads, load), names)

    def _id(self, frame: str) -> int:
        """Find a frame."""
        if frame not in self._ids:
            raise no_such("frame", frame, self.frames, where=self._recipe[4])
        return int(self._ids[frame])


def _pinocchio() -> ModuleType:
    """Import pinocchio, or say how to get it."""
    try:
        import pinocchio
    except ImportError:
        raise ExtraError("arms from URDF files need pinocchio", extra="urdf") from None
    module: ModuleType = pinocchio
    return module

"""How stiff an arm on elastic joints is at one of its frames (trumic2022, Remark 2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotatum.errors import DeviceError, RotatumError, check_names
from rotatum.models.robot.interface import Robot

__all__ = ["DIRECTIONS", "CartesianStiffness", "cartesian_stiffness"]

Array = NDArray[np.float64]

DIRECTIONS = ("x", "y", "z", "rx", "ry", "rz")
_NOWHERE = (0.0, 0.0, 0.0)
# Of the sixteen digits of a double, solving where this is left of the largest leaves four.
_SINGULAR = 1e-12


@dataclass(frozen=True, eq=False)
class CartesianStiffness:
    """Stiffness of an arm at a frame, with the motors held.

    Units by the directions: N/m, N/rad and N m/rad of the stiffness, their inverses of the
    compliance. Row i, column j: force in direction i for a displacement in direction j alone.

    Attributes
    ----------
    directions : names of rows and columns: x, y, z along the world's axes [m], rx, ry, rz about
        them [rad].
    matrix : (m, m), sigma_c. Infinite on the diagonal of a fixed direction, NaN in the rest of its
        row and column; all NaN if the arm moves inside itself without resistance.
    std : (m, m), of each entry of `matrix`, from those of the joints; None: none were given.
    compliance : (m, m), J K^-1 J^T, displacements for forces; finite in every pose, also where
        `matrix` is not; NaN if K is singular.
    compliance_std : (m, m), of each entry of `compliance`; or None.
    joint_stiffness : (n, n) N m/rad, K = sigma - J_q^T f + G_q.
    stable : whether K resists every displacement of the joints: its symmetric part is positive
        definite. If not, the arm does not stay where it is.
    fixed : directions with a part that the frame cannot move along in this pose.
    rank : number of independent directions it can move along, of those asked for.
    condition : of the Jacobian's rows of these directions, positions over `length`; inf with more
        directions than joints. This times an error of q [rad] is about the relative error of
        `matrix`.
    length : m, the largest distance of the frame from a joint's axis; 1 if it is on all.
    """

    directions: tuple[str, ...]
    matrix: Array
    std: Array | None
    compliance: Array
    compliance_std: Array | None
    joint_stiffness: Array
    stable: bool
    fixed: tuple[str, ...]
    rank: int
    condition: float
    length: float

    @property
    def symmetric(self) -> Array:
        """Return (sigma_c + sigma_c^T) / 2, (m, m)."""
        return 0.5 * (self.matrix + self.matrix.T)

    @property
    def antisymmetric(self) -> Array:
        """Return sigma_a = (sigma_c - sigma_c^T) / 2, (m, m); NaN where the matrix is not finite.

        0 without a moment. With one, where rx, ry and rz are all asked for, it is
        ``-[moment]x / 2`` on these and 0 elsewhere: finite rotations do not commute, and a moment
        that keeps its axes has no potential (ciblak1994).
        """
        with np.errstate(invalid="ignore"):
            part: Array = 0.5 * (self.matrix - self.matrix.T)
        return part


def cartesian_stiffness(
    robot: Robot | None,
    frame: str,
    q: ArrayLike,
    stiffness: ArrayLike,
    *,
    stiffness_std: ArrayLike | None = None,
    force: ArrayLike = _NOWHERE,
    moment: ArrayLike = _NOWHERE,
    directions: Sequence[str] = ("x", "y", "z"),
    tolerance: float = 1e-4,
) -> CartesianStiffness:
    """Return the stiffness at a frame of an arm at rest, its motors (and set-points) held.

    The arm rests where ``tau_e(q - theta) + g(q) = J^T f``. A small change of the wrench f, else
    constant in the world, moves it by ``K dq = J^T df``, so that (trumic2022, Remark 2)::

        K = sigma - J_q^T f + G_q,    sigma_c = J^-T K J^-1

    with the gravity's gradient G_q and J_q^T f = d(J^T f)/dq. Departures from the paper, which has
    a square J that can be inverted: here J^-1 is the K-weighted right inverse
    ``J# = K^-1 J^T (J K^-1 J^T)^-1`` on what the frame can move along. It is J^-1 where there is
    one. An arm with more joints than directions moves inside itself until no force is left along
    that; the Moore-Penrose inverse would hold it there, and call the arm too stiff. Directions
    not asked for are free: no force changes along them. sigma_c is then the inverse of the
    compliance J K^-1 J^T. What the frame cannot move along has no stiffness that could be
    computed, and is reported as fixed.

    Deviations are carried through linearly, ``d sigma_c / d sigma_i`` being the product of the
    rows i of J# (of K^T on the left), from joints independent of each other; the robot's own
    numbers, q and the wrench are taken as exact.

    Parameters
    ----------
    robot : the arm; `Device.build_robot` makes a device's, None if it describes no arm.
    frame : one of `robot.frames`.
    q : (n,) rad, where it rests.
    stiffness : (n,) N m/rad, d tau_e / d phi of the joints there.
    stiffness_std : (n,) N m/rad, its standard deviations.
    force : (3,) N, on the arm, at the frame's origin, in the world's axes.
    moment : (3,) N m, on the arm, in the world's axes.
    directions : some of x, y, z, rx, ry, rz, of the world.
    tolerance : singular values of the Jacobian, positions over `length`, below this part of the
        largest count as none. The default is what an encoder of 40000 counts does not tell from a
        singular pose, 2 pi / 40000 rad.

    Raises
    ------
    RotatumError for arguments of another size, that are no numbers, or name no direction;
    DeviceError if there is no arm, or no such frame.
    """
    if robot is None:
        what = "the stiffness at a frame needs an arm"
        hint = "Describe it in the device file, in a table [robot]."
        raise DeviceError(what, where="cartesian_stiffness", hint=hint)
    n = robot.size
    at, sigma = _vector("q", q, n), _vector("stiffness", stiffness, n)
    deviation = None if stiffness_std is None else _deviations(stiffness_std, n)
    rows = _rows(directions)
    if not 0.0 < tolerance < 1.0:
        raise _refused("tolerance must be between 0 and 1", tolerance)
    wrench = np.concatenate([_vector("force", force, 3), _vector("moment", moment, 3)])
    whole = robot.jacobian(frame, at)
    joints = np.diag(sigma) - robot.wrench_gradient(frame, at, wrench) + robot.gravity_gradient(at)
    length = float(np.linalg.norm(whole[:3], axis=0).max()) or 1.0
    scale = np.where(np.array(rows) < 3, length, 1.0)
    jacobian = whole[rows]
    u, singular, vt = np.linalg.svd(jacobian / scale[:, np.newaxis])
    rank = int(np.sum(singular > tolerance * singular[0]))
    onto = u[:, :rank].T / scale
    right = _inverse(joints, singular[:rank], vt) @ onto
    left = _inverse(joints.T, singular[:rank], vt) @ onto
    fixed = np.linalg.norm(u[:, rank:], axis=1) > tolerance
    gives, takes = _solved(joints, jacobian.T, joints), _solved(joints.T, jacobian.T, joints)
    return CartesianStiffness(
        directions=tuple(directions),
        matrix=_marked(left.T @ joints @ right, fixed, np.inf),
        std=None if deviation is None else _marked(_spread(left, right, deviation), fixed, np.nan),
        compliance=jacobian @ gives,
        compliance_std=None if deviation is None else _spread(takes, gives, deviation),
        joint_stiffness=joints,
        stable=bool(np.linalg.eigvalsh(0.5 * (joints + joints.T))[0] > 0.0),
        fixed=tuple(name for name, held in zip(directions, fixed, strict=True) if held),
        rank=rank,
        condition=_condition(singular, len(rows)),
        length=length,
    )


def _inverse(joints: Array, singular: Array, vt: Array) -> Array:
    """Return the K-weighted right inverse of the Jacobian's part of full rank, (n, rank).

    As the Schur complement of the self-motion's stiffness: K itself need not be inverted.
    """
    rank = len(singular)
    shortest, inside = vt[:rank].T / singular, vt[rank:].T
    if not inside.shape[1]:
        return shortest
    pull = inside.T @ joints
    drawn: Array = inside @ _solved(pull @ inside, pull @ shortest, joints)
    return shortest - drawn


def _solved(matrix: Array, against: Array, joints: Array) -> Array:
    """Return matrix^-1 against, NaN where nothing is left of the matrix beside the joints' K."""
    smallest = np.linalg.svd(matrix, compute_uv=False)[-1]
    if smallest <= _SINGULAR * np.linalg.norm(joints, 2):
        return np.full_like(against, np.nan)
    return np.asarray(np.linalg.solve(matrix, against), dtype=np.float64)


def _spread(left: Array, right: Array, deviation: Array) -> Array:
    """Return deviations of the entries of left^T diag(sigma) right, (m, m)."""
    variance: Array = (left**2).T @ (deviation[:, np.newaxis] ** 2 * right**2)
    return np.sqrt(variance)


def _marked(matrix: Array, fixed: NDArray[np.bool_], diagonal: float) -> Array:
    """Return a matrix without numbers in the rows and columns of fixed directions."""
    marked = np.where(fixed | fixed[:, np.newaxis], np.nan, matrix)
    marked[fixed, fixed] = diagonal
    return marked


def _condition(singular: Array, directions: int) -> float:
    """Return the largest singular value over the last, inf where there is none."""
    last = singular[-1] if len(singular) == directions else 0.0
    return float(singular[0] / last) if last > 0.0 else np.inf


def _rows(directions: Sequence[str]) -> list[int]:
    """Return the Jacobian's rows of some directions."""
    what = "no such direction"
    check_names(directions, DIRECTIONS, what=what, where="cartesian_stiffness")
    if not directions or len(set(directions)) < len(directions):
        raise _refused("directions must be named once each, at least one", list(directions))
    return [DIRECTIONS.index(name) for name in directions]


def _deviations(given: ArrayLike, size: int) -> Array:
    """Return standard deviations, none negative."""
    deviation = _vector("stiffness_std", given, size)
    if np.any(deviation < 0.0):
        raise _refused("stiffness_std must be at least 0", deviation.tolist())
    return deviation


def _vector(name: str, given: ArrayLike, size: int) -> Array:
    """Return an argument as finite numbers."""
    try:
        numbers = np.array(given, dtype=np.float64)
    except (TypeError, ValueError):
        numbers = np.array(np.nan)
    if numbers.shape != (size,) or not np.isfinite(numbers).all():
        raise _refused(f"{name} must be {size} finite number{'s' if size > 1 else ''}", given)
    return numbers


def _refused(what: str, value: object) -> RotatumError:
    """Return the error of an argument."""
    return RotatumError(what, where="cartesian_stiffness", value=value)

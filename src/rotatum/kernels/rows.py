"""What every method makes of the samples: a regression row, and the basis to read it out."""

from __future__ import annotations

from typing import Any

from rotatum.kernels.status import DISABLED, SETTLING
from rotatum.record import Record, integer, number, vector

INERTIA = 1
DAMPING = 2
COULOMB = 3
SKEW = 4
TRANSMISSION_DAMPING = 5
OFFSET = 6
LINK_DAMPING = 7
LINK_COULOMB = 8
GRAVITY_TORQUE = 9
PAYLOAD = 10

Y = 0
PULL = 1
MOVED = 2
FIRST = 3
"""Places in an operator's terms: left side, acceleration, link moved in two periods, columns."""


class Sample(Record):
    """One sample of one transmission, as the rows of every method read it."""

    time = number("of the sample", unit="s", symbol="t")
    q = number("link position", unit="rad", symbol="q")
    theta = number("motor position, joint side", unit="rad", symbol="theta")
    setpoint = number("set-point as logged, 0: there is none", symbol="s")
    torque = number(
        "motor torque at the joint, or measured elastic torque", unit="N m", symbol="tau"
    )
    enable = integer("0: do not learn from this sample")
    fresh = integer("1: the filters must start at this sample")


class Row(Record):
    """``y = R^T alpha + noise``, and F, dF/dphi, d2F/dphi2 at the deflection of now.

    Columns that are no spring (fitted motor constants, offset) come first, then the basis from
    low to high order: the solver's triangular factor then holds every lower order as a model of
    its own.
    """

    valid = integer("1: learn from this row")
    status = integer("status bits")
    fresh = integer("1: the filters started at this sample")
    y = number("left side", unit="N m", symbol="y")
    suspect = number(
        "acceleration of the motor, or of the link from its side, through the same operator, "
        "0: none",
        unit="rad/s^2",
    )
    drag = number("velocity of the link through the same operator, times any constant")
    phi = number("deflection now", unit="rad", symbol="phi")
    phi2 = number("the antagonist's, where both share the row", unit="rad", symbol="phi_2")
    R = vector("p", "regressors", symbol="R")
    F = vector("p", "basis now, 0 for columns that are no spring", symbol="F")
    D = vector("p", "its derivative by deflection", unit="1/rad", symbol="F_phi")
    H = vector("p", "its second derivative", unit="1/rad^2", symbol="F_phiphi")


class LinkSample(Record):
    """One sample of a joint seen from its link, as the rows of the link side read it.

    What comes from the arm belongs to two samples ago: link velocities are differences across it.
    """

    time = number("of the sample", unit="s", symbol="t")
    q = number("link position", unit="rad", symbol="q")
    theta = number("motor position, joint side; the agonist's of two", unit="rad", symbol="theta")
    theta2 = number("the antagonist's", unit="rad", symbol="theta_2")
    setpoint = number("set-point as logged, 0: there is none", symbol="s")
    momentum = number("of the arm two samples ago", unit="N m s", symbol="p_i")
    force = number("C^T q' - g of the arm, then", unit="N m")
    payload_momentum = number("what a payload of 1 kg adds to the momentum", unit="N m s/kg")
    payload_force = number("what it adds to the force", unit="N m/kg")
    enable = integer("0: do not learn from this sample")
    fresh = integer("1: the filters must start at this sample")


class ZeroParams(Record):
    """Where the deflection is zero."""

    zero = number("deflection at rest", unit="rad")
    samples = integer("samples whose mean deflection is the zero; 0: `zero` is")


class ModelParams(Record):
    """The device's own law, where it stands in for a measured torque (flacco2012, MODEL)."""

    constants = vector("n", "of the law, packed")
    preload = number("deflection the law is evaluated at beyond q - theta", unit="rad")
    offset = number("set-point where the logged one is 0", unit="unit of the law's set-point")
    slope = number("change of the set-point by that of the logged one")


class ZeroState(Record):
    """The deflection's zero, once known."""

    zero = number("deflection at rest", unit="rad")
    total = number("sum of deflections", unit="rad")
    count = integer("samples in the sum")


def find_zero(params: Any, state: Any, raw: float, fresh: int) -> int:
    """Average ``q - theta`` over the first samples. Returns 1 once the zero is known.

    A restart while it is being read begins it anew: what came before is not at rest beside it.
    """
    if params.samples < 1:
        state.zero = params.zero
        return 1
    if state.count >= params.samples:
        return 1
    if fresh != 0:
        state.total = 0.0
        state.count = 0
    state.total = state.total + raw
    state.count = state.count + 1
    state.zero = state.total / state.count
    return 0


def known_zero(params: Any, state: Any) -> float:
    """The zero as far as it is known: the one given, or the mean so far."""
    if params.samples < 1:
        zero: float = params.zero
        return zero
    zero = state.zero
    return zero


def sign(velocity: float, width: float) -> float:
    """Coulomb friction's sign, linear within ``width`` so that noise at rest does not flip it."""
    if velocity > width:
        return 1.0
    if velocity < -width:
        return -1.0
    return velocity / width


def read_basis(terms: Any, out: Any) -> None:
    """Copy the basis at the deflection of now into a row; the columns before it are no spring."""
    first = len(out.F) - len(terms.F)
    for h in range(first):
        out.F[h] = 0.0
        out.D[h] = 0.0
        out.H[h] = 0.0
    for h in range(len(terms.F)):
        out.F[first + h] = terms.F[h]
        out.D[first + h] = terms.D[h]
        out.H[first + h] = terms.H[h]


def read_pair(terms: Any, terms2: Any, out: Any) -> None:
    """Copy the bases of two transmissions into a row they share: in turns, agonist first."""
    first = len(out.F) - 2 * len(terms.F)
    for h in range(first):
        out.F[h] = 0.0
        out.D[h] = 0.0
        out.H[h] = 0.0
    for h in range(len(terms.F)):
        out.F[first + 2 * h] = terms.F[h]
        out.D[first + 2 * h] = terms.D[h]
        out.H[first + 2 * h] = terms.H[h]
        out.F[first + 2 * h + 1] = terms2.F[h]
        out.D[first + 2 * h + 1] = terms2.D[h]
        out.H[first + 2 * h + 1] = terms2.H[h]


def emit(operator: Any, started: int, enable: int, out: Any) -> None:
    """Write what an operator made to a row; ``started`` tells raw terms seen since the start."""
    out.y = operator.value[Y]
    out.suspect = operator.value[PULL]
    out.drag = operator.value[MOVED]
    for h in range(len(out.R)):
        out.R[h] = operator.value[FIRST + h]
    out.fresh = 0
    if started <= 1:
        out.fresh = 1
    out.status = 0
    out.valid = operator.ready
    if operator.settled == 0:
        out.valid = 0
        out.status = SETTLING
    if enable == 0:
        out.valid = 0
        out.status = out.status | DISABLED


def hat(before: float, middle: float, after: float) -> float:
    """Average of a smooth signal under the hat ``1 - |t|/T`` of unit area, from three samples.

    ``(x(k-1) + 10 x(k) + x(k+1)) / 12``: exact for cubics; error of order T^4 otherwise.
    """
    return (before + 10.0 * middle + after) * (1.0 / 12.0)

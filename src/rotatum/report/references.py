"""The papers that stages cite by key: the one place where they are written out."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["REFERENCES", "Reference", "reference"]


class Reference(NamedTuple):
    """A paper or book.

    Parameters
    ----------
    key : as stages, docstrings and reports cite it.
    authors, title, where : what to print.
    why : what here rests on it.
    doi : digital object identifier, or "".
    """

    key: str
    authors: str
    title: str
    where: str
    why: str
    doi: str = ""

    def text(self) -> str:
        """Return the reference in one line."""
        link = f" doi:{self.doi}" if self.doi else ""
        return f"{self.authors}. {self.title}. {self.where}.{link}"


_ALL = (
    Reference(
        "bierman1977",
        "G. J. Bierman",
        "Factorization Methods for Discrete Sequential Estimation",
        "Academic Press, 1977",
        "the UD form of recursive least squares",
    ),
    Reference(
        "bittanti1990",
        "S. Bittanti, P. Bolzern, M. Campi",
        "Recursive least-squares identification algorithms with incomplete excitation: "
        "convergence analysis and application to adaptive control",
        "IEEE Transactions on Automatic Control 35(12), 1371-1373, 1990",
        "the stability factor of flacco2012",
    ),
    Reference(
        "ciblak1994",
        "N. Ciblak, H. Lipkin",
        "Asymmetric Cartesian stiffness for the modelling of compliant robotic systems",
        "ASME Design Engineering Technical Conferences, 197-204, 1994",
        "why a stiffness in space need not be symmetric",
    ),
    Reference(
        "deluca2007",
        "A. De Luca, D. Schröder, M. Thümmel",
        "An acceleration-based state observer for robot manipulators with elastic joints",
        "IEEE International Conference on Robotics and Automation, 2007",
        "full state from motor encoders and link accelerometers",
    ),
    Reference(
        "flacco2012",
        "F. Flacco, A. De Luca, I. Sardellitti, N. G. Tsagarakis",
        "On-line estimation of variable stiffness in flexible robot joints",
        "The International Journal of Robotics Research 31(13), 1556-1577, 2012",
        "the method residual; stiffness as the derivative of a fitted elastic torque",
        "10.1177/0278364912461813",
    ),
    Reference(
        "gautier1997",
        "M. Gautier",
        "Dynamic identification of robots with power model",
        "IEEE International Conference on Robotics and Automation, 1922-1927, 1997",
        "parallel filtering of both sides of a robot's model",
    ),
    Reference(
        "jeon2007",
        "S. Jeon, M. Tomizuka",
        "Benefits of acceleration measurements in velocity estimation and motion control",
        "Control Engineering Practice 15(3), 325-332, 2007",
        "the kinematic Kalman filter",
    ),
    Reference(
        "kalata1984",
        "P. R. Kalata",
        "The tracking index: a generalized parameter for alpha-beta and alpha-beta-gamma target "
        "trackers",
        "IEEE Transactions on Aerospace and Electronic Systems AES-20(2), 174-182, 1984",
        "steady gains of the kinematic filter in closed form",
    ),
    Reference(
        "menard2013",
        "T. Ménard, G. Grioli, A. Bicchi",
        "A real time robust observer for an agonist-antagonist variable stiffness actuator",
        "IEEE International Conference on Robotics and Automation, 2013",
        "the method algebraic; operational calculus on the motor side",
    ),
    Reference(
        "messenger2021",
        "D. A. Messenger, D. M. Bortz",
        "Weak SINDy: Galerkin-based data-driven model selection",
        "Multiscale Modeling & Simulation 19(3), 1474-1497, 2021",
        "the weak form in regression",
    ),
    Reference(
        "shinbrot1957",
        "M. Shinbrot",
        "On the analysis of linear and nonlinear systems",
        "Transactions of the ASME 79, 547-552, 1957",
        "modulating functions",
    ),
    Reference(
        "sundaram2008",
        "S. Sundaram, C. N. Hadjicostis",
        "Partial state observers for linear systems with unknown inputs",
        "Automatica 44(12), 3126-3132, 2008",
        "existence and design of delayed unknown-input observers",
    ),
    Reference(
        "trumic2022",
        "M. Trumić, G. Grioli, K. Jovanović, A. Fagiolini",
        "Force/torque-sensorless joint stiffness estimation in articulated soft robots",
        "IEEE Robotics and Automation Letters 7, 2022",
        "the method rotatum, selective updates, and where the word rotatum comes from",
    ),
)

REFERENCES: dict[str, Reference] = {entry.key: entry for entry in _ALL}


def reference(key: str) -> Reference:
    """Return the reference of a key; one nobody wrote out yet shows the key itself.

    Parameters
    ----------
    key : as in ``Stage.cites``.
    """
    return REFERENCES.get(key) or Reference(key, key, "not in the list of references", "", "")

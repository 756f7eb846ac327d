"""Elastic laws: torque, stiffness, their derivatives and energy over deflection and set-point.

>>> sorted(LAWS)[:3]
['cubic', 'exponential', 'fourbar']
"""

from rotatum.models.laws.cubic import CUBIC
from rotatum.models.laws.exponential import EXPONENTIAL
from rotatum.models.laws.fourbar import FOURBAR
from rotatum.models.laws.law import Constant, Law
from rotatum.models.laws.lever import LEVER
from rotatum.models.laws.lever_ratio import LEVER_RATIO
from rotatum.models.laws.linear import LINEAR
from rotatum.models.laws.maccepa import MACCEPA
from rotatum.models.laws.odd_polynomial import ODD_POLYNOMIAL
from rotatum.models.laws.polynomial import POLYNOMIAL
from rotatum.models.laws.sinh import SINH
from rotatum.models.laws.table import TABLE

__all__ = ["LAWS", "Constant", "Law"]

_EVERY = (
    LINEAR,
    CUBIC,
    ODD_POLYNOMIAL,
    POLYNOMIAL,
    SINH,
    EXPONENTIAL,
    FOURBAR,
    LEVER,
    LEVER_RATIO,
    MACCEPA,
    TABLE,
)
LAWS: dict[str, Law] = {law.name: law for law in _EVERY}

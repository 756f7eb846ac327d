"""How a step runs: stages, their composition, compilation, and the bank of joints."""

from rotatum.runtime.bank import Bank
from rotatum.runtime.stage import Stage

__all__ = ["Bank", "Stage"]

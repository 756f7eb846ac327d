"""Change indication: what every example stage gives on fixed samples, as text under review.

A refactor must leave these files alone. Where numbers are meant to change:
``python -m tests.golden.replay`` writes them anew; say why in the commit.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rotatum.estimators.registry import Example, example_stages
from rotatum.runtime import Bank

FOLDER = Path(__file__).parent
SAMPLES = 4000
EVERY = 100
FIELDS = ("stiffness", "stiffness_std", "torque", "dstiffness", "noise", "verdict", "status")
PAIR = ("correlation", "part_stiffness", "part_stiffness_std")


def faulty(example: Example) -> Example:
    """Return the example with a NaN, a repeated time, a gap and a jump put in."""
    u = example.inputs.copy()
    if "time" not in u.dtype.names:
        return example
    u["q"][1200] = np.nan
    u["time"][1500] = u["time"][1499]
    u["time"][2000:] += 0.005
    u["time"][2500:] += 0.5
    u["theta" if "theta" in u.dtype.names else "theta1"][3000] += 1.0
    return example._replace(inputs=u)


def replay(example: Example) -> np.ndarray:
    """Return (rows, fields of both joints) of every hundredth sample; of a pair, both sides'."""
    out = Bank(example.stage, example.params).run(faulty(example).inputs)[::EVERY]
    names = [f for f in (*FIELDS, *PAIR) if f in out.dtype.names] or ["x"]
    columns = [out[f][:, j].astype(float) for f in names for j in range(out.shape[1])]
    return np.column_stack(columns)


def examples() -> dict[str, Example]:
    """Return the example stages by name."""
    return {e.stage.name: e for e in example_stages(SAMPLES)}


if __name__ == "__main__":
    for old in FOLDER.glob("*.csv"):
        old.unlink()  # of stages there are no more
    for name, example in examples().items():
        np.savetxt(FOLDER / f"{name}.csv", replay(example), fmt="%.12g", delimiter=",")
        print(name)

from __future__ import annotations

import numpy as np
import pytest

from tests.golden.replay import FOLDER, examples, replay

EXAMPLES = examples()


@pytest.mark.parametrize("name", list(EXAMPLES))
def test_nothing_changed(name: str) -> None:
    kept = np.loadtxt(FOLDER / f"{name}.csv", delimiter=",")
    found = replay(EXAMPLES[name])
    # One machine gives the same bits; another libm or instruction set may differ in the last
    # ones, which a hundred rows of least squares amplify to about 1e-9. The text has 12 digits.
    np.testing.assert_allclose(found, kept, rtol=1e-8, atol=1e-8)

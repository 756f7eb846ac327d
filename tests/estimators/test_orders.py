"""The default with a generous basis is nearly as good as the best order chosen by hand."""

from __future__ import annotations

import numpy as np
import pytest

from rotatum.estimators import Estimator
from rotatum.estimators.columns import first_shrunk
from rotatum.estimators.groups import batch_records
from rotatum.evaluation import msrep_percent
from rotatum.logs import Log
from rotatum.models import Device, load_device
from rotatum.record import Records
from rotatum.runtime.bank import Bank
from tests.estimators.motions import motion_log

SEEDS = (0, 1, 2)
START = 2000  # samples before the first that is scored
NOWHERE = 1e-12  # prior variance of a column that is left out; others have 1e8
# Odd powers, estimated; all powers of two unlike springs, measured; with a set-point, measured.
DEVICES = ("vsa-ii", pytest.param("bavs", marks=pytest.mark.slow), "maccepa-vd")


def estimator(device: Device, log: Log) -> Estimator:
    (joint,) = device.joints
    return Estimator(
        device,
        period=log.period,
        torque="estimated" if joint.motors else "sensor",
        zeros={joint.name: [0.0] * len(joint.transmissions)},
    )


def readings(device: Device, log: Log, top: int | None = None) -> Records:
    """Readings; ``top``: of so many columns, none of them shrunk.

    The same stage either way: columns that are left out are held at zero by their prior.
    """
    (joint,) = device.joints
    loop = estimator(device, log)
    ((prepared,), (group,)) = loop.prepared, loop.groups
    for part in prepared.parts if top is not None else ():
        part["shrink"]["first"] = len(prepared.columns)
        part["solver"]["spread"][top:] = NOWHERE
    u = batch_records(group, log.samples)
    u["time"] = log.time[:, None]
    for role in group.roles:
        u[role][:, 0] = log.joints[joint.name][role]
    return Bank(prepared.stage, prepared.params).run(u)[:, 0]


def score(device: Device, log: Log, top: int | None = None) -> float:
    """MSREP of the stiffness in per cent."""
    truth = log.joints[device.joints[0].name]["stiffness_true"]
    return msrep_percent(readings(device, log, top)["stiffness"][START:], truth[START:])


@pytest.mark.parametrize("name", DEVICES)
def test_the_default_is_near_the_best_fixed_order(name: str) -> None:
    device = load_device(name)
    (joint,) = device.joints
    logs = [motion_log(joint, seed=seed) for seed in SEEDS]
    (prepared,) = estimator(device, logs[0]).prepared
    fitted, columns = len(prepared.settings.fit), len(prepared.columns)
    assert prepared.shape.shrunk
    default = np.median([score(device, log) for log in logs])
    fixed = {
        prepared.columns[top - 1]: np.median([score(device, log, top) for log in logs])
        for top in range(first_shrunk(prepared.powers, fitted), columns + 1)
    }
    assert len(fixed) >= 4
    # What is promised of every device in the catalogue, on its median.
    assert default <= 4.0 * min(fixed.values()), fixed


@pytest.mark.parametrize("name", DEVICES)
def test_the_order_matters_and_is_found(name: str) -> None:
    """The straight line alone is far off, even where a law bends by 5 %, as the VSA-II's."""
    device = load_device(name)
    log = motion_log(device.joints[0], seed=SEEDS[0])
    line, default = score(device, log, 2), score(device, log)
    assert line > 100.0 * default


def test_a_fixed_order_leaves_the_others_out() -> None:
    """What the default is compared with is what it says."""
    device = load_device("vsa-ii")
    log = motion_log(device.joints[0], seed=SEEDS[0])
    (prepared,) = estimator(device, log).prepared
    cubic = prepared.columns.index("phi^3") + 1
    last = readings(device, log, cubic)["coefficients"][-1].reshape(2, -1)
    # A prior of 1e-12 leaves 1e-12 of n rows' information: 1e-8 after 20,000.
    assert np.all(abs(last[:, cubic:]) < 1e-6 * abs(last[:, cubic - 2 : cubic - 1]))
    # The four-bar is 5 % off a straight line at the end of the range.
    assert np.all(abs(last[:, cubic - 1]) > 0.01 * abs(last[:, cubic - 2]))

"""The arms of the package against MuJoCo's, and MuJoCo's own against a closed form."""

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rotatum.models import device_from_tables
from rotatum.models.robot.packaged import read_urdf
from rotatum.simulation.device import simulate
from tests.simulation.mujoco_arms import Arm, Elastic, Payload, build_twin, free_motion

# In the plane x-z, angles from the horizontal: joint 1's z axis lies along -y. The second link is
# written with its inertia turned, its tip behind a joint that is locked.
TWO_LINKS = """\
<robot name="two">
  <link name="base"/>
  <link name="one">
    <inertial><origin xyz="0.2 0 0"/><mass value="3"/>
      <inertia ixx="0.01" iyy="0.07" izz="0.07" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="two">
    <inertial><origin xyz="0.1 0 0" rpy="1.5707963267948966 0 0"/><mass value="1.5"/>
      <inertia ixx="0.01" iyy="0.03" izz="0.025" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="tip"><inertial><origin xyz="0 0.2 0"/><mass value="0.5"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="elbow" type="revolute"><parent link="one"/><child link="two"/>
    <origin xyz="0.4 0 0"/><axis xyz="0 0 2"/><limit effort="1" velocity="1"/></joint>
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="one"/>
    <origin xyz="0 0 1" rpy="1.5707963267948966 0 0"/><axis xyz="0 0 1"/></joint>
  <joint name="wrist" type="continuous"><parent link="two"/><child link="tip"/>
    <origin xyz="0.3 0 0"/><axis xyz="0 0 -1"/></joint>
</robot>
"""
# Locked at pi/2 about -z the tip's mass lies at x = 0.3 + 0.2 on the second link.
TWO = Arm(TWO_LINKS, {"wrist": np.pi / 2})
SPRINGS = {
    "linear": {"shoulder": Elastic(0.5, 400.0), "elbow": Elastic(0.1, 150.0)},
    "cubic": {"shoulder": Elastic(0.5, 400.0, 4e4), "elbow": Elastic(0.1, 150.0, 2e4)},
    "damped": {"shoulder": Elastic(0.5, 400.0, 4e4, 2.0), "elbow": Elastic(0.1, 150.0, 0.0, 0.5)},
}


def two_links_mass(q):
    """Return M(q) of `TWO`: the second link is two bodies, 1.5 kg and 0.5 kg."""
    moment = 0.03 + 1.5 * 0.1**2 + 0.01 + 0.5 * 0.5**2  # about the elbow
    static = 1.5 * 0.1 + 0.5 * 0.5
    cross = 0.4 * static * np.cos(q[1])
    first = 0.07 + 3.0 * 0.2**2 + 2.0 * 0.4**2
    return np.array([[first + moment + 2 * cross, moment + cross], [moment + cross, moment]])


def two_links_bias(q, dq):
    """Return C q' + g of `TWO`."""
    static, weight = 1.5 * 0.1 + 0.5 * 0.5, 9.81
    h = 0.4 * static * np.sin(q[1])
    far = static * weight * np.cos(q[0] + q[1])
    near = (3.0 * 0.2 + 2.0 * 0.4) * weight * np.cos(q[0])
    return np.array([-h * (2 * dq[0] + dq[1]) * dq[1] + near + far, h * dq[0] ** 2 + far])


@pytest.mark.parametrize("springs", SPRINGS)
def test_mujoco_and_a_closed_form_agree(springs):
    joints = SPRINGS[springs]
    own = list(joints.values())
    rotor, k, k3, d = (
        np.array([getattr(j, key) for j in own])
        for key in ("rotor", "stiffness", "cubic", "damping")
    )

    def rates(_, x):
        q, theta, dq, dtheta = x.reshape(4, 2)
        phi = q - theta
        tau = k * phi + k3 * phi**3 + d * (dq - dtheta)
        ddq = np.linalg.solve(two_links_mass(q), -tau - two_links_bias(q, dq))
        return np.concatenate([dq, dtheta, ddq, tau / rotor])

    start = (np.array([-1.2, 0.4]), np.array([-1.15, 0.35]))
    time = np.arange(201) * 1e-2
    reference = solve_ivp(
        rates,
        (0.0, 2.0),
        np.concatenate([*start, np.zeros(4)]),
        method="DOP853",
        t_eval=time,
        rtol=1e-12,
        atol=1e-13,
    )
    q, theta = free_motion(TWO, joints, start, samples=201, period=1e-2, step=1e-4)
    # MuJoCo's RK4: (omega h)^4 / 120 of a phase of 2e2 rad, omega near 1e2 rad/s, of 0.05 rad
    np.testing.assert_allclose(q, reference.y[:2].T, rtol=0.0, atol=2e-9)
    np.testing.assert_allclose(theta, reference.y[2:4].T, rtol=0.0, atol=2e-9)


def test_the_twin_has_two_equations_per_joint_and_no_more():
    twin = build_twin(TWO, SPRINGS["cubic"])
    q, theta = np.array([0.3, -0.8]), np.array([1.0, 2.0])
    expected = np.zeros((4, 4))
    expected[:2, :2] = two_links_mass(q)
    expected[2:, 2:] = np.diag([0.5, 0.1])
    np.testing.assert_allclose(twin.mass(q, theta), expected, rtol=0.0, atol=1e-14)  # rounding
    dq, dtheta = np.array([2.0, -3.0]), np.array([5.0, 7.0])
    bias = np.concatenate([two_links_bias(q, dq), np.zeros(2)])
    np.testing.assert_allclose(
        twin.bias(q, theta, dq, dtheta), bias, rtol=0.0, atol=1e-13
    )  # rounding


def test_the_twins_springs_are_those_asked_for():
    twin = build_twin(TWO, SPRINGS["damped"])
    phi, dphi = np.array([0.1, -0.2]), np.array([0.5, -1.0])
    data = twin.state(phi, np.zeros(2), dphi, np.zeros(2))
    tau = [400.0 * 0.1 + 4e4 * 0.1**3 + 2.0 * 0.5, 150.0 * -0.2 + 0.5 * -1.0]
    np.testing.assert_allclose(data.qfrc_passive, [0.0, -tau[0], 0.0, -tau[1]], rtol=1e-14)


def test_a_payload_is_a_body_fixed_to_a_frame():
    tip = TWO_LINKS.partition('<link name="tip">')[2].partition("</link>")[0]
    load = Payload("tip", 0.5, (0.0, 0.2, 0.0), np.diag([0.01, 0.01, 0.01]))
    loaded = Arm(TWO_LINKS.replace(tip, ""), TWO.locked, payloads=(load,))
    twin, q, dq = build_twin(loaded, SPRINGS["cubic"]), np.array([0.3, -0.8]), np.array([2.0, -3.0])
    np.testing.assert_allclose(
        twin.mass(q, q)[:2, :2], two_links_mass(q), rtol=0.0, atol=1e-14
    )  # rounding
    np.testing.assert_allclose(
        twin.bias(q, q, dq, dq)[:2], two_links_bias(q, dq), rtol=0.0, atol=1e-13
    )


@dataclass(frozen=True)
class Case:
    """An arm of the package, let go of at rest at `q`, its springs deflected by `phi`.

    A cubic spring's second term is half of its first at the deflection `hardening`.
    """

    joints: dict[str, Elastic]
    hardening: list[float]
    q: list[float]
    phi: float
    step: float  # MuJoCo's
    locked: dict[str, float] = field(default_factory=dict)
    payload: Payload | None = None

    def springs(self, law):
        """Return its joints with springs of a law."""
        if law == "linear":
            return self.joints
        own = zip(self.joints.items(), self.hardening, strict=True)
        return {name: replace(j, cubic=0.5 * j.stiffness / x**2) for (name, j), x in own}

    def arm(self, name):
        """Return it for MuJoCo."""
        loads = () if self.payload is None else (self.payload,)
        return Arm(read_urdf(name), self.locked, payloads=loads)

    def device(self, name, joints):
        """Return it as a device."""
        robot = {"urdf": name, "locked": self.locked}
        if self.payload is not None:
            robot["payload"] = vars(self.payload)
        tables = [
            {"name": key, "motor": {"inertia": joint.rotor}, "transmission": _law(joint)}
            for key, joint in joints.items()
        ]
        return device_from_tables({"name": name, "robot": robot, "joint": tables}, "test")


def _law(joint):
    spring = {"stiffness": joint.stiffness, "damping": joint.damping}
    if joint.cubic == 0.0:
        return {"law": "linear", **spring}
    return {"law": "cubic", "cubic": joint.cubic, **spring}


CASES = {
    "planar-2r": Case(
        {"joint1": Elastic(0.02, 20.0), "joint2": Elastic(0.005, 5.0)},
        hardening=[0.05, 0.05],
        q=[1.2, -0.8],
        phi=0.05,
        step=5e-4,
    ),
    "seven-axis": Case(
        {
            "joint1": Elastic(2.0, 8000.0),
            "joint2": Elastic(2.0, 8000.0),
            "joint3": Elastic(1.0, 5000.0),
            "joint4": Elastic(1.0, 5000.0),
            "joint5": Elastic(0.3, 2000.0),
            "joint6": Elastic(0.2, 1000.0),
            "joint7": Elastic(0.05, 100.0),
        },
        hardening=[0.05, 0.05, 0.05, 0.05, 0.06, 0.1, 0.2],
        q=[0.3, 2.2, -0.4, 0.8, 0.3, 0.9, 0.5],
        phi=0.02,
        step=5e-5,
    ),
    "manutec-r3": Case(
        {
            "axis1": Elastic(14.33, 474075.0),
            "axis2": Elastic(57.33, 352800.0),
            "axis3": Elastic(4.68, 208800.0),
        },
        hardening=[0.005, 0.005, 0.005],
        q=[0.2, 0.5, 0.8],
        phi=0.005,
        step=1e-4,
        locked={"axis4": 0.3, "axis5": -0.4, "axis6": 0.2},
        payload=Payload("flange", 15.0, (0.1, 0.1, 0.25), np.diag([0.3, 0.2, 0.4]).tolist()),
    ),
}
R3_DAMPING = {"axis1": 55.1, "axis2": 441.0, "axis3": 144.0}


def _assert_same_arm(robot, twin, seed):
    n, rng = robot.size, np.random.default_rng(seed)
    for _ in range(20):
        q, dq, theta, dtheta = rng.uniform(-3.0, 3.0, (4, n))
        still = np.zeros(n)
        _assert_close(twin.mass(q, theta)[:n, :n], robot.mass(q))
        _assert_close(twin.bias(q, theta, dq, dtheta), [*robot.bias(q, dq), *still])
        _assert_close(twin.bias(q, theta, still, still), [*robot.gravity(q), *still])


def _assert_close(found, expected):
    # rounding, of sums as large as the largest entry
    size = np.abs(expected).max()
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * size)


@pytest.mark.parametrize("name", CASES)
def test_mass_coriolis_and_gravity_are_mujocos(name):
    case = CASES[name]
    joints = case.springs("linear")
    robot = case.device(name, joints).build_robot()
    _assert_same_arm(robot, build_twin(case.arm(name), joints), seed=3)


def test_the_closed_form_of_the_planar_arm_is_its_urdf():
    rods = {"lengths": [0.5, 0.5], "masses": [0.1, 0.1], "motor_masses": [0.345]}
    joints = CASES["planar-2r"].springs("linear")
    tables = [{"name": name, "transmission": _law(joint)} for name, joint in joints.items()]
    robot = {"model": "planar", **rods}
    device = device_from_tables({"name": "2r", "robot": robot, "joint": tables}, "test")
    twin = build_twin(CASES["planar-2r"].arm("planar-2r"), joints)
    _assert_same_arm(device.build_robot(), twin, seed=4)


def _ours(name, joints, period=1e-3):
    """Return q and theta, (2, 2001, n), every ms of 2 s; steps are at most `period` long."""
    case = CASES[name]
    log = simulate(
        case.device(name, joints),
        seconds=2.001,
        period=period,
        log_period=1e-3,
        drives={joint: {"tau": np.zeros_like} for joint in joints},
        start={
            joint: {"q": q, "theta": q - case.phi} for joint, q in zip(joints, case.q, strict=True)
        },
    )
    roles = ("q_true", "theta_true")
    return np.array([np.stack([log.joints[j][role] for j in joints], axis=1) for role in roles])


def _mujocos(name, joints, halves=1):
    """Return the same of MuJoCo."""
    case, q = CASES[name], np.array(CASES[name].q)
    start, step = (q, q - case.phi), case.step / halves
    return np.array(
        free_motion(case.arm(name), joints, start, samples=2001, period=1e-3, step=step)
    )


@pytest.mark.parametrize("law", ["linear", "cubic"])
@pytest.mark.parametrize("name", CASES)
def test_free_motion_is_mujocos(name, law):
    joints = CASES[name].springs(law)
    ours, coarse, fine = _ours(name, joints), _mujocos(name, joints), _mujocos(name, joints, 2)
    # Both have converged: steps of half the length leave MuJoCo a sixteenth of its error.
    assert abs(fine - coarse).max() < 1e-6
    assert abs(_ours(name, joints, period=5e-4) - ours).max() < 1e-6
    # Every joint has moved, and the cubic terms had a say.
    assert np.all(np.ptp(ours[0], axis=0) > 0.2)
    cubic = np.array([joint.cubic / joint.stiffness for joint in joints.values()])
    largest = abs(ours[0] - ours[1]).max(axis=0)
    assert law == "linear" or np.all(cubic * largest**2 > 0.1)
    # a hundredth of the 1e-4 rad that are promised
    np.testing.assert_allclose(ours, fine, rtol=0.0, atol=1e-6)


@pytest.mark.parametrize("law", ["linear", "cubic"])
def test_motion_with_damped_springs_is_mujocos(law):
    springs = CASES["manutec-r3"].springs(law)
    joints = {name: replace(j, damping=R3_DAMPING[name]) for name, j in springs.items()}
    ours, reference = _ours("manutec-r3", joints), _mujocos("manutec-r3", joints)
    # the fast modes, which make MuJoCo's error of 3e-7 rad without damping, die out
    np.testing.assert_allclose(ours, reference, rtol=0.0, atol=1e-8)

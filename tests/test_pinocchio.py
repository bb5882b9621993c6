"""MuJoCo's kinematics, gravity, Jacobians and loop closure against Pinocchio, which shares no code with it."""

from __future__ import annotations

from importlib import metadata
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import equipoise as eq

ROBOTS = {
    "UR10": "ur_description/urdf/ur10_robot.urdf",
    "Panda": "panda_description/urdf/panda.urdf",
    "SO-101": "so_arm_description/urdf/so101.urdf",
}


def robots_folder() -> Path:
    files = metadata.files("example-robot-data") or []
    return next(Path(str(f.locate())).parents[0] for f in files if f.name == "ur10_robot.urdf").parents[1]


@pytest.fixture(scope="module", params=ROBOTS)
def pair(request):
    path = robots_folder() / ROBOTS[request.param]
    mechanism = eq.Mechanism.load(path)
    model = pin.buildModelFromUrdf(str(path))
    sweep = eq.Sweep.sobol(mechanism, 24, seed=3)
    return mechanism, mechanism.states(sweep), model


def postures(states, model):
    """The same postures in Pinocchio's coordinates: cosine and sine for continuous joints."""
    mechanism = states.mechanism
    for q in states.kin.q:
        full = pin.neutral(model)
        for name, joint in zip(list(model.names)[1:], list(model.joints)[1:], strict=True):
            value = q[mechanism.model.jnt_qposadr[mechanism.joint_id(name)]]
            full[joint.idx_q : joint.idx_q + joint.nq] = value if joint.nq == 1 else [np.cos(value), np.sin(value)]
        yield full


def columns(states, model):
    """Pinocchio's velocity index of every joint, with its sensitivity to the driven joints."""
    mechanism = states.mechanism
    order = [model.joints[model.getJointId(mechanism.model.joint(i).name)].idx_v for i in range(mechanism.model.njnt)]
    transmission = np.zeros((len(states.D), model.nv, len(mechanism.driven)))
    transmission[:, order] = states.D
    return np.broadcast_to(transmission, (len(states), *transmission.shape[1:]))


def test_gravity_torque(pair):
    mechanism, states, model = pair
    data = model.createData()
    transmission = columns(states, model)
    theirs = np.array(
        [
            pin.computeGeneralizedGravity(model, data, q) @ D
            for q, D in zip(postures(states, model), transmission, strict=True)
        ]
    )
    np.testing.assert_allclose(states.holding, theirs, atol=1e-9 * np.abs(theirs).max())
    assert mechanism.mass == pytest.approx(sum(part.mass for part in model.inertias), rel=1e-9)


def test_points_and_jacobians(pair):
    mechanism, states, model = pair
    data = model.createData()
    local = np.array([0.03, -0.02, 0.05])
    transmission = columns(states, model)
    for body in (mechanism.bodies[2], mechanism.bodies[-1]):
        frame = model.getFrameId(body, pin.FrameType.BODY)
        position, jacobian = states.point(eq.Point(body, tuple(local)))
        for index, q in enumerate(postures(states, model)):
            pin.computeJointJacobians(model, data, q)
            pin.updateFramePlacements(model, data)
            placed = data.oMf[frame].act(local)
            whole = pin.getFrameJacobian(model, data, frame, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
            arm = placed - data.oMf[frame].translation
            theirs = (whole[:3] - pin.skew(arm) @ whole[3:]) @ transmission[index]
            np.testing.assert_allclose(position[index], placed, atol=1e-9)
            np.testing.assert_allclose(jacobian[index], theirs, atol=1e-9)


def test_four_bar_closure_and_torque():
    """An open three-link chain in Pinocchio closes on the postures found here, and its virtual work agrees."""
    ground, crank, coupler, rocker = 0.4, 0.15, 0.35, 0.3
    masses, coms = (1.0, 2.0, 1.5), ((0.07, 0.0), (0.2, 0.05), (0.15, 0.0))
    bar = eq.four_bar(ground, crank, coupler, rocker, masses=masses, coms=coms)
    states = bar.states(eq.Sweep.grid(bar, {bar.driven[0]: (-np.pi, np.pi, 37)}))
    model = pin.Model()
    model.gravity.linear = bar.gravity
    # The hinge axis is (0, -1, 0), as in every planar builder.
    axis = np.array([0.0, -1.0, 0.0])
    parents = {
        "crank": (0, np.zeros(3)),
        "coupler": (1, np.array([crank, 0, 0])),
        "rocker": (0, np.array([ground, 0, 0])),
    }
    for (name, (parent, at)), mass, com in zip(parents.items(), masses, coms, strict=True):
        joint = model.addJoint(parent, pin.JointModelRevoluteUnaligned(axis), pin.SE3(np.eye(3), at), name)
        inertia = pin.Inertia(mass, np.array([com[0], 0.0, com[1]]), 1e-3 * np.eye(3))
        model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
    data = model.createData()
    angles = [states.angle(f"{name}_joint") for name in parents]
    h = 1e-6
    for index in range(len(states)):
        q = np.array([angle[index] for angle, _ in angles])
        rate = np.array([slope[index, 0] for _, slope in angles])
        pin.forwardKinematics(model, data, q)
        tip = data.oMi[2].act(np.array([coupler, 0, 0])) - data.oMi[3].act(np.array([rocker, 0, 0]))
        assert np.abs(tip).max() < 1e-9
        torque = pin.computeGeneralizedGravity(model, data, q) @ rate
        assert states.holding[index, 0] == pytest.approx(torque, abs=1e-9 * np.abs(states.holding).max())
        pin.forwardKinematics(model, data, q + h * rate)
        ahead = data.oMi[2].act(np.array([coupler, 0, 0])) - data.oMi[3].act(np.array([rocker, 0, 0]))
        assert np.abs(ahead).max() < 1e-10

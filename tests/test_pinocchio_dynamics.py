"""Constrained dynamics, momentum and forces of loops against Pinocchio, which shares no code with MuJoCo or ours."""

from __future__ import annotations

import mujoco
import numpy as np
import pinocchio as pin
import pytest

import equipoise as eq
from equipoise.assemble import effort

CLOSE = 1e-8


def translated(model: mujoco.MjModel) -> tuple[pin.Model, list[pin.RigidConstraintModel]]:
    """A compiled model of hinges, slides and connected sites in Pinocchio: a joint each, bodies on the last one."""
    made = pin.Model()
    made.gravity.linear = np.array(model.opt.gravity)
    carrier, offset = {0: 0}, {0: pin.SE3.Identity()}
    for body in range(1, model.nbody):
        parent = int(model.body_parentid[body])
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, model.body_quat[body])
        joint = carrier[parent]
        place = offset[parent] * pin.SE3(turn.reshape(3, 3), model.body_pos[body].copy())
        for index in range(model.body_jntadr[body], model.body_jntadr[body] + model.body_jntnum[body]):
            assert not model.jnt_pos[index].any()
            kind = pin.JointModelRevoluteUnaligned
            if model.jnt_type[index] == mujoco.mjtJoint.mjJNT_SLIDE:
                kind = pin.JointModelPrismaticUnaligned
            joint = made.addJoint(joint, kind(model.jnt_axis[index].copy()), place, model.joint(index).name)
            place = pin.SE3.Identity()
        carrier[body], offset[body] = joint, place
        mujoco.mju_quat2Mat(turn, model.body_iquat[body])
        axes = turn.reshape(3, 3)
        inertia = pin.Inertia(
            float(model.body_mass[body]),
            model.body_ipos[body].copy(),
            axes @ np.diag(model.body_inertia[body]) @ axes.T,
        )
        if joint:
            made.appendBodyToJoint(joint, inertia, place)
    contacts = []
    for index in range(model.neq):
        ends = []
        for site in (int(model.eq_obj1id[index]), int(model.eq_obj2id[index])):
            body = int(model.site_bodyid[site])
            ends += [carrier[body], offset[body] * pin.SE3(np.eye(3), model.site_pos[site].copy())]
        contacts.append(pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, made, *ends, pin.ReferenceFrame.LOCAL))
    return made, contacts


def machines():
    bar = eq.four_bar(0.4, 0.15, 0.35, 0.3, masses=(1.0, 2.0, 1.5), coms=(0.07, (0.2, 0.05), (0.15, -0.02)))
    five = eq.five_bar(
        0.2, (0.15, 0.17), (0.25, 0.23), crank_masses=(0.4, 0.5), coupler_masses=(0.25, 0.2),
        coupler_coms=((0.12, 0.02), (0.1, -0.015)), pose=(0.08, 0.3),
    )  # fmt: skip
    root = np.sqrt(3)
    planar = eq.rrr3(
        ((0, 0), (0.46, 0), (0.23, 0.23 * root)),
        ((-0.05, -0.05 / root), (0.05, -0.05 / root), (0, 0.1 / root)),
        (0.18,) * 3,
        (0.18,) * 3,
        pose=(0.23, 0.05 / root, 0.0),
        crank_masses=(0.5, 0.6, 0.7),
        rod_masses=(0.4, 0.5, 0.6),
        rod_coms=((0.09, 0.01), (0.08, -0.02), None),
        platform_mass=3.0,
        platform_com=(0.01, 0.02),
        platform_inertia=0.01,
    )
    delta = eq.delta(
        0.2, 0.25, 0.5, 0.05, arm_mass=0.6, arm_com=(0.1, 0.01, 0.02), arm_inertia=0.004, forearm_mass=0.2,
        forearm_com=(0.22, 0.0, 0.01), platform_mass=0.5, platform_com=(0.01, 0.02, -0.03),
    )  # fmt: skip
    swing = "{0!r} + {1}*sin({2}*t) + 0.2*t**2"
    return {
        "four_bar": (bar, {"crank_joint": "3*t + sin(2*t)**2"}),
        "five_bar": (five, dict(zip(five.driven, [swing.format(float(q), 0.3, 5 + i) for i, q in
                                                  enumerate(five.reference[[0, 2]])], strict=True))),
        "rrr3": (planar, dict(zip(planar.driven, [swing.format(float(q), 0.08, 6 + i) for i, q in
                                                  enumerate(planar.reference[[0, 2, 4]])], strict=True))),
        "delta": (delta, {f"arm_{i}_joint": f"{0.1 * i} + 0.3*sin({4 + i}*t)" for i in (1, 2, 3)}),
    }  # fmt: skip


@pytest.fixture(scope="module", params=["four_bar", "five_bar", "rrr3", "delta"])
def machine(request):
    mechanism, drivers = machines()[request.param]
    states = mechanism.states(eq.Sweep.motion(mechanism, drivers, duration=0.6, samples=25))
    body = mechanism.bodies[-1] if request.param != "delta" else "arm_2"
    added = [
        eq.Counterweight("point", eq.Point(mechanism.bodies[1], (-0.06, 0.0, 0.01)), mass=0.7),
        eq.Counterweight("disc", eq.Point(body, (-0.05, 0.0, 0.02)), mass=0.4, shape=eq.Disc(0.05, thickness=0.02)),
    ]
    spec = mechanism.spec.copy()
    for part in added:
        part.install(spec, {}, states)
    model, contacts = translated(spec.compile())
    order = [model.joints[model.getJointId(name)].idx_v for name in mechanism.joints]
    return mechanism, states, added, model, contacts, order


def arranged(machine, values):
    mechanism, _, _, model, _, order = machine
    full = np.zeros((len(values), model.nv))
    full[:, order] = values[:, mechanism.model.jnt_dofadr]
    return full


def test_motor_efforts_move_the_constrained_machine_as_asked(machine):
    """Pinocchio's proximal constraint solver, given our efforts, returns our accelerations and our pin forces."""
    mechanism, states, added, model, contacts, _ = machine
    q, v, a = (arranged(machine, x) for x in (states.kin.q, states.rates.velocity, states.rates.acceleration))
    drive = effort(mechanism, added, states, "drive").b
    tau = np.zeros((len(states), mechanism.model.nv))
    tau[:, mechanism.model.jnt_dofadr[mechanism.driven_ids]] = drive
    tau = arranged(machine, tau)
    forces = eq.bearing_forces(states, added)
    pins = [forces.of(mechanism.model.equality(i).name) for i in range(mechanism.model.neq)]
    data, settings = model.createData(), pin.ProximalSettings(1e-14, 1e-10, 200)
    joined, held = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    for contact in contacts:
        joined.append(contact)
        held.append(contact.createData())
    pin.initConstraintDynamics(model, data, joined, held)
    scale, load = np.abs(a).max(), max(np.abs(one).max() for one in pins)
    for row in range(len(states)):
        found = pin.constraintDynamics(model, data, q[row], v[row], tau[row], joined, held, settings)
        np.testing.assert_allclose(found, a[row], atol=CLOSE * scale)
        for number, contact in enumerate(contacts):
            turn = data.oMi[contact.joint1_id].rotation @ contact.joint1_placement.rotation
            pulled = turn @ data.lambda_c[3 * number : 3 * number + 3]
            np.testing.assert_allclose(-pulled, pins[number][row], atol=CLOSE * load)


def test_momentum_and_its_rate(machine):
    mechanism, states, added, model, _, _ = machine
    q, v, a = (arranged(machine, x) for x in (states.kin.q, states.rates.velocity, states.rates.acceleration))
    stored = [effort(mechanism, added, states.momenta, goal).b for goal in ("force", "moment")]
    rate = [effort(mechanism, added, states, goal).b for goal in ("force", "moment")]
    data = model.createData()
    theirs = np.zeros((2, 2, len(states), 3))
    for row in range(len(states)):
        pin.computeCentroidalMomentumTimeVariation(model, data, q[row], v[row], a[row])
        centre = data.com[0]
        for kind, wrench in enumerate((data.hg, data.dhg)):
            theirs[kind, 0, row] = wrench.linear
            theirs[kind, 1, row] = wrench.angular + np.cross(centre, wrench.linear)
        # the rate of angular momentum about a fixed point has no transport term: dL_o = dL_c + c x dp
    for ours, other in zip((stored, rate), theirs, strict=True):
        for mine, one in zip(ours, other, strict=True):
            np.testing.assert_allclose(mine, one, atol=CLOSE * max(1e-3, np.abs(one).max()))


def test_bearings_by_pinocchios_newton_euler(machine):
    """Joint reactions of the open trees with the pins' forces on them, by Pinocchio's recursive Newton-Euler."""
    mechanism, states, added, model, contacts, _ = machine
    q, v, a = (arranged(machine, x) for x in (states.kin.q, states.rates.velocity, states.rates.acceleration))
    forces = eq.bearing_forces(states, added)
    pins = [forces.of(mechanism.model.equality(i).name) for i in range(mechanism.model.neq)]
    load = forces.magnitude.max()
    data = model.createData()
    for row in range(0, len(states), 3):
        pin.forwardKinematics(model, data, q[row])
        outer = [pin.Force.Zero() for _ in range(model.njoints)]
        for contact, force in zip(contacts, pins, strict=True):
            for joint, place, sign in (
                (contact.joint1_id, contact.joint1_placement, -1.0),
                (contact.joint2_id, contact.joint2_placement, 1.0),
            ):
                turn = data.oMi[joint].rotation
                local = sign * turn.T @ force[row]
                outer[joint] = outer[joint] + pin.Force(local, np.cross(place.translation, local))
        tau = pin.rnea(model, data, q[row], v[row], a[row], outer)
        driven = [model.joints[model.getJointId(name)].idx_v for name in mechanism.driven]
        assert np.abs(np.delete(tau, driven)).max() < CLOSE * load
        for bearing in forces.bearings[: len(forces.bearings) - len(pins)]:
            joint = model.getJointId(bearing.name.split("/")[0])
            reaction = data.oMi[joint].rotation @ data.f[joint].linear
            np.testing.assert_allclose(forces.of(bearing.name)[row], reaction, atol=CLOSE * load)


def test_mujocos_inverse_dynamics(machine):
    """Recursive Newton-Euler of the model with its parts, loops open, at our accelerations."""
    mechanism, states, added, *_ = machine
    spec = mechanism.spec.copy()
    for part in added:
        part.install(spec, {}, states)
    model = spec.compile()
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    drive = effort(mechanism, added, states, "drive").b
    data = mujoco.MjData(model)
    for row in range(len(states)):
        data.qpos[:], data.qvel[:] = states.kin.q[row], states.rates.velocity[row]
        data.qacc[:] = states.rates.acceleration[row]
        mujoco.mj_inverse(model, data)
        found = data.qfrc_inverse @ states.D[row]
        np.testing.assert_allclose(found, drive[row], atol=CLOSE * 1e-2 * np.abs(drive).max())

"""Where a balancer of one joint sits: its shaft, which way the load pulls, how much room there is."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.paths import Angle, Mount
from equipoise.balancers.paths.turn import joint_shaft
from equipoise.errors import InputError, nearest
from equipoise.mechanism import Mechanism, Point
from equipoise.states import States

NO_LOAD = 1e-9
SHARE, LEAST, MOST = 0.35, 0.02, 0.5


@dataclass(frozen=True, eq=False)
class Site:
    """A joint with its load: torque -load sin(q - top) of a hinge fitted over the states, or a slide's mean force.

    mount is the joint's shaft on the body before it; parent and child are the bodies on both sides; turn is the
    child's rotation in the parent at q = 0; at the joint's point in the child's frame; up the direction against gravity
    in the mount's plane, an angle from its direction, at the middle state; room, m, is what cranks,
    springs and weights may reach from the joint; low and high bound the joint over the states, travel lies between.
    """

    mechanism: Mechanism
    joint: str
    slide: bool
    load: float
    top: float
    mount: Mount
    child: str
    turn: Array
    at: Array
    up: float
    room: float
    low: float
    high: float

    @property
    def angle(self) -> Angle:
        """The joint's own position as a path."""
        return Angle(self.joint, unit="m" if self.slide else "rad")

    @property
    def travel(self) -> float:
        """What the joint moves over the states, rad or m."""
        return self.high - self.low

    def fixed(self, angle: float, distance: float) -> Point:
        """A point of the parent at a distance, m, from the shaft, at an angle from where the load is highest."""
        turned = angle + self.top
        return self.mount.point(distance * np.cos(turned), distance * np.sin(turned))

    def moving(self, angle: float, distance: float) -> Point:
        """A point of the child that stands at that angle and distance when the load is highest."""
        # At q = top the child has turned by top from q = 0, so its point stood at `angle` then.
        e, f, _ = self.mount.frame
        arm = distance * (np.cos(angle) * e + np.sin(angle) * f)
        x, y, z = (self.at + self.turn.T @ arm).tolist()
        return Point(self.child, (x, y, z))


def site_of(states: States, joint: str | None, room: float | None) -> Site:
    """The site of a joint, by default the most loaded one; raises InputError for a joint that carries nothing."""
    mechanism = states.mechanism
    load = np.abs(states.holding).max(axis=0)
    if joint is None:
        joint = mechanism.driven[int(load.argmax())]
    if joint not in mechanism.driven:
        hint = nearest(joint, mechanism.driven)
        raise InputError(f"joint {joint!r} is not driven", where="compare.joint", hint=hint)
    column = mechanism.driven.index(joint)
    index = mechanism.joint_id(joint)
    weight = float(np.linalg.norm(mechanism.gravity)) * mechanism.mass
    if load[column] <= NO_LOAD * max(weight, 1.0):
        raise InputError(
            f"joint {joint} carries no load: there is nothing to compare balancers for",
            where="compare.joint",
            hint=f"the most loaded joint is {mechanism.driven[int(load.argmax())]}"
            if load.max() > NO_LOAD * max(weight, 1.0)
            else "check gravity and masses; `equipoise analyze` lists what every joint holds",
        )
    model = mechanism.model
    slide = model.jnt_type[index] == mujoco.mjtJoint.mjJNT_SLIDE
    body = int(model.jnt_bodyid[index])
    mount = joint_shaft(model, index)
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_quat[body])
    q, torque = states.driven[:, column], states.holding[:, column]
    if slide:
        size, top = float(torque.mean()), 0.0
    else:
        s, c = np.linalg.lstsq(np.stack([np.sin(q), np.cos(q)], axis=1), torque, rcond=None)[0]
        size, top = float(np.hypot(s, c)), float(np.arctan2(c, -s))
    reach = _reach(mechanism, body, size, float(np.ptp(q)), bool(slide)) if room is None else room
    return Site(
        mechanism,
        joint,
        bool(slide),
        size,
        top,
        mount,
        model.body(body).name,
        turn.reshape(3, 3),
        np.array(model.jnt_pos[index]),
        _up(states, mount),
        reach,
        float(q.min()),
        float(q.max()),
    )


def _up(states: States, mount: Mount) -> float:
    e, f, _ = mount.frame
    turned = states.rotation(mount.at.body)[0][len(states) // 2]
    against = -states.mechanism.gravity @ turned
    return float(np.arctan2(against @ f, against @ e))


def _reach(mechanism: Mechanism, body: int, load: float, travel: float, slide: bool) -> float:
    """About a third of the load's lever arm; of a slide its travel."""
    if slide:
        return max(travel, LEAST)
    gravity = float(np.linalg.norm(mechanism.gravity))
    carried = float(mechanism.model.body_subtreemass[body])
    arm = load / (gravity * carried) if gravity * carried > 0 else 0.3
    return float(np.clip(SHARE * arm, LEAST, MOST))

"""What springs can be hung on: rigid groups of bodies, the joints between them, and the pairs worth a spring."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.loops import ancestors
from equipoise.mechanism import Mechanism

SPAN = 4
"""Joints that a candidate may span at most."""
PARALLEL = 1e-6


@dataclass(frozen=True, eq=False)
class Group:
    """Bodies that move as one, named by the first of them.

    skeleton (S, 2, 3) are its straight pieces in the frame of that body, m: from its own joint to the joints,
    bodies and tip that it carries; centre (3,) is its centre of mass; `low` and `high` (3,) are the box of both ends.
    """

    body: str
    members: tuple[str, ...]
    skeleton: Array
    centre: Array

    @property
    def low(self) -> Array:
        """Least coordinates of the skeleton."""
        return self.skeleton.reshape(-1, 3).min(axis=0)

    @property
    def high(self) -> Array:
        """Largest coordinates of the skeleton."""
        return self.skeleton.reshape(-1, 3).max(axis=0)

    def distance(self, places: Array) -> Array:
        """How far places (..., 3) in the body's frame lie from the skeleton, m."""
        start, along = self.skeleton[:, 0], self.skeleton[:, 1] - self.skeleton[:, 0]
        square = np.maximum((along * along).sum(-1), 1e-300)
        gap = np.asarray(places)[..., None, :] - start
        share = np.clip((gap * along).sum(-1) / square, 0.0, 1.0)
        return np.linalg.norm(gap - share[..., None] * along, axis=-1).min(axis=-1)


@dataclass(frozen=True, eq=False)
class Ground:
    """A mechanism seen as groups, at its reference posture: what candidates are made on.

    loads (nd,) is the largest holding effort of each driven joint over the sweep, worth the driven joints that are
    worth a spring; size in m is the longest way from the base to a tip.
    """

    mechanism: Mechanism
    loads: Array
    worth: tuple[str, ...]

    @cached_property
    def _posture(self) -> mujoco.MjData:
        data = mujoco.MjData(self.mechanism.model)
        data.qpos[:] = self.mechanism.reference
        mujoco.mj_kinematics(self.mechanism.model, data)
        return data

    @cached_property
    def groups(self) -> dict[str, Group]:
        """All groups that carry or are carried by a joint, by the name of their body."""
        model = self.mechanism.model
        found = {}
        for root in sorted(set(model.body_weldid.tolist())):
            members = [int(b) for b in np.flatnonzero(model.body_weldid == root)]
            group = self._group(root, members)
            found[group.body] = group
        return found

    def _group(self, root: int, members: list[int]) -> Group:
        model, data = self.mechanism.model, self._posture
        turned, origin = data.xmat[root].reshape(3, 3), data.xpos[root]

        def local(place: Array) -> Array:
            return (place - origin) @ turned

        carried = [b for b in range(1, model.nbody) if model.body_parentid[b] in members and b not in members]
        ends = [local(data.xpos[b]) for b in [*members[1:], *carried]]
        masses = model.body_mass[members]
        places = np.array([local(data.xpos[b] + data.xmat[b].reshape(3, 3) @ model.body_ipos[b]) for b in members])
        centre = masses @ places / masses.sum() if masses.sum() > 0 else places.mean(axis=0)
        far = [end for end in ends if np.linalg.norm(end) > 1e-6]
        if not far and root:
            far = [2.0 * centre]
        pieces = [(np.zeros(3), end) for end in far] or [(np.zeros(3), np.zeros(3))]
        names = tuple(model.body(b).name for b in members)
        return Group(names[0], names, np.array(pieces), centre)

    def group_of(self, body: str) -> Group:
        """The group of a body; raises InputError for a body that does not exist."""
        root = int(self.mechanism.model.body_weldid[self.mechanism.body_id(body)])
        return self.groups[self.mechanism.model.body(root).name]

    def in_group(self, body: str, places: Array) -> Array:
        """Places (C, 3) of a body in the frame of its group."""
        model, data = self.mechanism.model, self._posture
        one = self.mechanism.body_id(body)
        root = int(model.body_weldid[one])
        world = data.xpos[one] + places @ data.xmat[one].reshape(3, 3).T
        return (world - data.xpos[root]) @ data.xmat[root].reshape(3, 3)

    def seen_from(self, other: str, body: str, places: Array) -> Array:
        """Places (C, 3) of a body in the frame of another of its group."""
        model, data = self.mechanism.model, self._posture
        one = self.mechanism.body_id(other)
        root = int(model.body_weldid[one])
        world = data.xpos[root] + self.in_group(body, places) @ data.xmat[root].reshape(3, 3).T
        return (world - data.xpos[one]) @ data.xmat[one].reshape(3, 3)

    def between(self, a: str, b: str) -> tuple[int, ...]:
        """Numbers of the joints that two bodies do not share."""
        model = self.mechanism.model
        ways = [{int(model.dof_jntid[d]) for d in ancestors(model, self.mechanism.body_id(body))} for body in (a, b)]
        return tuple(sorted(ways[0] ^ ways[1]))

    def pairs(self) -> tuple[tuple[str, str], ...]:
        """Pairs of groups worth a spring: every joint between them is worth one, and they span at most four.

        Where an idle joint lies between any two groups, the pairs that span a joint worth a spring and the fewest
        others are taken.
        """
        ids = {self.mechanism.joint_id(joint) for joint in self.worth}
        spans = {pair: self.between(*pair) for pair in combinations(self.groups, 2)}
        spans = {pair: span for pair, span in spans.items() if set(span) & ids and len(span) <= SPAN}
        whole = tuple(pair for pair, span in spans.items() if set(span) <= ids)
        if whole or not spans:
            return whole
        idle = {pair: len(set(span) - ids) for pair, span in spans.items()}
        return tuple(pair for pair, count in idle.items() if count == min(idle.values()))

    def normal(self, a: str, b: str) -> tuple[Array, Array, float] | None:
        """Of two bodies that move against each other in one plane: its normal in both frames, and the offset.

        The offset is n . o in the frame of a, o being where b's own joint stands. None where they leave a plane.
        """
        model, data = self.mechanism.model, self._posture
        axes = []
        for joint in self.between(a, b):
            if model.jnt_type[joint] != mujoco.mjtJoint.mjJNT_HINGE:
                return None
            axes.append(data.xaxis[joint])
        if not axes or any(np.linalg.norm(np.cross(axes[0], axis)) > PARALLEL for axis in axes[1:]):
            return None
        one, other = self.mechanism.body_id(a), self.mechanism.body_id(b)
        n_a, n_b = (data.xmat[body].reshape(3, 3).T @ axes[0] for body in (one, other))
        return n_a, n_b, float(axes[0] @ (data.xpos[other] - data.xpos[one]))

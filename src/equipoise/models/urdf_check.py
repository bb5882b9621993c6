"""What makes the joints of a URDF file one tree."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

from equipoise.errors import ModelError, nearest
from equipoise.models.notices import some

if TYPE_CHECKING:
    from equipoise.models.urdf_tree import Joint


def check_tree(links: Collection[str], joints: list[Joint], where: str) -> None:
    """Raise ModelError unless the joints (their links known) make one tree of all links, from one root."""
    names = list(links)
    above: dict[str, Joint] = {}
    for joint in joints:
        for end in (joint.parent, joint.child):
            if end not in links:
                raise ModelError(f"joint {joint.name!r} joins the unknown link {end!r}", where=where,
                                 hint=nearest(end, names))  # fmt: skip
        if joint.child in above:
            both = f"{above[joint.child].name!r} and {joint.name!r}"
            raise ModelError(f"link {joint.child!r} hangs on two joints, {both}", where=where,
                             hint="a URDF is a tree: close loops in MJCF, with an equality")  # fmt: skip
        above[joint.child] = joint
    roots = [name for name in names if name not in above]
    if len(roots) > 1:
        raise ModelError(f"links {some(roots)} are joined to nothing above them: one root is needed", where=where)
    below: dict[str, list[str]] = {}
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint.child)
    reached = roots[:]
    for name in reached:
        reached.extend(below.get(name, []))
    if len(reached) < len(names):
        lost = some(sorted(set(names) - set(reached)))
        raise ModelError(f"there is a loop of links and no root above it: {lost}", where=where)
    if "world" in links and roots != ["world"]:
        raise ModelError("a link that moves is named 'world'", where=where, hint="rename it: `world` is the base")


def check_mimic(joints: dict[str, Joint], where: str) -> None:
    """Raise ModelError for a joint that mimics one that is not there, or at last itself."""
    for joint in joints.values():
        seen = [joint.name]
        while joints[seen[-1]].mimic:
            source = joints[seen[-1]].mimic
            if source not in joints:
                raise ModelError(f"joint {seen[-1]!r} mimics the unknown joint {source!r}", where=where,
                                 hint=nearest(source, list(joints)))  # fmt: skip
            if source in seen:
                raise ModelError(f"joints mimic each other in a circle: {some([*seen, source])}", where=where)
            seen.append(source)

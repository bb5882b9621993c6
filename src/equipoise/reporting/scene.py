"""The mechanism in one pose as lines and points: skeleton, springs, counterweights, payloads."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from equipoise.affine import Array
from equipoise.balancers.counterweight import Counterweight
from equipoise.balancers.paths import Sketch
from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.mechanism import Mechanism
from equipoise.states import States

FLAT = 1e-6
BARS = (int(mujoco.mjtGeom.mjGEOM_CAPSULE), int(mujoco.mjtGeom.mjGEOM_CYLINDER))


@dataclass(frozen=True, eq=False)
class Scene:
    """World coordinates, m, of what is drawn in one pose.

    bars are link segments (from, to) per rigid group; joints (J, 3) with `driven` flags; springs (part number, end,
    end) and paths (part number, sketch) with what leads to them; struts connect a link to a point that lies off it;
    weights (part number, kg, place) and payloads (kg, place); grounded are attachment points on the base, feet the
    places where the mechanism stands.
    """

    bars: list[tuple[Array, Array]]
    joints: Array
    driven: Array
    springs: list[tuple[int, Array, Array]]
    paths: list[tuple[int, Sketch]]
    struts: list[tuple[Array, Array]]
    weights: list[tuple[int, float, Array]]
    payloads: list[tuple[float, Array]]
    grounded: list[Array]
    feet: list[Array]

    @property
    def points(self) -> Array:
        """All points (P, 3), for the picture's frame."""
        ends = [end for bar in self.bars for end in bar] + [end for _, a, b in self.springs for end in (a, b)]
        more = [place for *_, place in self.weights] + [place for _, place in self.payloads]
        led = [place for _, sketch in self.paths for place in sketch.points]
        return np.vstack([*ends, *more, *led, self.joints])


def scene(design: Design, states: States, row: int) -> Scene:
    """The scene of one row of states."""
    mechanism = design.mechanism
    local = skeleton(mechanism)
    xpos, xmat = states.kin.xpos[row], states.kin.xmat[row]
    groups = {
        group: [(xpos[a] + xmat[a] @ p, xpos[b] + xmat[b] @ r) for a, p, b, r in bars] for group, bars in local.items()
    }
    springs, paths, weights, struts, grounded = [], [], [], [], []

    def attach(body: str, place: Array) -> None:
        group = int(mechanism.model.body_weldid[mechanism.body_id(body)])
        foot = _foot(groups.get(group, []), place)
        if group == 0 and not groups.get(0):
            grounded.append(place)
        elif foot is not None:
            struts.append((foot, place))

    for number, balancer in enumerate(design.balancers):
        if isinstance(balancer, Spring):
            drawn = balancer.path.sketch(states, row)
            paths.append((number, drawn))
            if drawn.spring is not None:
                springs.append((number, drawn.spring[0], drawn.spring[-1]))
            for point in drawn.anchors:
                attach(point.body, states.point(point)[0][row])
        elif isinstance(balancer, Counterweight):
            mass, where = balancer.place(design.values)
            body = mechanism.body_id(balancer.at.body)
            place = xpos[body] + xmat[body] @ where
            weights.append((number, mass, place))
            attach(balancer.at.body, place)
    struts += _cables(design, states, row)
    payloads = []
    for point, mass in zip(states.payload_points, states.payload_mass[row], strict=True):
        place = states.point(point)[0][row]
        payloads.append((float(mass), place))
        attach(point.body, place)
    joints, driven = _joints(mechanism, xpos, xmat)
    return Scene(
        [bar for bars in groups.values() for bar in bars], joints, driven, springs, paths, struts, weights, payloads,
        grounded,
        _feet(mechanism, xpos, groups.get(0, [])),
    )  # fmt: skip


def _cables(design: Design, states: States, row: int) -> list[tuple[Array, Array]]:
    """The cables of a platform that no spring on a bare reel draws."""
    platform = design.mechanism.platform
    drawn = {getattr(getattr(balancer, "path", None), "cable", None) for balancer in design.balancers}
    left = [cable for cable in platform.cables if cable not in drawn] if platform is not None else []
    found = []
    for cable in left:
        anchor, end = (states.point(point)[0][row] for point in design.mechanism.cable(cable))
        found.append((anchor, end))
    return found


def _feet(mechanism: Mechanism, xpos: Array, base: list[tuple[Array, Array]]) -> list[Array]:
    """Where the base's own bars begin, else the first moving bodies; a platform on cables stands nowhere."""
    if mechanism.platform is not None and mechanism.platform.cables:
        return []
    if base:
        return [base[0][0]]
    model = mechanism.model
    roots = (model.body_jntnum > 0) & (model.body_weldid[model.body_parentid] == 0)
    return [xpos[body] for body in np.flatnonzero(roots)]


def skeleton(mechanism: Mechanism) -> dict[int, list[tuple[int, Array, int, Array]]]:
    """Bars of each rigid group: (body, local point, body, local point) from a frame to the frames it carries."""
    model = mechanism.model
    groups: dict[int, list[tuple[int, Array, int, Array]]] = {}
    origin = np.zeros(3)
    tips = {body: _tip(model, body) for body in range(1, model.nbody)}
    for body in range(1, model.nbody):
        parent = int(model.body_parentid[body])
        carries = model.body_jntnum[body] == 0 and not _has_children(model, body) and tips[body] is None
        massless = model.body_mass[body] <= 0
        if np.linalg.norm(model.body_pos[body]) > 1e-6 and not (carries and massless and parent == 0):
            group = int(model.body_weldid[parent])
            groups.setdefault(group, []).append((parent, origin, parent, np.array(model.body_pos[body])))
        tip = tips[body]
        if tip is not None and not _has_children(model, body):
            groups.setdefault(int(model.body_weldid[body]), []).append((body, origin, body, tip))
    for site_a, site_b in _pins(model):
        for body, place in (site_a, site_b):
            if np.linalg.norm(place) > 1e-6:
                groups.setdefault(int(model.body_weldid[body]), []).append((body, origin, body, place))
    if mechanism.platform is not None and mechanism.platform.cables:
        ends = list(dict.fromkeys(mechanism.cable(cable)[1] for cable in mechanism.platform.cables))
        body = mechanism.body_id(mechanism.platform.point.body)
        places = np.array([point.at for point in ends], dtype=float)
        bars = [(body, places[a], body, places[b]) for a, b in outline(places)]
        groups.setdefault(int(model.body_weldid[body]), []).extend(bars)
    return groups


def outline(places: Array) -> list[tuple[int, int]]:
    """Edges of the convex body that points (P, 3) span: a polygon where they lie in a plane."""
    if len(places) < 3:
        return [(0, 1)] if len(places) == 2 else []
    away = places - places.mean(axis=0)
    _, spread, axes = np.linalg.svd(away, full_matrices=False)
    if spread[-1] <= FLAT * spread[0]:
        flat = away @ axes[:2].T
        order = np.argsort(np.arctan2(flat[:, 1], flat[:, 0]))
        return list(zip(order.tolist(), np.roll(order, -1).tolist(), strict=True))
    from scipy.spatial import ConvexHull

    hull = ConvexHull(places)
    edges = []
    for facet, (corners, beside) in enumerate(zip(hull.simplices, hull.neighbors, strict=True)):
        for opposite, other in enumerate(beside):
            # Triangles of one face share their plane, and the edge between them is none.
            if facet < other and np.abs(hull.equations[facet] - hull.equations[other]).max() > FLAT:
                a, b = (int(corner) for index, corner in enumerate(corners) if index != opposite)
                edges.append((a, b))
    return edges


def _has_children(model: mujoco.MjModel, body: int) -> bool:
    offset = np.linalg.norm(model.body_pos, axis=1) > 1e-6
    return bool(((model.body_parentid == body) & offset & (np.arange(model.nbody) > 0)).any())


def _tip(model: mujoco.MjModel, body: int) -> Array | None:
    """Where a last link ends: the far end of its bar where the file draws one, else its centre of mass."""
    ends = []
    for geom in np.flatnonzero((model.geom_bodyid == body) & np.isin(model.geom_type, BARS)):
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, model.geom_quat[geom])
        half = turn.reshape(3, 3)[:, 2] * model.geom_size[geom, 1]
        ends += [model.geom_pos[geom] + half, model.geom_pos[geom] - half]
    if ends:
        return np.array(max(ends, key=lambda end: float(np.linalg.norm(end))))
    centre = np.array(model.body_ipos[body])
    return centre if model.body_mass[body] > 0 and np.linalg.norm(centre) > 1e-3 else None


def _pins(model: mujoco.MjModel) -> list[tuple[tuple[int, Array], tuple[int, Array]]]:
    """Bodies and places that connect equalities hold together."""
    pins = []
    for number in np.flatnonzero(model.eq_type == mujoco.mjtEq.mjEQ_CONNECT):
        first, second = int(model.eq_obj1id[number]), int(model.eq_obj2id[number])
        if model.eq_objtype[number] == mujoco.mjtObj.mjOBJ_SITE:
            pins.append(tuple((int(model.site_bodyid[s]), np.array(model.site_pos[s])) for s in (first, second)))
        else:
            data = model.eq_data[number]
            pins.append(((first, np.array(data[:3])), (second, np.array(data[3:6]))))
    return pins


def _joints(mechanism: Mechanism, xpos: Array, xmat: Array) -> tuple[Array, Array]:
    model = mechanism.model
    body = model.jnt_bodyid
    places = xpos[body] + np.einsum("jab,jb->ja", xmat[body], model.jnt_pos)
    driven = np.isin(np.arange(model.njnt), mechanism.driven_ids)
    pins = [xpos[b] + xmat[b] @ place for pin in _pins(model) for b, place in pin[:1]]
    return np.vstack([places, *pins]) if pins else places, np.concatenate([driven, np.zeros(len(pins), dtype=bool)])


def _foot(bars: list[tuple[Array, Array]], place: Array) -> Array | None:
    """The nearest point of a link's bars, or None where the place lies on one."""
    feet = []
    for a, b in bars:
        along = b - a
        share = np.clip((place - a) @ along / max(along @ along, 1e-18), 0.0, 1.0)
        feet.append(a + share * along)
    if not feet:
        return None
    foot = min(feet, key=lambda point: float(np.linalg.norm(point - place)))
    return foot if np.linalg.norm(foot - place) > 1e-4 else None

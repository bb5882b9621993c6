"""reactionless_motion: the motion along a path that leaves no moment at the base, or why there is none."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from equipoise.affine import Array, Indices
from equipoise.assemble import Balancer
from equipoise.balancers.flywheel import Flywheel
from equipoise.balancers.spring import Spring
from equipoise.errors import InfeasibleError, InputError, LoopError, nearest
from equipoise.loops import close_loops, tighten_loops
from equipoise.loops.posture import integrate
from equipoise.mechanism import Mechanism
from equipoise.motion.drivers import Driver, Pieces, as_driver
from equipoise.posefile import held
from equipoise.spins import momentum_forms, spin_form
from equipoise.sweep import Sweep

NODES = 16
"""Instants of a piece, at which rates are found together."""
FIRST = 16
"""Pieces to begin with; they grow or shrink with what they can follow."""
SMALLEST = 1e-4
TURNS = 25
SETTLED = 1e-12
NEWTON = 6
FARTHEST = 1.0
TAIL = 1e-13
BALANCED = 1e-8
"""Share of the moving mass times the mechanism's size that may move and still count as at rest."""
DEGENERATE = 1e-7
MEETS = 1e-6


@dataclass(frozen=True, eq=False)
class ReactionlessMotion:
    """Drivers {driven joint: polynomial pieces} that follow the path with zero momentum from 0 to `duration`, s.

    holonomic says whether the orientation is a function of position (then it does not depend on the way, and form
    {body: K, kg m^2} gives it: sum K_b alpha_b stays constant); None is form where it is not.
    """

    mechanism: Mechanism
    duration: float
    drivers: Mapping[str, Driver]
    form: Mapping[str, float] | None

    @property
    def holonomic(self) -> bool:
        """Whether the path alone, and not how it is run, decides the orientation."""
        return self.form is not None

    def sweep(self, samples: int = 721) -> Sweep:
        """The motion as a sweep."""
        return Sweep.motion(self.mechanism, self.drivers, duration=self.duration, samples=samples)


def reactionless_motion(
    mechanism: Mechanism,
    path: Mapping[str, Driver | Any],
    *,
    duration: float,
    start: Mapping[str, float] | None = None,
    balancers: Sequence[Balancer] = (),
    values: Mapping[str, float] | None = None,
) -> ReactionlessMotion:
    """The motion of a force-balanced mechanism that follows a path without force or moment at the base.

        c(q) = c(t),   L(q, qdot) = h(q) qdot_driven = 0   =>   [dc/dq_driven; h] qdot_driven = [dc/dt; 0]

    path {joint: driver} prescribes as many joints, driven or not (such as platform_x and platform_z), as the drives
    leave when the angular momentum's rows are taken off; the orientation follows. It begins where the mechanism
    stands: at its reference, or at `start` {driven joint: position}. balancers with their values count. Integrated by
    Chebyshev pieces whose last coefficients are below 1e-13 rad (or m).

    Raises InfeasibleError where force is not balanced, where every motion turns the base, and where the path can only
    be followed by turning it, with the time; LoopError at singularities; InputError for paths that do not fit.
    """
    model = mechanism.model
    balancers, values = _moving(balancers, values or {})
    if not duration > 0:
        raise InputError(f"the duration is {duration:g} s", where="reactionless")
    joints = [mechanism.joint_id(name) for name in path]
    if any(model.jnt_type[j] not in (2, 3) for j in joints):
        raise InputError("a path prescribes hinges and slides", where="reactionless.path")
    drivers = {name: as_driver(law) for name, law in path.items()}
    for name, law in drivers.items():
        law.check(f"path, joint {name}")
    driven = held(mechanism)
    for name, value in (start or {}).items():
        if name not in mechanism.driven:
            raise InputError(
                f"{name!r} is not driven", where="reactionless.start", hint=nearest(name, mechanism.driven)
            )
        driven[mechanism.driven.index(name)] = value
    q, D = close_loops(mechanism, driven[None])
    rows = _rows(mechanism, q, D, balancers, values)
    _fits(mechanism, path, rows)
    _meets(mechanism, drivers, duration, q[0])
    problem = _Problem(mechanism, drivers, duration, balancers, values, rows, model.jnt_dofadr[joints])
    pieces = problem.integrate(q)
    edges = np.array([edge for edge, _ in pieces] + [duration])
    found = {
        joint: Pieces(tuple(edges.tolist()), tuple(tuple(coefs[:, k].tolist()) for _, coefs in pieces))
        for k, joint in enumerate(mechanism.driven)
    }
    return ReactionlessMotion(mechanism, duration, found, spin_form(mechanism, balancers, values))


def _moving(
    balancers: Sequence[Balancer], values: Mapping[str, float]
) -> tuple[tuple[Balancer, ...], Mapping[str, float]]:
    """What moves masses, with values of all unknowns; a spring's unknowns move none."""
    moving = tuple(b for b in balancers if not isinstance(b, Spring) or b.masses)
    known = {unknown.name: 0.0 for b in moving if isinstance(b, Spring) for unknown in b.unknowns} | dict(values)
    for balancer in moving:
        missing = [unknown.name for unknown in balancer.unknowns if unknown.name not in known]
        if missing and not isinstance(balancer, Flywheel):
            raise InputError(
                f"the motion depends on {', '.join(missing)}, which is still to be found",
                where=f"reactionless, {balancer.name}",
                hint="give the mass and the place of all that is added: balance over `any_motion` finds them first",
            )
    return moving, known


def _rows(
    mechanism: Mechanism, q: Array, D: Array, balancers: Sequence[Balancer], values: Mapping[str, float]
) -> Array:
    """Directions (r, 3) of angular momentum that drives can bring; refuses mechanisms whose force is not balanced."""
    p, L = momentum_forms(mechanism, q, D, balancers, values)
    size = float(np.abs(L).max(initial=0.0))
    near = np.abs(p).max(initial=0.0)
    reach = mechanism.mass * max(float(np.ptp(q)) if q.size else 0.0, 1e-3)
    if near > BALANCED * max(reach, 1e-12):
        joint = mechanism.driven[int(np.abs(p).max(axis=(0, 1)).argmax())]
        raise InfeasibleError(
            f"the force is not balanced: moving {joint} moves the centre of mass ({near:.3g} kg m/s per unit of its "
            "velocity), so every motion along the path pushes the base",
            where="reactionless",
            hint="balance the force first: limits: [{balanced: force}]",
        )
    if size <= BALANCED * mechanism.mass * 1e-3:
        raise InputError(
            "the angular momentum vanishes in every motion: the mechanism is reactionless as it is",
            where="reactionless",
            hint="use sweep: {motion: ...}",
        )
    _, singular, axes = np.linalg.svd(np.swapaxes(L, 1, 2).reshape(-1, 3))
    return axes[: int((singular > 1e-9 * singular[0]).sum())]


def _fits(mechanism: Mechanism, path: Mapping[str, Any], rows: Array) -> None:
    drives, taken = len(mechanism.driven), len(rows)
    if drives <= taken:
        raise InfeasibleError(
            f"{mechanism.name} has {drives} drive{'s' * (drives > 1)}, and zero angular momentum takes {taken}: every "
            "motion turns the base",
            where="reactionless",
            hint="a flywheel or counter-rotors are needed, or one more drive",
        )
    if len(path) != drives - taken:
        raise InputError(
            f"the path prescribes {len(path)} joints; {drives} drives less {taken} for the momentum leave "
            f"{drives - taken}",
            where="reactionless.path",
            hint=f"prescribe {drives - taken}, such as positions of the platform, and leave its orientation open",
        )


def _meets(mechanism: Mechanism, drivers: Mapping[str, Driver], duration: float, q: Array) -> None:
    for name, law in drivers.items():
        here = float(q[mechanism.model.jnt_qposadr[mechanism.joint_id(name)]])
        begins = float(law.at(np.zeros(1), duration, f"path, joint {name}").value[0])
        if abs(begins - here) > MEETS * max(1.0, abs(here)):
            raise InputError(
                f"the path begins at {name} = {begins:.9g}, the mechanism stands at {here:.9g}",
                where="reactionless.path",
                hint="begin the path there, or give `start`",
            )


def _integral(coefs: Any) -> Array:
    """Chebyshev coefficients (NODES + 1, k) of the integrals from -1 of series (NODES, k)."""
    return np.stack([chebyshev.chebint(column, lbnd=-1.0) for column in coefs.T], axis=1)


def _at(nodes: Array, coefs: Array) -> Array:
    """Values (M, k) of Chebyshev series (., k) at nodes (M,)."""
    return np.asarray(chebyshev.chebval(nodes, coefs), dtype=float).T


@dataclass(frozen=True, eq=False)
class _Problem:
    """qdot_driven = [dc/dq; h]^-1 [dc/dt; 0] along a path."""

    mechanism: Mechanism
    drivers: Mapping[str, Driver]
    duration: float
    balancers: Sequence[Balancer]
    values: Mapping[str, float]
    rows: Array
    dofs: Indices

    def integrate(self, q: Array) -> list[tuple[float, Array]]:
        """Pieces (start time, Chebyshev coefficients (NODES, nd)) from 0 to the duration."""
        time, step, found = 0.0, self.duration / FIRST, []
        while time < self.duration * (1 - 1e-12):
            step = min(step, self.duration - time)
            piece = self._piece(q, time, step)
            if piece is None:
                step /= 2
                if step < SMALLEST * self.duration:
                    raise InfeasibleError(
                        f"no motion without reaction was found beyond t = {time:.6g} s", where="reactionless"
                    )
                continue
            coefs, q = piece
            found.append((time, coefs))
            time += step
            step *= 2
        return found

    def _piece(self, begin: Array, time: float, step: float) -> tuple[Array, Array] | None:
        """One piece by repeated integration of the rates at all nodes together; None where it does not settle."""
        nodes = np.cos(np.pi * np.arange(NODES) / (NODES - 1))[::-1]
        instants = time + 0.5 * step * (nodes + 1)
        places = self.mechanism.model.jnt_qposadr[self.mechanism.driven_ids]
        first, q = begin[:, places], np.repeat(begin, NODES, axis=0)
        into, driven = chebyshev.chebvander(nodes, NODES - 1), q[:, places]
        for _ in range(TURNS):
            try:
                q, D = tighten_loops(self.mechanism, q, NEWTON)
            except LoopError:
                if step < 4 * SMALLEST * self.duration:
                    raise
                return None
            rates = self._rates(q, D, instants)
            # dependent joints move along, so that Newton's steps find the loops nearly closed
            every = (D @ rates[..., None])[..., 0]
            grown = _integral(np.linalg.solve(into, every)) * (0.5 * step)
            q = integrate(self.mechanism.model, np.repeat(begin, NODES, axis=0), _at(nodes, grown))
            own = _integral(np.linalg.solve(into, rates)) * (0.5 * step)
            new = first + _at(nodes, own)
            move, driven = float(np.abs(new - driven).max()), new
            q[:, places] = driven
            if not move < FARTHEST:
                return None
            if move < SETTLED:
                own[0] += first[0]
                return (own, q[-1:]) if float(np.abs(own[-2:]).max()) < TAIL else None
        return None

    def _rates(self, q: Array, D: Array, instants: Array) -> Array:
        """Velocities (N, nd) of the drives."""
        wanted = [law.at(instants, self.duration, f"path, joint {name}").rate for name, law in self.drivers.items()]
        _, L = momentum_forms(self.mechanism, q, D, self.balancers, self.values)
        h = self.rows @ L
        path = np.broadcast_to(D[:, self.dofs], (len(q), len(self.dofs), h.shape[2]))
        matrix = np.concatenate([path, h / max(float(np.abs(h).max()), 1e-300)], axis=1)
        singular = np.linalg.svd(matrix, compute_uv=False)
        worst = int(np.argmin(singular[:, -1] / singular[:, 0]))
        if singular[worst, -1] < DEGENERATE * singular[worst, 0]:
            raise InfeasibleError(
                f"at t = {instants[worst]:.6g} s the path can only be followed by turning the base: there the drives' "
                "angular momentum depends on the path's own motion alone",
                where="reactionless",
                hint="lead the path around that posture, or add a counter-rotor",
            )
        right = np.zeros((len(q), matrix.shape[1]))
        right[:, : len(wanted)] = np.stack(wanted, axis=1)
        return np.asarray(np.linalg.solve(matrix, right[..., None])[..., 0], dtype=float)

"""Ratios against stated baselines, measured side by side in one run; times vary with the machine, ratios much less.

Run: uv run --extra robots --group bench python benchmarks/ratios.py
"""

from __future__ import annotations

import itertools
import os
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import cvxpy as cp
import mujoco
import numpy as np
from scipy.optimize import differential_evolution
from scipy.spatial.transform import Rotation

import equipoise as eq
from equipoise import chunks
from equipoise.assemble import build
from equipoise.objective import Aim
from equipoise.solve.exchange import solve
from equipoise.solve.program import Term

UR10 = "package://example-robot-data/robots/ur_description/urdf/ur10_robot.urdf"
ENOUGH = 1e-3
PATIENCE = 120.0
TIGHT = dict.fromkeys(("tol_gap_abs", "tol_gap_rel", "tol_feas", "tol_ktratio"), 1e-11)
"""Tolerances of Clarabel at which its optimum is told to ten digits: by default it stops some 1e-6 short."""


def best_of(repeat: int, run: Callable[[], object]) -> float:
    """Shortest of several times, s."""
    times = []
    for _ in range(repeat):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times)


def line(what: str, baseline: str, theirs: float, ours: float, note: str = "") -> None:
    print(f"{what:<44}{baseline:<34}{theirs:>10.4f} s{ours:>10.4f} s{theirs / ours:>9.1f} x  {note}", flush=True)


def kinematics() -> None:
    """Jacobians of a point on the last link and the holding torque of 20 000 poses."""
    arm = eq.Mechanism.load(UR10)
    sweep = eq.Sweep.sobol(arm, 20_000)
    model, data = arm.model, mujoco.MjData(arm.model)
    body = arm.body_id("wrist_3_link")
    jacobian = np.zeros((3, model.nv))

    def plain() -> np.ndarray:
        torque = np.zeros((len(sweep.poses), model.nv))
        for index, pose in enumerate(sweep.poses):
            data.qpos[:] = pose
            mujoco.mj_fwdPosition(model, data)
            mujoco.mj_fwdVelocity(model, data)
            mujoco.mj_jac(model, data, jacobian, None, data.xpos[body], body)
            torque[index] = data.qfrc_bias
        return torque

    def ours() -> np.ndarray:
        states = arm.states(sweep)
        states.point(eq.Point("wrist_3_link"))
        return states.holding

    assert np.abs(plain() - ours()).max() < 1e-9
    line("kinematics, 20 000 poses of a UR10", "plain mj_fwd loop", best_of(2, plain), best_of(3, ours))


def ten_unknowns() -> tuple[eq.Mechanism, list[eq.Spring], eq.Sweep]:
    """A UR10 with five springs of unknown rate and preload at 2048 poses."""
    arm = eq.Mechanism.load(UR10)
    bodies = ["upper_arm_link", "upper_arm_link", "forearm_link", "forearm_link", "wrist_1_link"]
    springs = [
        eq.Spring(
            f"s{i}",
            eq.Line(arm.at("shoulder_link", 0.02 * i, 0.1, 0.15 - 0.03 * i), arm.at(body, 0.03, 0, 0.2)),
            eq.Linear(),
        )
        for i, body in enumerate(bodies)
    ]
    return arm, springs, eq.Sweep.sobol(arm, 2048)


def balance() -> None:
    """The convex program alone: 2048 poses x 6 joints x 10 unknowns, rates not negative."""
    arm, springs, sweep = ten_unknowns()
    states = arm.states(sweep)
    for norm in ("rms", "peak", "mean"):
        program = build(arm, springs, sweep, states, (Aim(norm=norm),))
        (term,) = program.terms
        b, A = term.b.ravel(), term.A.reshape(term.b.size, -1) * program.scale
        found: list[float] = []

        def reference(norm: str = norm, A: np.ndarray = A, b: np.ndarray = b, program=program, found=found) -> None:
            theta = cp.Variable(A.shape[1])
            r = A @ theta + b
            value = {
                "rms": cp.norm(r) / np.sqrt(len(states)),
                "peak": cp.norm_inf(r),
                "mean": cp.norm1(r) / len(states),
            }
            held = np.flatnonzero(np.isfinite(program.lower))
            task = cp.Problem(cp.Minimize(value[norm]), [theta[held] >= program.lower[held]])
            task.solve(solver=cp.CLARABEL)
            found[:] = [float(task.value)]

        theirs = best_of(2, reference)
        ours = best_of(3, lambda norm=norm: solve(build(arm, springs, sweep, states, (Aim(norm=norm),))))
        value = solve(program)
        agreement = abs(value.objective - found[0]) / found[0]
        line(
            f"balance {norm}, 2048 x 6 x 10",
            "cvxpy + Clarabel, same program",
            theirs,
            ours,
            f"agree to {agreement:.0e}, gap {value.gap.gap:.0e}",
        )


# The link of Arakelian & Ghazaryan 2008 with the mass of its wire; names, bounds, and a plain formula of the torque.
FREE = {
    "s1.law.k": (100.0, 3000.0),
    "s1.path.line.0.x": (-0.15, 0.15),
    "s1.path.line.0.z": (0.05, 0.30),
    "s1.path.line.1.x": (0.10, 0.35),
    "s1.path.line.1.z": (-0.10, 0.10),
    "s1.law.free_length": (0.20, 0.40),
}
ANGLES = np.radians(np.arange(120, 181))


def plain_cost(x: np.ndarray, norm: str) -> float:
    """Peak or rms of the link's torque by hand-written formulas; closed coils are penalised."""
    k, xb, yb, r, offset = x[:5] if len(x) > 4 else (*x, 0.0)
    free = x[5] if len(x) > 5 else 0.3
    own = 7800 * np.pi * 8.0 * np.sqrt(0.04**3 * 80 * k / (2 * 81e9))
    px, py = r * np.sin(ANGLES) - offset * np.cos(ANGLES), r * np.cos(ANGLES) + offset * np.sin(ANGLES)
    length = np.sqrt((px - xb) ** 2 + (py - yb) ** 2)
    arm = (xb * py - yb * px) / length
    torque = 8 * 0.183 * 9.81 * np.sin(ANGLES) + 0.5 * own * 9.81 * px + k * (length - free) * arm
    size = np.abs(torque).max() if norm == "peak" else np.sqrt((torque**2).mean())
    return float(size + 1e3 * max(0.0, (free - length).max()))


def shape() -> None:
    """Time until differential evolution over all unknowns is within 0.1 % of the value that `shape` returns."""
    link = eq.chain([eq.Link("link", length=0.3, mass=8.0, com=0.183)], datum="up")
    grid = eq.Sweep.grid(link, {"link_joint": (ANGLES[0], ANGLES[-1], len(ANGLES))})
    wire = eq.WireMass(diameter=0.04, coils=80, wire_length=8.0)
    ends = eq.Line(eq.Point("world", (0, 0, 0.16)), eq.Point("link", (0.3, 0, 0)))
    for count in (4, 6):
        # With six parameters the coils close at the free length, whatever it is.
        law = eq.Coil(free_length=0.3, k=1000.0, closed_length=0.3 if count == 4 else None, initial_tension=0.0)
        spring = eq.Spring("s1", ends, law, mass=wire)
        free = dict(list(FREE.items())[:count])
        for norm in ("rms", "peak"):
            limits = [eq.Length("s1", min=0.3)] if count == 4 else [eq.Slack("s1")]
            run = partial(eq.shape, link, [spring], grid, free, norm=norm, limits=limits)
            ours, value = best_of(2, run), run().certificate.primal
            reached, best = evolution(lambda x, norm=norm: plain_cost(x, norm), list(free.values()), value)
            line(
                f"shape {norm}, {count} parameters of a link",
                "scipy DE, hand-written formulas",
                reached,
                ours,
                f"ours {value:.6f}, DE {best:.6f}",
            )
            states = link.states(grid)

            def model_cost(x, norm=norm, free=free, spring=spring, limits=limits, states=states):
                from equipoise.parameters import write

                moved = write([spring], dict(zip(free, x.tolist(), strict=True)))
                program = build(link, moved, grid, states, (Aim(norm=norm),), limits)
                return program.objective(np.zeros(0)) + 1e3 * max(0.0, program.violation(np.zeros(0)))

            reached, best = evolution(model_cost, list(free.values()), value)
            line(
                f"shape {norm}, {count} parameters of a link",
                "scipy DE, the same model",
                reached,
                ours,
                f"ours {value:.6f}, DE {best:.6f}",
            )


def evolution(cost: Callable[[np.ndarray], float], bounds: list, goal: float) -> tuple[float, float]:
    """Seconds until SciPy's differential evolution comes within 0.1 % of a goal (or patience ends), and its best."""
    start = time.perf_counter()
    state = {"best": np.inf, "time": np.inf}

    def watched(x: np.ndarray) -> float:
        value = cost(x)
        if value < state["best"]:
            state["best"] = value
            if value <= goal * (1 + ENOUGH) and not np.isfinite(state["time"]):
                state["time"] = time.perf_counter() - start
        return value

    def stop(*_: object, **__: object) -> bool:
        return bool(np.isfinite(state["time"])) or time.perf_counter() - start > PATIENCE

    differential_evolution(watched, bounds, seed=0, maxiter=100_000, tol=0.0, polish=False, callback=stop)
    return min(state["time"], time.perf_counter() - start), float(state["best"])


def cables(poses: int = 100_000, looped: int = 500) -> None:
    """The quadratic form of eight cables with twelve spline coefficients each; the plain loop is scaled up."""
    corners = list(itertools.product((0.0, 1.0), repeat=3))
    ends = [tuple(0.2 * (np.array(corner) - 0.5) * (1.0, 0.8, 0.6)) for corner in corners]
    robot = eq.cable_platform(tuple(corners), tuple(ends), mass=2.0)
    low, high = np.array([0.25] * 3 + [-0.3] * 3), np.array([0.75] * 3 + [0.3] * 3)
    at = low + np.random.default_rng(0).random((poses, 6)) * (high - low)
    law, aim = eq.BSpline((0.1, 1.7), pieces=9), Aim(goal="wrench")
    springs = [eq.Spring(cable, eq.Reel(cable), law) for cable in robot.platform.cables]
    a, b = np.array(corners), np.array(ends)
    scale = np.r_[1.0, 1.0, 1.0, [1 / robot.platform.length] * 3]

    def ours() -> Term:
        return chunks.rms_term(robot, springs, robot.states(eq.Sweep(at, np.ones(poses), "random")), aim)

    def plain() -> np.ndarray:
        P = np.zeros((96, 96))
        for x in at[:looped]:
            R = Rotation.from_euler("ZYX", x[3:]).as_matrix()
            C = np.zeros((6, 96))
            for i in range(8):
                arm = R @ b[i]
                d = a[i] - x[:3] - arm
                length = np.linalg.norm(d)
                wrench = np.r_[d / length, np.cross(arm, d / length)] * scale
                C[:, 12 * i : 12 * i + 12] = np.outer(wrench, law.force_basis(np.array([length]))[0][0])
            P += C.T @ C / looped
        return P

    few = chunks.rms_term(robot, springs, robot.states(eq.Sweep(at[:looped], np.ones(looped), "few")), aim).A[0]
    assert np.abs(few.T @ few - plain()).max() < 1e-12
    loop = best_of(1, plain) * poses / looped
    line("8 cables x 12 coefficients, 100 000 poses", "plain loop over poses (scaled up)", loop, best_of(2, ours))


def shaking() -> None:
    """Force, moment and drive of a four-bar in shares of before, three free plates, 0.75 kg: 720 samples, one SOCP."""
    bar = eq.four_bar(0.14, 0.05, 0.15, 0.125, masses=(0.1, 0.3, 0.25), gravity=(0, 0, 0))
    turn = eq.Sweep.motion(bar, {"crank_joint": "2*pi*t/T"}, duration=0.12, samples=720)
    reach = {"crank": 0.05, "coupler": 0.08, "rocker": 0.0625}
    plates = [eq.Counterweight(f"on_{body}", eq.Point(body), reach=r, shape=eq.Plate()) for body, r in reach.items()]
    states = bar.states(turn)
    for norm in ("rms", "peak"):
        aims = (*(Aim(goal, norm, divisor="before") for goal in ("force", "moment", "drive")), Aim("mass", cap=0.75))
        program = build(bar, plates, turn, states, aims)
        found: list[float] = []

        def reference(settings: dict, program=program, found=found) -> None:
            theta = cp.multiply(program.scale, cp.Variable(len(program.unknowns)))
            value, held = 0.0, []
            for term in program.terms:
                rows = [term.A[:, i] @ theta + term.b[:, i] for i in range(term.b.shape[1])]
                size = cp.norm(cp.vstack(rows), axis=0)
                norm = cp.max(size) if term.norm == "peak" else cp.norm(cp.multiply(np.sqrt(term.weight), size))
                held += [norm <= term.cap] if term.cap is not None else []
                value = value + (term.factor * norm if term.cap is None else 0.0)
            names = [unknown.name for unknown in program.unknowns]
            for plate in plates:
                m, x, z, J = (theta[names.index(f"{plate.name}.{what}")] for what in ("m", "mx", "mz", "J"))
                held += [cp.quad_over_lin(cp.hstack([x, z]), m) <= J, m * float(plate.reach or 0.0) ** 2 >= J]
            task = cp.Problem(cp.Minimize(value), held)
            task.solve(solver=cp.CLARABEL, **settings)
            found.append(float(task.value))

        theirs = best_of(1, lambda reference=reference: reference({}))
        reference(TIGHT)
        ours = best_of(3, lambda aims=aims: solve(build(bar, plates, turn, states, aims)))
        answer = solve(program)
        line(
            f"shaking {norm}, 720 samples x 3 free plates",
            "cvxpy + Clarabel, same program",
            theirs,
            ours,
            f"agree to {abs(answer.objective / found[1] - 1):.0e} with cvxpy at tolerances of 1e-11, to "
            f"{abs(answer.objective / found[0] - 1):.0e} at its own; gap {answer.gap.gap:.0e}",
        )


def cycle(samples: int = 10_000, looped: int = 250) -> None:
    """Force, moment and motor torques of a 3-RRR over a cycle, peaks included; the plain loop is scaled up."""
    root, side = np.sqrt(3.0), 0.1
    arm = eq.rrr3(
        ((0.0, 0.0), (0.46, 0.0), (0.23, 0.23 * root)),
        ((-side / 2, -side / (2 * root)), (side / 2, -side / (2 * root)), (0.0, side / root)),
        (0.18,) * 3,
        (0.18,) * 3,
        pose=(0.23, side / (2 * root), 0.0),
        crank_masses=(0.5,) * 3,
        rod_masses=(0.5,) * 3,
        platform_mass=3.0,
        platform_inertia=0.01,
        gravity=(0, 0, 0),
    )
    way = "(2*pi*t/T - sin(2*pi*t/T))"
    drivers = {"crank_1_joint": f"pi/3 + {way}/6", "crank_2_joint": f"4*pi/3 - {way}/6",
               "crank_3_joint": f"5*pi/3 - {way}/12"}  # fmt: skip
    sweep = eq.Sweep.motion(arm, drivers, duration=0.3, samples=samples)
    model = arm.model
    data = mujoco.MjData(model)
    motion = eq.Sweep.motion(arm, drivers, duration=0.3, samples=looped)
    driven, rest = model.jnt_dofadr[arm.driven_ids], np.setdiff1d(range(model.nv), model.jnt_dofadr[arm.driven_ids])
    pins = [(model.site(f"pin_{i}_a"), model.site(f"pin_{i}_b")) for i in (1, 2, 3)]

    def plain() -> np.ndarray:
        """Instant by instant: Newton on the pins, velocities and accelerations from Jacobians, inverse dynamics."""
        torque = np.zeros((looped, 3))
        q, J, zero = arm.reference.copy(), np.zeros((9, model.nv)), np.zeros((9, model.nv))
        ends = np.zeros((2, 3, model.nv)), np.zeros((2, 3, model.nv))
        for row, (place, v, a) in enumerate(zip(*motion.instants.rows, strict=True)):  # type: ignore[union-attr]
            q[driven] = place
            for _ in range(20):
                data.qpos[:] = q
                mujoco.mj_fwdPosition(model, data)
                gap = np.concatenate([data.site_xpos[a.id] - data.site_xpos[b.id] for a, b in pins])
                for i, (first, second) in enumerate(pins):
                    mujoco.mj_jacSite(model, data, ends[0][0], None, first.id)
                    mujoco.mj_jacSite(model, data, ends[0][1], None, second.id)
                    J[3 * i : 3 * i + 3] = ends[0][0] - ends[0][1]
                if np.abs(gap).max() < 1e-13:
                    break
                q[rest] -= np.linalg.lstsq(J[:, rest], gap, rcond=None)[0]
            D = np.zeros((model.nv, 3))
            D[driven], D[rest] = np.eye(3), -np.linalg.lstsq(J[:, rest], J[:, driven], rcond=None)[0]
            data.qvel[:] = D @ v
            mujoco.mj_fwdVelocity(model, data)
            for i, (first, second) in enumerate(pins):
                for side_, site in enumerate((first, second)):
                    at, body = data.site_xpos[site.id], int(site.bodyid[0])
                    mujoco.mj_jacDot(model, data, ends[1][side_], None, at, body)
                zero[3 * i : 3 * i + 3] = ends[1][0] - ends[1][1]
            data.qacc[:] = D @ a
            data.qacc[rest] -= np.linalg.lstsq(J[:, rest], zero @ data.qvel, rcond=None)[0]
            out = np.zeros(model.nv)
            mujoco.mj_rne(model, data, 1, out)
            torque[row] = out @ D
        return torque

    ours = arm.effort(arm.states(motion), "drive").b
    assert np.abs(plain() - ours).max() < 1e-8 * np.abs(ours).max()
    loop = best_of(1, plain) * samples / looped
    fresh = best_of(2, lambda: eq.analyze(replace(arm, _batches={}), sweep))
    line("analyze a 3-RRR cycle, 10 000 samples", "MuJoCo instant by instant (scaled)", loop, fresh)
    told = best_of(2, lambda: eq.analyze(replace(arm, _batches={}), sweep).machine)
    line("the same with motors and 9 bearings", "MuJoCo instant by instant (scaled)", loop, told, "baseline as above")


def survey() -> None:
    """1,300 made-up springs on one joint with four coordinates free, against SLSQP row by row on every 40th of them.

    By processor time of all processes: by the clock two processes take half of it on two free cores, and their start.
    """
    from pathlib import Path

    from survey_by_scipy import BOUNDS, Arm, one_by_one

    stock = eq.read_catalogue(Path(__file__).parents[1] / "examples" / "stock_springs.csv")
    plain, every, starts = Arm(), 40, 6
    arm = eq.chain([eq.Link("arm", length=plain.length, mass=plain.mass)])
    over = eq.Sweep.grid(arm, {"arm_joint": (plain.low, plain.high, plain.poses)})
    spring = eq.Spring("s1", eq.Line(arm.at("world", 0, 0, 0.3), arm.at("arm", 0.2)), eq.ZeroFreeLength())
    names = [f"s1.path.line.{end}.{axis}" for end in (0, 1) for axis in "xz"]
    start, clock = _processor(), time.perf_counter()
    found = eq.survey_catalogue(arm, [spring], over, dict(zip(names, BOUNDS, strict=True)), stock, workers=2)
    ours, clock = _processor() - start, time.perf_counter() - clock
    some = np.arange(0, len(stock), every)
    columns = (stock.rate, stock.free_length, stock.initial_tension, stock.free_length + stock.travel, stock.mass)
    start = _processor()
    theirs = one_by_one(plain, np.stack(columns, axis=1)[some], starts=starts, seed=0)
    loop = (_processor() - start) * every
    by_part = {line.part: line.rms if not line.refused else np.inf for line in found.lines}
    mine = np.array([by_part[stock.part[row]] for row in some])
    both = np.isfinite(mine) & np.isfinite(theirs)
    ratio = mine[both] / theirs[both]
    kept, refused = ((np.isfinite(one) & ~both).sum() for one in (mine, theirs))
    note = (
        f"{(ratio <= 1.001).sum()} of {len(ratio)} rows equal or better to 0.1 %, "
        f"worst {100 * (ratio.max() - 1):+.2f} %, best {100 * (ratio.min() - 1):+.2f} %; "
        f"kept {kept} that it refused, refused {refused} it kept; {clock:.1f} s by the clock"
    )
    told = f"SLSQP, {starts} starts, every {every}th (scaled)"
    line(f"survey, {len(stock)} springs, 4 coordinates", told, loop, ours, note)


def dictionary(sampled: int = 200) -> None:
    """Dictionary and search of `discover` on a UR10, against bounded least squares pair by pair over all states.

    The best pair of an exhaustive search over all states, uncompressed, stands beside the one that is found.
    """
    from scipy.optimize import lsq_linear

    from equipoise.discovery.collect import collect
    from equipoise.discovery.kinds import Coils, Ideal
    from equipoise.discovery.subsets import Search

    arm = eq.Mechanism.load(UR10)
    over, aim = eq.Sweep.sobol(arm, 1024), Aim(norm="peak")
    asked = {
        "ideal springs": eq.Discover(kinds=(Ideal(),), candidates=4800),
        "coils": eq.Discover(kinds=(Coils(rest=0.95, force=5e3),), candidates=12_000),
        "coils to be wound": eq.Discover(kinds=(Coils(rest=1.0, force=5e3),), make=eq.Makeable(), candidates=3000),
    }
    for name, request in asked.items():
        start = _processor()
        words = collect(arm, over, request, aim).dictionary
        search = Search.of(words.compressed, words.spots)
        found = search.best(3, keep=40)
        ours = _processor() - start
        root = np.sqrt(words.weight)
        A, b = words.columns(tuple(range(len(words)))) * root[:, None], words.loads[0] * root
        _, pair = _every_pair(A, b, words.spots)
        mine = [lsq_linear(A[:, which], -b, (0.0, 1.0)).cost * 2 for which in (list(found[2][0][1]), list(pair))]
        rng = np.random.default_rng(0)
        start = _processor()
        for _ in range(sampled):
            lsq_linear(A[:, rng.choice(len(words), 2, replace=False)], -b, (0.0, 1.0))
        pairs = len(words) * (len(words) - 1) / 2
        loop = (_processor() - start) * pairs / sampled
        note = f"pairs, and triples by beam; rms {mine[0] ** 0.5:.6g} against {mine[1] ** 0.5:.6g} exhaustively"
        told = f"lsq_linear, {sampled} of {pairs / 1e6:.1f} M pairs"
        line(f"discover: {len(words)} {name}, {len(over.poses)} poses", told, loop, ours, note)


def _every_pair(A: np.ndarray, b: np.ndarray, spots: np.ndarray) -> tuple[float, tuple[int, int]]:
    """The best pair of all, 0 <= k <= 1, by the Gram matrix of all columns: inside the box and on its four edges."""
    gram, side = A.T @ A, A.T @ b
    square, best = np.diag(gram), (np.inf, (0, 0))
    for one in range(len(side) - 1):
        two = np.arange(one + 1, len(side))
        cross = gram[one, two]
        minor = np.maximum(square[one] * square[two] - cross**2, 1e-300)
        x, y = (
            (cross * side[two] - square[two] * side[one]) / minor,
            (cross * side[one] - square[one] * side[two]) / minor,
        )
        inside = (x >= 0) & (x <= 1) & (y >= 0) & (y <= 1)
        tried = [(np.where(inside, x, 0.0), np.where(inside, y, 0.0))]
        for end in (0.0, 1.0):
            tried.append((np.full(len(two), end), np.clip(-(side[two] + end * cross) / square[two], 0, 1)))
            tried.append((np.clip(-(side[one] + end * cross) / square[one], 0, 1), np.full(len(two), end)))
        for x, y in tried:
            value = 2 * (x * side[one] + y * side[two]) + x * x * square[one] + y * y * square[two] + 2 * x * y * cross
            value[spots[two] == spots[one]] = np.inf
            least = int(value.argmin())
            if value[least] < best[0]:
                best = float(value[least]), (one, int(two[least]))
    return best


def _processor() -> float:
    """Seconds of processor time of this process and of those it has started and seen end."""
    return sum(os.times()[:4])


if __name__ == "__main__":
    print(f"{'what':<44}{'baseline':<34}{'baseline':>12}{'equipoise':>12}{'ratio':>11}")
    kinematics()
    balance()
    shape()
    cables()
    shaking()
    cycle()
    survey()
    dictionary()

"""The parts of the HTML page that are mostly words: headline figures, certificate, question, limits, literature."""

from __future__ import annotations

import json
import math

from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.reporting import limitwords, phrases
from equipoise.reporting.jsonfile import strict
from equipoise.reporting.markup import Raw, element, join, listing, prose, section, table
from equipoise.reporting.numbers import plain, seen, shown, sig
from equipoise.reporting.references import reference
from equipoise.reporting.tables import value_words

FIXED = "\u00a0"
"""A space that does not break: a number stays with its unit."""

HONEST = (
    "Links are rigid; the answer is quasi-static: every pose is held still, nothing accelerates.",
    "Friction and hysteresis come on top of the residual shown; they are not designed away.",
    "A robot file is only as good as its masses: weigh the heaviest link before buying springs.",
)
OF_SPRINGS = (
    "A heavy spring's own mass is lumped at its two ends, which is exact for a spring of zero free length.",
    "Unless a limit `avoid` says so, nothing checks that a spring clears the links: look at the drawing, then at the "
    "assembly.",
)

MOVING = "Links are rigid and joints have no play: the motion is followed exactly, elastic vibration comes on top."


def tiles(design: Design) -> Raw:
    """Four numbers to take away."""
    joint = phrases.main_joint(design)
    before, after = design.before[joint], design.after[joint]
    norm = design.norm
    was, left = seen(getattr(before, norm)), seen(getattr(after, norm))
    change = f"{sig(was, 3)} → {sig(left, 2 if left < 1e-9 * was else 3)} {after.unit}"
    what = (
        f"of the {joint}" if joint not in design.mechanism.driven else f"{phrases.supplied(design)} effort at {joint}"
    )
    boxes = [(change, f"{norm} {what}", "")]
    c = design.certificate
    sure = "nothing left, also off the sweep" if c.kind == "exact" else f"gap {value_words(c.gap, c.unit, 2)}"
    boxes += [(c.kind, f"certificate: {sure}", ""), *_checked(design, joint)]
    made = [
        element("div", element("b", big.replace(" ", FIXED)), element("span", words), class_=f"tile{bad}")
        for big, words, bad in boxes
    ]
    return element("div", *made, class_="tiles")


def _checked(design: Design, joint: str) -> list[tuple[str, str, str]]:
    found = design.verification
    if found is None:
        return [("not verified", "no simulation has confirmed this yet", " bad")]
    verdict = "agrees" if found.agrees else "disagrees"
    poses = f"{found.poses:,}".replace(",", FIXED)
    bad = "" if found.agrees else " bad"
    if found.motion is None:
        words = f"largest difference from {found.engine} at {poses} unseen poses: it {verdict}"
        boxes = [(f"{sig(found.max_abs_error, 2)} {found.unit}", words, bad)]
    else:
        worst = max(error.relative for error in found.motion.errors.values())
        words = f"largest difference from {found.engine}'s inverse dynamics over the motion: it {verdict}"
        boxes = [(f"{sig(worst, 2)} of the load", words, bad)]
    bound = found.bounds.get(joint)
    if bound is not None and math.isfinite(bound.upper):
        kind = "no pose between the samples exceeds it" if bound.rigorous else "estimated maximum between the samples"
        kind = "largest met between the samples, no bound" if bound.vague else kind
        boxes.append((f"{sig(bound.polished if bound.vague else bound.upper)} {bound.unit}", f"{kind} ({joint})", ""))
    return boxes


def certificate(design: Design) -> Raw:
    """How good the answer is, what holds it where it is, and what to try."""
    c = design.certificate
    value, unit = shown(c.primal, c.unit)
    here = " at this geometry" if design.geometry and c.kind != "bracketed" else ""
    rows = [
        [f"reached ({limitwords.goal_word(design)})", f"{sig(value, 6)} {unit}"],
        [f"nothing below this is possible{here}", value_words(c.dual, c.unit, 6)],
        ["gap", value_words(c.gap, c.unit, 2)],
        ["largest violation of a limit, relative", sig(c.violation, 2)],
    ]
    if design.geometry:
        rows += [
            ["starts", str(c.starts)],
            ["different optima", str(c.optima)],
            ["their values lie apart by", value_words(c.spread, c.unit, 3)],
        ]
    held = limitwords.limited_by(design)
    steps = phrases.next_steps(design)
    return section(
        "How good it is",
        table(["certificate", ""], rows, numbers=1, kind="facts"),
        element("p", f"Free: {'; '.join(c.flat)}.") if c.flat else "",
        join([element("h3", "Limited by"), listing(held)]) if held else "",
        element("p", f"Missed: {design.missed}.", class_="warning") if design.missed else "",
        join([element("h3", "To try next"), listing(map(prose, steps))]) if steps else "",
        lead=phrases.KINDS[c.kind],
    )


def basis(design: Design) -> Raw:
    """What was swept, from which file, with which seed, and what the mass audit says."""
    mechanism = design.mechanism
    gravity = ", ".join(plain(value) for value in mechanism.gravity)
    rows = [
        ["mechanism", f"{mechanism.name}, {plain(mechanism.mass)} kg, driven: {', '.join(mechanism.driven)}"],
        ["gravity", f"({gravity}) m/s²"],
        ["sweep", design.sweep.describe()],
        ["made small", phrases.objective_words(design)],
    ]
    rows += [["poses added between the samples", str(design.refined)]] if design.refined else []
    rows += [["seed of the search", str(design.seed)]] if design.geometry else []
    remarks = mechanism.remarks or (phrases.SOUND,)
    problem = element(
        "details",
        element("summary", "The problem as it was posed"),
        element("pre", json.dumps(strict(design.problem), indent=2, ensure_ascii=False)),
    )
    return section(
        "What was asked",
        table(["", ""], rows, numbers=2),
        element("h3", "Mass audit"),
        listing(remarks),
        problem if design.problem else "",
    )


def files(design: Design, model: str) -> Raw:
    """What lies beside the page and how to open it."""
    names = ", ".join(balancer.name for balancer in design.balancers)
    opened = [
        element("code", model),
        f": the mechanism with its parts ({names}) for MuJoCo; springs are tendons, counterweights bodies. ",
        "Open it with ",
        element("code", f"python -m mujoco.viewer --mjcf={model}"),
        " (needs the package mujoco), or drop it into MuJoCo's simulate.",
    ]
    table = ": each pose with the effort before and after; it can be read back as a sweep of poses."
    return section(
        "Files beside this page",
        listing(
            [
                join(opened),
                join([element("code", "design.json"), ": every number on this page, in SI units."]),
                join([element("code", "residuals.csv"), table]),
            ]
        ),
    )


def honest_limits(design: Design) -> Raw:
    """What the numbers leave out."""
    first = HONEST[0] if design.sweep.moves is None else MOVING
    springs = OF_SPRINGS if any(isinstance(balancer, Spring) for balancer in design.balancers) else ()
    return section("What this does not cover", listing(map(prose, [first, *HONEST[1:], *springs])))


def literature(design: Design) -> Raw:
    """Whom to cite, in full."""
    return section("What to cite", listing([reference(key) for key in design.cite()]))

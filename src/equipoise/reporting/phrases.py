"""Sentences that both the terminal and the HTML page say: results, certificates, next steps."""

from __future__ import annotations

from math import isfinite

from equipoise.design import Design
from equipoise.objective import joint_goal
from equipoise.reporting.limitwords import is_natural, is_the_purpose, limit_words
from equipoise.reporting.numbers import (
    effort_word,
    plain,
    seen,
    shown,
    sig,
    sort_out,
)
from equipoise.reporting.rehearsal import motion_words

SOUND = "nothing to remark: masses and inertias are possible"
"""What the mass audit says of a sound file."""

KINDS = {
    "exact": "Exact: nothing is left at any pose, also at poses outside the sweep, to rounding.",
    "convex": "Convex: for this geometry no other values do better; the gap between what was found and what is "
    "provably impossible to beat is recomputed from the problem's data.",
    "bracketed": "Bracketed: the best value over all geometries lies between the two bounds.",
    "local": "Local: at this geometry the values are proven best; no small change of the geometry improves it, but a "
    "better geometry elsewhere cannot be ruled out.",
}


def headline(design: Design) -> str:
    """Robot, joints, mass and what was swept, in one line."""
    mechanism = design.mechanism
    count = len(mechanism.driven)
    found = f"; {design.refined} more pose{'s' * (design.refined != 1)} found between them" if design.refined else ""
    return (
        f"{mechanism.name or 'mechanism'}, {count} driven joint{'s' * (count != 1)}, {plain(mechanism.mass)} kg; "
        f"{design.sweep.describe()}{found}"
    )


def result(design: Design) -> str:
    """The number that matters: the most loaded counted joint in the norm that was made small."""
    joint = main_joint(design)
    norm = design.norm
    before, after = design.before[joint], design.after[joint]
    was, left = getattr(before, norm), getattr(after, norm)
    what = {"peak": "The peak", "rms": "The rms", "mean": "The mean"}[norm]
    if joint not in design.mechanism.driven:
        bare = f"it is {sig(was)}" if seen(was) else "nothing pulls"
        return f"{what} of the {joint} is {sig(left)} {after.unit}; without the added parts {bare}."
    start = f"{what} {supplied(design)} {effort_word(before.unit)} at {joint}"
    if left <= 1e-9 * was:
        return f"{start} vanishes: {sig(was)} {before.unit} before, {sig(left)} {after.unit} (rounding) after."
    change = f"falls from {sig(was)} to {sig(left)} {after.unit}" if left < was else "does not fall"
    gives = "holds" if supplied(design) == "holding" else "gives"
    return f"{start} {change}, {plain(100 * left / was, 3)} % of what the motor {gives} without the added parts."


def supplied(design: Design) -> str:
    """What the rows of the joints are: `holding` efforts at rest, or what the `motor` supplies over a motion."""
    return "motor" if joint_goal(design.objective, design.states.rates is not None) == "drive" else "holding"


def main_joint(design: Design) -> str:
    """The counted joint that gains most, as a share of what it may supply or of the largest load."""
    counted = {row for aim in design.objective for row in aim.counted(design.mechanism)}
    norm = design.norm
    by_motor = any(aim.divisor for aim in design.objective)

    def gain(joint: str) -> float:
        before, after = design.before[joint], design.after[joint]
        size = before.limit if by_motor and before.limit else 1.0
        return (getattr(before, norm) - getattr(after, norm)) / size

    # where only mass counts, what the limits keep small is what there is to show
    shown_rows = [row for row in design.before if row in counted] or [
        row for row in design.before if row not in design.mechanism.driven
    ]
    return max(shown_rows or design.before, key=gain)


SHARES = {"motor": ", each as a share of its motor limit", "before": " as a share of its value before"}


def objective_words(design: Design) -> str:
    """`the peak over all driven joints`, with weights, caps and divisors where there are any."""
    words = []
    for aim in design.objective:
        if aim.goal in ("hold", "drive"):
            what = f"the {aim.norm} over {', '.join(aim.joints) if aim.joints else 'all driven joints'}"
        else:
            what = "the added mass" if aim.goal == "mass" else f"the {aim.norm} of the {aim.goal}"
            what = what.replace("wrench", "resultant on the platform")
        what += SHARES.get(aim.divisor or "", "")
        number, unit = shown(aim.cap or 0.0, aim.unit(design.mechanism))
        weight = "" if aim.weight == 1 else f"{plain(aim.weight)} x "
        words.append(f"{what}, kept below {plain(number)} {unit}" if aim.cap is not None else f"{weight}{what}")
    return "; ".join(words)


def certificate_words(design: Design) -> str:
    """Kind, gap and what is known of the geometry, in one line."""
    c = design.certificate
    value, unit = shown(c.primal, c.unit)
    share = f" ({sig(c.gap / c.primal, 1)} of the value)" if c.primal > 0 else ""
    if c.kind == "bracketed":
        words = (
            f"bracketed: no geometry within the bounds leaves less than {sig(shown(c.dual, c.unit)[0])} {unit}, "
            f"{sig(100 * c.gap / c.primal, 2) if c.primal > 0 else '0'} % below this one; {c.boxes} boxes"
        )
    elif c.kind == "exact":
        words = f"exact: {sig(value, 2)} {unit} left, also at poses outside the sweep"
    else:
        words = f"convex, gap {sig(shown(c.gap, c.unit)[0], 2)} {unit}{share}"
    if design.geometry and c.kind == "exact":
        words += f"; geometry found from {c.starts} start{'s' * (c.starts != 1)}, none does better"
    elif design.geometry:
        optima = "1 optimum" if c.optima == 1 else f"{c.optima} different optima"
        apart = f", values up to {sig(shown(c.spread, c.unit)[0], 3)} {unit} apart" if c.optima > 1 else ""
        words += f"; geometry: local, {c.starts} start{'s' * (c.starts != 1)}, {optima}{apart}"
    rule = [f"quadrature good to {sig(c.quadrature, 1)} of the value"] if c.quadrature is not None else []
    return "; ".join([words, *rule, *c.flat])


def next_steps(design: Design) -> list[str]:
    """At most two things worth trying, the most promising first."""
    c = design.certificate
    steps = []
    if design.missed:
        steps.append("relax the target, free more geometry, or add a part")
    if own := [floor.row for floor in c.floors if floor.cause == "own"]:
        acting = " and ".join(own)
        steps.append(f"add a spring with {acting} between its ends: the rest cannot fall before that does")
    bounds = [active.limit for active in c.active if active.limit.split(" ")[0] in design.geometry]
    if bounds:
        steps.append(f"widen the bound {limit_words(bounds[0])} if there is room")
    elif dear := [active for active in c.active if not (is_natural(active) or is_the_purpose(active))]:
        steps.append(f"relax {limit_words(dear[0].limit)}: it costs most")
    if not design.geometry and c.kind == "convex" and not c.floors:
        steps.append("free the attachment points (`shape` in the problem file)")
    if c.kind == "local" and c.optima > 1:
        steps.append("use more starts: the search found several optima")
    if not steps and design.verification is None:
        steps.append("verify in simulation and write the report")
    return steps[:2]


def verified_words(design: Design) -> str:
    """Engine, poses, agreement and the bound between the samples; what is missing where nothing was verified."""
    found = design.verification
    if found is None:
        return "not yet: `equipoise verify` simulates the design at poses it never saw"
    error = sig(found.max_abs_error, 2)
    verdict = f"agrees to {error} {found.unit}" if found.agrees else f"DISAGREES by {error} {found.unit}"
    if found.agrees and not any(one.load for one in found.errors.values()):
        verdict = "nothing to hold at rest, and it agrees"
    poses = f"{found.poses:,}".replace(",", " ")
    words = f"{found.engine}, {poses} unseen poses, saved file reloaded: {verdict}"
    moved = motion_words(found.motion) if found.motion else []
    return "; ".join([words, *filter(None, [between_words(design, main_joint(design))]), *moved])


def between_words(design: Design, joint: str) -> str:
    """`between the samples at most 34.3 N m at elbow_joint`, or nothing where no bound is known."""
    bound = design.verification.bounds.get(joint) if design.verification else None
    if bound is None or not isfinite(bound.upper):
        return ""
    if bound.vague:
        return f"between the samples {sig(bound.polished)} {bound.unit} was met at {joint}, which is no bound"
    sure = "at most" if bound.rigorous else "estimated at most"
    return f"between the samples {sure} {sig(bound.upper)} {bound.unit} at {joint}"


def unloaded_words(design: Design) -> str:
    """The joints that the table leaves out, in one sentence, or nothing."""
    _, minor, none = sort_out(design.before, design.after)
    small = [f"{name} ({sig(max(design.before[name].peak, design.after[name].peak), 3)} {design.before[name].unit})"
             for name in minor]  # fmt: skip
    words = [f"under 1 % of the largest load: {', '.join(small)}"] if small else []
    return "; ".join(words + ([f"no load: {', '.join(none)}"] if none else []))

"""Motors and bearings over a motion in words and tables, before and after."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from equipoise.reporting.markup import Raw, element, join, section, small, table
from equipoise.reporting.numbers import plain, sig

if TYPE_CHECKING:
    from equipoise.machinery import Drive, Machine, Supply

NOTHING = 1e-9
WHEN = ("before", "after")
NOTE = (
    "The rms by cause: inertial is what acceleration and speed ask for; gravity, weights; springs, those of the file "
    "and the added ones. Work is the positive work over the motion, nothing regenerated; net is what is left where "
    "braking energy is taken back without loss. All on one supply: braking motors feed the others."
)
BEARINGS = (
    "The force in each bearing and pin by itself, weight and springs included, through the closed loops. Teeth "
    "push on the bearing of the body that drives a counter-rotor beside it; belts, and pairs of gears on one carrier, "
    "count as pure torques. "
)


def motor_words(machines: Sequence[Machine]) -> list[tuple[str, str]]:
    """`motor crank_joint`: peak, rms with its parts, work with and without regeneration; one line per motor and all."""
    lines = []
    for joint in machines[0].drives:
        drives = [machine.drives[joint] for machine in machines]
        unit = drives[0].effort.unit
        peak, rms = (_change([getattr(drive.effort, norm) for drive in drives]) for norm in ("peak", "rms"))
        words = [f"peak {peak}, rms {rms} {unit}"]
        if parts := _parts(drives):
            shares = "; ".join(f"{part} {_change([d.parts[part].rms for d in drives])}" for part in parts)
            words.append(f"rms by cause: {shares}")
        words += _work([drive.work for drive in drives])
        words += [friction_words(drives[-1])] if drives[-1].rubbed else []
        lines.append((f"motor {joint}", "; ".join(words)))
    if len(machines[0].drives) > 1:
        lines += [("all motors", words) for words in _work([machine.supply for machine in machines])]
    return lines


def friction_words(drive: Drive) -> str:
    """What friction adds to a motor and what it takes; nothing where nothing rubs."""
    found, unit = drive.rubbed, drive.effort.unit
    if found is None:
        return ""
    words = f"friction beside it up to {sig(found.peak, 3)}, rms {sig(found.rms, 3)} {unit}"
    words += f", with it peak {sig(found.effort_peak)}, rms {sig(found.effort_rms)} {unit}"
    if found.lost is not None and found.work is not None:
        words += f"; it takes {sig(found.lost, 3)} J, work {sig(found.work.positive)} J"
    return words


def bearing_words(machines: Sequence[Machine]) -> list[tuple[str, str]]:
    """`bearing crank_joint`: the bodies it joins, peak and rms of its force; then what rigid links leave open."""
    lines = []
    for bearing in machines[0].bearings:
        rows = [machine.forces[bearing.name] for machine in machines]
        force = f"peak {_change([row.peak for row in rows])}, rms {_change([row.rms for row in rows])} N"
        lines.append((f"bearing {bearing.name}", f"{bearing.between[0]} to {bearing.between[1]}: {force}"))
    return lines + [("open", words) for words in open_words(machines[0])]


def open_words(machine: Machine) -> list[str]:
    """Where the force of redundantly constrained bearings is not determined by rigid links."""
    groups: dict[tuple[tuple[float, ...], ...], list[str]] = {}
    for bearing in machine.bearings:
        if bearing.indeterminate:
            groups.setdefault(bearing.indeterminate, []).append(bearing.name)
    said = []
    for axes, names in groups.items():
        along = " and ".join("(" + ", ".join(plain(value + 0.0, 3) for value in axis) + ")" for axis in axes)
        which = "all bearings" if len(names) == len(machine.bearings) else ", ".join(names)
        said.append(f"{which}: rigid links leave the force along {along} open; the least one is told")
    return said


def motors(machines: Sequence[Machine]) -> Raw:
    """The table of motors and that of bearings."""
    rows = []
    for joint in machines[0].drives:
        for when, machine in zip(WHEN, machines, strict=True):
            drive = machine.drives[joint]
            parts = [sig(drive.parts[part].rms) for part in ("inertial", "gravity", "springs")]
            name = join([joint, small(drive.effort.unit)]) if when == WHEN[0] else ""
            effort = [sig(drive.effort.peak), sig(drive.effort.rms), *parts]
            rows.append([name, when, *effort, *_supply(drive.work), sig(drive.power)])
    if len(machines[0].drives) > 1 and machines[0].supply is not None:
        for when, machine in zip(WHEN, machines, strict=True):
            name = "all, one supply" if when == WHEN[0] else ""
            rows.append([name, when, "", "", "", "", "", *_supply(machine.supply), ""])
    head = ["peak", "rms", "inertial", "gravity", "springs", "work [J]", "net [J]", "power [W]"]
    made = table(["motor", "", *head], rows, numbers=2)
    held = [
        [join([bearing.name, small(" to ".join(bearing.between))])]
        + [sig(value) for m in machines for value in (m.forces[bearing.name].peak, m.forces[bearing.name].rms)]
        for bearing in machines[0].bearings
    ]
    carried = table(["bearing", *["peak [N]", "rms [N]"] * len(machines)], held, numbers=1, groups=_groups(2))
    opened = " ".join(f"{words[0].upper()}{words[1:]}." for words in open_words(machines[0]))
    return section(
        "Motors and bearings over the motion",
        made,
        element("p", NOTE, class_="note"),
        *([element("p", f"{told}.")] if (told := _friction(machines)) else []),
        carried,
        element("p", BEARINGS, opened, class_="note"),
    )


def _friction(machines: Sequence[Machine]) -> str:
    """A sentence on the friction of each motor with the parts."""
    drives = machines[-1].drives
    return "; ".join(f"{joint}: {friction_words(drive)}" for joint, drive in drives.items() if drive.rubbed)


def _groups(width: int) -> str:
    sides = "".join(f'<th class="group {side}" colspan="{width}">{side}</th>' for side in WHEN)
    return f"<tr><th></th>{sides}</tr>"


def _supply(supply: Supply | None) -> list[str]:
    if supply is None:
        return ["", ""]
    return [sig(supply.positive), sig(_clear(supply.net, supply.positive + supply.braking))]


def _parts(drives: Sequence[Drive]) -> list[str]:
    """The parts that matter, where there is more than one."""
    largest = max(drive.effort.rms for drive in drives)
    found = [
        part
        for part in drives[0].parts
        if max(drive.parts[part].rms for drive in drives) > NOTHING * max(largest, 1e-300)
    ]
    return found if len(found) > 1 else []


def _work(supplies: Sequence[Supply | None]) -> list[str]:
    known = [supply for supply in supplies if supply is not None]
    if len(known) != len(supplies):
        return []
    scale = max(supply.positive + supply.braking for supply in known)
    positive, net = ([_clear(value, scale) for value in values]
                     for values in ([s.positive for s in known], [s.net for s in known]))  # fmt: skip
    return [f"work {_change(positive)} J, with regeneration {_change(net)} J"]


def _clear(value: float, scale: float) -> float:
    """Rounding beside what flows to and fro reads as nothing."""
    return 0.0 if abs(value) < 1e-5 * scale else value


def _change(values: Sequence[float]) -> str:
    return " -> ".join(sig(value) for value in values)

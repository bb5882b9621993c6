"""verify: the design in MuJoCo at poses it never saw, its energies, and the poses between the samples."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from equipoise.design import Design
from equipoise.errors import DisagreementError, InputError
from equipoise.verification.continuum import bounds
from equipoise.verification.energy import energy_errors
from equipoise.verification.findings import Bound, MotionCheck, Verification
from equipoise.verification.motion import check_motion
from equipoise.verification.saved import save
from equipoise.verification.simulate import ENGINE, compare

POSES = 10_000
SEED = 20_259
TOLERANCE = 1e-9
ENERGY_TOLERANCE = 1e-6


def verify(
    design: Design,
    *,
    out: Path | str | None = None,
    poses: int = POSES,
    seed: int = SEED,
    model: Path | str | None = None,
) -> Design:
    """The design with its verification: saved as MJCF, reloaded, and judged by MuJoCo.

    out is the folder that `<mechanism>_balanced.xml` is written to (default: a temporary one); model judges
    a file that is already there instead. poses random poses, from seed, times all payload scenarios. The
    verification `agrees` where every joint's effort matches within 1e-9 of max(load, 1) and every element's
    effort is the derivative of its energy within 1e-6. Over a motion in time MuJoCo also goes through it with every
    part as a body: inverse dynamics within 1e-8, a simulation whose difference falls with the time step, and a base
    that floats (`verification.motion`). Raises ModelError where MuJoCo refuses the file,
    InputError where it cannot be read or written.
    """
    if poses < 1:
        raise InputError(f"{poses} poses cannot verify anything", where="verify", hint="use at least one")
    if model is not None:
        return _judged(design, Path(model), Path(model), poses, seed)
    if out is not None:
        path = save(design, Path(out))
        return _judged(design, path, path, poses, seed)
    with tempfile.TemporaryDirectory() as folder:
        return _judged(design, save(design, Path(folder)), None, poses, seed)


def _judged(design: Design, path: Path, kept: Path | None, poses: int, seed: int) -> Design:
    comparison = compare(design, path, poses, seed)
    between = bounds(design.mechanism, design.balancers, design.values, design.sweep, design.after)
    motion = None if design.sweep.moves is None else check_motion(design, path)
    verification = Verification(
        engine=ENGINE,
        poses=len(comparison.states) // len(design.sweep.scenarios),
        seed=seed,
        where=comparison.where,
        scenarios=len(design.sweep.scenarios),
        errors=comparison.errors(),
        worst=comparison.worst(),
        tolerance=TOLERANCE,
        energy=energy_errors(design, seed=seed),
        energy_tolerance=ENERGY_TOLERANCE,
        bounds=between,
        model=kept,
        notes=(*comparison.notes, *_missed(design, between), *((motion,) if isinstance(motion, str) else ())),
        motion=motion if isinstance(motion, MotionCheck) else None,
    )
    return replace(design, verification=verification)


def _missed(design: Design, between: Mapping[str, Bound]) -> tuple[str, ...]:
    """Peaks that the search between the samples met above the polished ones."""
    rows = design.after
    return tuple(
        f"{joint}: {bound.polished:.6g} {bound.unit} was met between the samples, above the peak {rows[joint].peak:.6g}"
        for joint, bound in between.items()
        if bound.polished > rows[joint].peak * (1 + 1e-6) + 1e-9 * rows[joint].rms
    )


def insist(design: Design) -> None:
    """Raise DisagreementError where a verified design does not agree, naming joint, pose and both values."""
    found = design.verification
    if found is None or found.agrees:
        return
    where = f"{design.mechanism.name}, {found.engine}"
    for joint, error in found.errors.items():
        if not found.within(error):
            raise DisagreementError(
                f"the saved model differs by {error.error:.3g} {error.unit} at {joint}; largest at {found.worst}",
                where=where,
                hint="look at the saved model's sites, tendons and masses; if they are right, please report this",
            )
    if found.motion is not None and found.motion.faults:
        raise DisagreementError(found.motion.faults[0], where=where, hint="please report this design")
    name, error = max(found.energy.items(), key=lambda item: item[1])
    raise DisagreementError(
        f"the effort of {name} is not the derivative of its energy: relative difference {error:.3g}",
        where=where,
        hint="please report this design",
    )

"""report: one HTML file, the design as data, the residuals and the model, all written together or not at all."""

from __future__ import annotations

import csv
import os
import shutil
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from equipoise.design import Design
from equipoise.errors import InputError


def report(design: Design, out: Path | str) -> Path:
    """Write report.html, design.json, residuals.csv and `<mechanism>_balanced.xml` to a folder; returns the HTML file.

    Cams and drums that the design has `made` add a DXF and a CSV file each.

    A design without a verification is verified first; one that disagrees is reported as such. One without a tolerance
    gets that of the default scatter, one
    without a dead band that of the default friction. Files are made in
    a folder of their own and moved in place when all are there. Raises InputError where `out` cannot be written.
    """
    from equipoise.cables.behaviour import behaviour
    from equipoise.reporting.html import page
    from equipoise.reporting.jsonfile import dumps
    from equipoise.rubbing import dead_band, held
    from equipoise.scattering import followed, tolerance
    from equipoise.verbs.verify import verify
    from equipoise.verification.saved import save

    target = Path(out)
    fresh = not target.exists()
    try:
        target.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".report-", dir=target) as folder:
            stage = Path(folder)
            if design.verification is None:
                design = verify(design)
            if design.tolerance is None and followed(design):
                design = replace(design, tolerance=tolerance(design))
            if design.dead_band is None and held(design):
                design = replace(design, dead_band=dead_band(design))
            platform = design.mechanism.platform
            if design.cables is None and platform is not None and platform.cables:
                design = replace(design, cables=behaviour(design))
            model = save(design, stage)
            design = _naming(design, target / model.name)
            (stage / "report.html").write_text(page(design, model.name), encoding="utf-8")
            (stage / "design.json").write_text(dumps(design.json()), encoding="utf-8")
            _write_residuals(design, stage / "residuals.csv")
            for part in design.made:
                part.write(stage)
            _move(stage, target)
    except OSError as error:
        raise InputError(
            f"cannot write the report: {error.strerror or error}", where=str(target), hint="choose another --out"
        ) from None
    finally:
        if fresh and target.is_dir() and not any(target.iterdir()):
            target.rmdir()
    return target / "report.html"


def _naming(design: Design, model: Path) -> Design:
    """The design with its verification naming the saved model, where it judged only a temporary copy of it."""
    found = design.verification
    if found is None or found.model is not None:
        return design
    return replace(design, verification=replace(found, model=model))


def _move(stage: Path, target: Path) -> None:
    """Move everything in place, the HTML file last: where it is there, all is there."""
    for item in sorted(stage.iterdir(), key=lambda path: path.name == "report.html"):
        place = target / item.name
        if place.is_dir():
            shutil.rmtree(place)
        os.replace(item, place)


def _write_residuals(design: Design, path: Path) -> None:
    """A row per pose or instant and payload: joint positions, weight, payload masses, effort before and after.

    Over a motion time comes first, efforts are what motors supply, and the base's force and moment stand beside them.
    """
    mechanism, states, instants = design.mechanism, design.states, design.sweep.instants
    units = mechanism.driven_units
    head = [f"{joint} [{'m' if unit == 'N' else 'rad'}]" for joint, unit in zip(mechanism.driven, units, strict=True)]
    head += ["weight", *(f"payload {point.body} [kg]" for point in states.payload_points)]
    columns = [states.driven, states.weight[:, None], states.payload_mass]
    if instants is not None:
        head = ["time [s]", *head]
        columns = [np.tile(instants.time, len(design.sweep.scenarios))[:, None], *columns]
    for word, bare in (("before", True), ("after", False)):
        if instants is None:
            rows = dict(zip(mechanism.driven, (states.holding if bare else design.residual(states)).T, strict=True))
        else:
            rows = design.account(states, bare=bare)
        for name, values in rows.items():
            parts = [""] if values.ndim == 1 or values.shape[1] == 1 else [" x", " y", " z"]
            head += [f"{word} {name}{part} [{design.before[name].unit}]" for part in parts]
            columns.append(values.reshape(len(states), -1))
    with path.open("w", newline="", encoding="utf-8") as stream:
        csv.writer(stream).writerow(head)
        np.savetxt(stream, np.hstack(columns), fmt="%.12g", delimiter=",")

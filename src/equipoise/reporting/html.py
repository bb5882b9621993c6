"""One HTML file that holds everything: no network, no scripts, pictures inside."""

from __future__ import annotations

from importlib.resources import files

from equipoise import __version__
from equipoise.balancers.counter_rotor import CounterRotor
from equipoise.balancers.counterweight import Counterweight
from equipoise.balancers.flywheel import Flywheel
from equipoise.balancers.spring import Spring
from equipoise.design import Design
from equipoise.make.synthesis import Part
from equipoise.reporting import cable_sections, machinery, phrases, sections, tables
from equipoise.reporting.alternatives import alternatives
from equipoise.reporting.friction import friction_section
from equipoise.reporting.markup import Raw, element, image, join, section
from equipoise.reporting.ordering import ordering, tried
from equipoise.reporting.payload import adjustments
from equipoise.reporting.plots import Picture, part_picture, pictures
from equipoise.reporting.settings import settings_table
from equipoise.reporting.tolerance import tolerance_section


def page(design: Design, model: str) -> str:
    """The report as HTML text; model is the name of the MJCF file that lies beside it."""
    drawn = pictures(design)
    body = join(
        [
            _header(design),
            sections.tiles(design),
            *[_picture(one) for one in drawn[:1]],
            tables.before_after(design),
            *[_picture(one) for one in drawn[1:]],
            cable_sections.platform(design),
            *[_made(part) for part in design.made],
            *([machinery.motors(design.machine)] if design.machine else []),
            tables.parts(design),
            ordering(design),
            tried(design),
            alternatives([design]),
            settings_table(design) or adjustments(design),
            sections.certificate(design),
            tables.verification(design),
            tolerance_section(design),
            friction_section(design),
            sections.basis(design),
            sections.honest_limits(design),
            sections.files(design, model),
            sections.literature(design),
            element("footer", f"Made by equipoise {__version__}. {_meaning(design)}"),
        ],
        "\n",
    )
    return document(f"{design.mechanism.name} balanced", body)


def document(title: str, body: Raw) -> str:
    """A whole page of its own: nothing is loaded from elsewhere."""
    style = Raw((files("equipoise") / "reporting" / "page.css").read_text(encoding="utf-8"))
    head = join(
        [
            Raw('<meta charset="utf-8">'),
            Raw('<meta name="viewport" content="width=device-width, initial-scale=1">'),
            element("title", title),
            Raw(f"<style>\n{style}</style>"),
        ],
        "\n",
    )
    whole = element("html", element("head", head), element("body", element("main", body)), lang="en")
    return f"<!doctype html>\n{whole}\n"


def _meaning(design: Design) -> str:
    still = phrases.supplied(design) == "holding"
    return f"Torques are what the motors must supply {'to hold still' if still else 'over the motion'}."


def _header(design: Design) -> Raw:
    kinds = (
        (Spring, "spring"),
        (Counterweight, "counterweight"),
        (CounterRotor, "counter-rotor"),
        (Flywheel, "flywheel"),
    )
    counts = [(sum(isinstance(balancer, kind) for balancer in design.balancers), word) for kind, word in kinds]
    added = " and ".join(f"{count} {word}{'s' * (count > 1)}" for count, word in counts if count)
    return element(
        "header",
        element("p", f"{'Static' if design.sweep.moves is None else 'Dynamic'} balance report", class_="kicker"),
        element("h1", f"{design.mechanism.name}, balanced with {added}"),
        element("p", phrases.result(design), class_="result"),
        element("p", phrases.headline(design), class_="sub-line"),
    )


def _made(part: Part) -> Raw:
    drawn = part_picture(part)
    return section(drawn.title, image(drawn.address, drawn.alternative, drawn.caption), cable_sections.made(part))


def _picture(picture: Picture) -> Raw:
    return section(picture.title, image(picture.address, picture.alternative, picture.caption))

"""The command line: one function per verb. Heavy libraries are imported when a command runs."""

from equipoise.cli import beside, checks, discovery, needs, real, records, solve
from equipoise.cli.core import app, main
from equipoise.console import guarded

__all__ = ["app", "main"]

# `equipoise --help` keeps this order.
for command in (
    needs.analyze,
    needs.conditions,
    needs.substitute,
    solve.balance,
    solve.shape,
    solve.design,
    real.pick,
    real.survey,
    discovery.discover,
    checks.verify,
    checks.make,
    checks.report,
    beside.front,
    beside.side_by_side,
    beside.compare,
    records.reproduce,
    records.schema,
):
    app.command()(guarded(command))

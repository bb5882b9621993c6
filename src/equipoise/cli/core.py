"""What all commands share: the application, and the arguments and options that several of them take."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(
    name="equipoise",
    help="Designs balanced mechanisms: which springs and counterweights, where, how big, and how good the answer is.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

File = Annotated[str, typer.Argument(metavar="FILE", help="Problem file (YAML), or a robot: URDF, MJCF, package://...")]
Made = Annotated[
    str, typer.Argument(metavar="FILE", help="design.json of an earlier run, or a problem file, which is solved first.")
]
Json = Annotated[bool, typer.Option("--json", help="Print machine output on stdout, and nothing else there.")]
Out = Annotated[Path | None, typer.Option("--out", help="Folder to write to.")]
Catalogue = Annotated[Path | None, typer.Option("--catalogue", help="CSV of springs; without it, what can be wound.")]
Units = Annotated[str | None, typer.Option("--units", help="Of columns that say none: metric or inch.")]
Columns = Annotated[
    list[str] | None, typer.Option("--column", help="What a column is: rate='Spring Rate'. Repeatable.")
]
Parallel = Annotated[int | None, typer.Option("--parallel", min=1, help="How many of a part may act side by side.")]
Seed = Annotated[int | None, typer.Option("--seed", min=0, help="Seed of the search; the same seed, the same design.")]
Starts = Annotated[int | None, typer.Option("--starts", min=1, help="Starts of the search.")]


@app.callback(invoke_without_command=True)
def _root(
    version: Annotated[bool, typer.Option("--version", help="Print the version.", is_eager=True)] = False,
) -> None:
    if version:
        from equipoise import __version__

        typer.echo(f"equipoise {__version__}")
        raise typer.Exit


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    try:
        app(args=None if arguments is None else list(arguments), prog_name="equipoise")
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 1 if end.code else 0
    return 0

"""`reliab run`: a study from its motions to the report."""

from pathlib import Path
from typing import Annotated

import typer

from reliab.cli.completion import studies
from reliab.cli.options import (
    JsonTarget,
    Laboratory,
    Logo,
    Motions,
    Paper,
    ReportDate,
    ReportTitle,
    Sets,
    given_options,
    setting_of,
)
from reliab.cli.output import console, progress_bar, table, write_json
from reliab.errors import InputError

_OUT = Path("reliab-run")
_DEFAULT = "quick"


def run(
    *,
    context: typer.Context,
    study: Annotated[
        str,
        typer.Argument(
            metavar="[STUDY]",
            autocompletion=studies,
            help=("A study's folder or file, or the name of one that ships. The code in a folder is run."),
        ),
    ] = _DEFAULT,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Run folder; reliab-run/STUDY by default.")
    ] = None,
    motions: Motions = None,
    sets: Sets = None,
    title: ReportTitle = None,
    date: ReportDate = None,
    paper: Paper = "a4",
    laboratory: Laboratory = None,
    logo: Logo = None,
    listed: Annotated[bool, typer.Option("--list", help="List the studies that ship.")] = False,
    json_target: JsonTarget = None,
) -> None:
    """Run a study: simulate, fit, derive, validate, report."""
    if listed:
        _refuse_beside_list(context)
        _list(json_target)
        return
    from reliab.study import open_study, run_study

    setting = setting_of(title, date, paper, laboratory, logo)
    chosen = open_study(study)
    if motions or sets:
        chosen = chosen.on(motions, sets)
    folder = out or _OUT / _name_of(Path(study).resolve())
    stages: dict[str, bool] = {}

    def tell(name: str, done: bool) -> None:  # noqa: FBT001 - called by position
        stages[name] = done
        if json_target != "-":
            console().print(f"{'done' if done else 'kept':>5}  {name}", highlight=False)

    report = run_study(chosen, folder, show=progress_bar, tell=tell, setting=setting)
    content = {"study": chosen.title, "folder": str(folder), "report": str(report), "stages": stages}
    if not write_json(content, json_target):
        console().print(f"Report: {report}", highlight=False)


def _name_of(study: Path) -> str:
    """Name of a study: that of its folder, or of its file."""
    return study.parent.name if study.name == "study.toml" else study.stem


def _refuse_beside_list(context: typer.Context) -> None:
    """Refuse what has no effect beside --list."""
    for name in given_options(context):
        if name not in ("listed", "json_target"):
            idle = "a study" if name == "study" else f"--{name}"
            raise InputError("--list only lists the studies that ship", value=idle, remedy="Leave it out")


def _list(json_target: str | None) -> None:
    from reliab.study import shipped_studies

    studies = shipped_studies()
    rows = [{"name": name, "kind": study.kind, "title": study.title} for name, study in studies.items()]
    if write_json({"studies": rows}, json_target):
        return
    shown = table("Studies that ship", {"study": "left", "kind": "left", "title": "left"})
    for row in rows:
        shown.add_row(*row.values())
    console().print(shown)

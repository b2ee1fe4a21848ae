"""Reading studies from their TOML files."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from reliab.core.described_files import described, read_toml
from reliab.core.errors import InputError
from reliab.core.shipped import is_own_data
from reliab.study.description import Study
from reliab.study.folders import FILE, REMEDY, RULE, described_folders, kind_of, shipped_folders
from reliab.study.kinds import KINDS


def read_study(path: str | Path) -> Study:
    """Read a study."""
    content = read_toml(path, rule=RULE, remedy=REMEDY)
    return study_from(content, where=str(path))


def study_from(content: Mapping[str, Any], *, where: str = "") -> Study:
    """Make a study of its tables."""
    name = content.get("kind")
    if not isinstance(name, str) or name not in KINDS:
        raise InputError(
            "The study has no kind" if name is None else f"Unknown kind of study: {name!r}",
            remedy=f"Choose among {', '.join(KINDS)}",
            where=where,
        )
    tables = KINDS[name].tables
    return described(
        tables,
        content,
        rule="A study holds the keys that its kind knows, with allowed values",
        remedy=f"A study of the kind {name} knows {', '.join(tables.model_fields)}",
        where=where,
    )


def open_study(name: str | Path) -> Study:
    """Read a study from its folder or its file, or one that ships by its name.

    The code in the folder of a study, `kind.py`, is imported.

    Parameters
    ----------
    name : str or pathlib.Path
        A folder that holds `study.toml`, a TOML file, or a name such as ``quick``.

    Returns
    -------
    Study
        The study.

    Raises
    ------
    InputError
        If there is none, its file is not allowed, or its code cannot be imported.
    """
    path = Path(name)
    if not path.suffix and len(path.parts) == 1 and not is_own_data(path, FILE):
        present = shipped_folders()
        if path.name not in present:
            raise InputError(
                f"No study {str(name)!r}",
                remedy=f"Choose among {', '.join(present) or 'your own: none ships with this installation'}",
            )
        path = present[path.name]
    if path.is_dir():
        path = path / FILE
    if path.name == FILE and (kind := kind_of(path.parent)) is not None:
        KINDS.add(kind)
    return read_study(path)


def list_shipped() -> list[dict[str, str]]:
    """Name, kind and title of every study that ships; no code of theirs is imported."""
    return [
        {"name": name, **{key: str(content.get(key, "")) for key in ("kind", "title")}}
        for name, content in described_folders().items()
    ]

"""Where the studies and datasets that ship with the project are found.

In an installed wheel they lie in the folder `shipped/` beside this module, which holds no Python and
therefore does not stand in its way; in a checkout they are the folders `studies/` and `datasets/` beside
the package.
"""

from pathlib import Path

from reliab.errors import InputError

KINDS = ("datasets", "studies")
"""What ships with the project."""

_INSTALLED = Path(__file__).with_suffix("")
_CHECKOUT = Path(__file__).parents[1]


def shipped(kind: str, name: str) -> Path:
    """Find a file or folder that ships with the project.

    Parameters
    ----------
    kind : {"datasets", "studies"}
        What it is.
    name : str
        Its path below the folder of its kind, for example ``"paper/table2.csv"``.

    Returns
    -------
    Path
        Where it lies.

    Raises
    ------
    InputError
        If the kind is unknown or there is nothing of that name; the message lists what there is.

    Examples
    --------
    >>> shipped("datasets", "paper/table2.csv").name
    'table2.csv'
    """
    if kind not in KINDS:
        raise InputError("What ships is a dataset or a study", value=kind, remedy=f"Use {' or '.join(KINDS)}")
    folder = _INSTALLED / kind
    if not folder.is_dir():
        folder = _CHECKOUT / kind
    path = folder / name
    if not path.exists():
        present = sorted(entry.name for entry in folder.glob("*") if entry.name != "README.md")
        raise InputError(
            f"Nothing of that name ships among the {kind}",
            value=name,
            remedy=f"Choose among {', '.join(present)}",
        )
    return path


def or_shipped(path: Path, kind: str, file: str) -> Path:
    """Take a path as it is, or as the name of something that ships where there is no such path.

    Parameters
    ----------
    path : pathlib.Path
        A path, or a name such as ``real_suite``.
    kind : {"datasets", "studies"}
        What it is.
    file : str
        Which file of the shipped folder is meant.

    Returns
    -------
    pathlib.Path
        The path, or that of the shipped file.
    """
    if path.exists() or path.suffix or len(path.parts) != 1:
        return path
    return shipped(kind, f"{path}/{file}")

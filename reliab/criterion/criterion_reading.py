"""Criteria from files."""

from pathlib import Path

from reliab.criterion.criterion import Criterion
from reliab.errors import InputError
from reliab.files import ordinary


def read_criterion(path: str | Path) -> Criterion:
    """Read a criterion from a file.

    Parameters
    ----------
    path : str or pathlib.Path
        JSON, as `reliab criterion --out` writes it.

    Returns
    -------
    Criterion
        The criterion.

    Raises
    ------
    InputError
        If the file cannot be read, or holds no criterion.
    """
    try:
        text = ordinary(Path(path)).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            "The criterion's file must be readable",
            value=getattr(error, "strerror", None) or "no text",
            remedy="Write one with `reliab criterion --out`",
            where=str(path),
        ) from error
    return Criterion.from_json(text)

"""Keys that a part of a criterion's file must have."""

from collections.abc import Collection, Mapping
from typing import Any

from reliab.errors import InputError


def require_keys(content: object, needed: Collection[str], what: str) -> Mapping[str, Any]:
    """Return a mapping that has exactly the needed keys, or say which are missing or unknown.

    Parameters
    ----------
    content : object
        A part of a file, a mapping if the file is right.
    needed : collection of str
        Its keys.
    what : str
        What the part describes, as the subject of a sentence.

    Returns
    -------
    mapping
        The content.

    Raises
    ------
    InputError
        If it is no mapping, or a key is missing or unknown.

    Examples
    --------
    >>> require_keys({"a": 1}, ("a", "b"), "A pair")
    Traceback (most recent call last):
    ...
    reliab.errors.InputError: A pair must have the keys a, b; found b missing. Derive the criterion again.
    """
    keys = set(content) if isinstance(content, Mapping) else set()
    missing, unknown = sorted(set(needed) - keys), sorted(str(key) for key in keys - set(needed))
    faults = [
        f"{', '.join(names)} {fault}"
        for names, fault in ((missing, "missing"), (unknown, "unknown"))
        if names
    ]
    if faults or not isinstance(content, Mapping):
        raise InputError(
            f"{what} must have the keys {', '.join(needed)}",
            value=" and ".join(faults),
            remedy="Derive the criterion again",
        )
    return content

"""`reliab info`: the facts about an installation that a bug report needs."""

import platform
import sys
from typing import Any

from reliab.cli.options import JsonTarget
from reliab.cli.output import write_json, write_line
from reliab.shipped import KINDS, shipped
from reliab.version import __version__

_PACKAGES = (
    *("numpy", "scipy", "pandas", "xarray", "numba", "matplotlib", "seaborn", "emcee", "arviz-stats", "zarr"),
    *("h5netcdf", "h5py", "typst", "typer", "rich", "pydantic", "dask", "distributed"),
)
_MEGABYTE = 1e6


def info(*, json_target: JsonTarget = None) -> None:
    """Print versions, shipped data and where compiled code is kept, for a bug report."""
    content = describe()
    if write_json(content, json_target):
        return
    for name, value in content.items():
        if isinstance(value, dict):
            write_line(f"{name}:")
            for key, text in value.items():
                write_line(f"  {key}: {text}")
        else:
            write_line(f"{name}: {value}")


def describe() -> dict[str, Any]:
    """Describe the installation.

    Returns [MB].
    Returns versions of reliab, Python and the packages that it uses, the platform, the folder and size [MB]
    of the shipped datasets and studies, and the folder of compiled code; ready for JSON.
    """
    return {
        "reliab": __version__,
        "python": platform.python_version(),
        "platform": platform.platform(),
        "executable": sys.executable,
        "packages": {name: _version(name) for name in _PACKAGES},
        "shipped": {kind: _folder(kind) for kind in KINDS},
        "compiled code": _compiled_code(),
    }


def _version(name: str) -> str:
    from importlib import metadata

    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "not installed"


def _folder(kind: str) -> str:
    folder = shipped(kind, "")
    size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
    return f"{folder}, {size / _MEGABYTE:.1f} MB"


def _compiled_code() -> str:
    try:
        from reliab.compiled import kernel_folder
    except ImportError as error:
        return f"none ({error})"
    folder = kernel_folder()
    if folder is None:
        return "not kept"
    return "__pycache__ beside each module" if folder.name == "__pycache__" else str(folder.parent)

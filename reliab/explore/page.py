"""One page that works without a network: JavaScript, style and ellipses written into one HTML file.

The scripts in `web/` are modules that import each other. The page holds all of them in one script: each
module follows those that it imports, as a function that returns its exports. A content security policy allows
only this script and this style, by their checksums: no network request and no other script.
"""

import base64
import hashlib
import json
import re
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from graphlib import TopologicalSorter
from pathlib import Path
from typing import Any, Final

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.core.errors import InputError
from reliab.core.files import refuse_unwritable, require_ending, written_whole
from reliab.core.vocabulary import CurveName
from reliab.criterion.carrying import carry_to_length, protect_over_lengths
from reliab.criterion.derivation import MOST_AT_REST
from reliab.criterion.ellipse_table import REST, names_along
from reliab.criterion.population import is_ellipse
from reliab.criterion.scope import population_of
from reliab.sweep.labels import select_share, share_of
from reliab.version import __version__

_FOLDER: Final = Path(__file__).parent / "web"
_MAIN: Final = "main"
_RECORD, _ARIAS = "record", "arias"
_ROUNDING = 1e-9
_IMPORT = re.compile(r'^import (\{.*\}) from "\./(\w+)\.js";$', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?(?:function\*?|class|const) (\w+))", re.MULTILINE)
_DROPPED_BITS = 12
_LARGEST_CODE = 0xFFFF
_NEVER = 1e300
_ORDER = ("threshold", "metric", "side", "f", "xi", "motion")


@dataclass(frozen=True, kw_only=True)
class Settings:
    """Structure and criterion with which the page opens."""

    frequency: float | None = None  # Natural frequency [Hz]; 1 Hz, or the nearest of the ellipses, by default
    damping_ratio: float | None = None  # Damping ratio [-]; 0.02, or the nearest of the ellipses, by default
    experimental_fraction: float = 1.0  # Share of the stiffness in the laboratory [-]
    # Error of the whole test [-]; 0.05, or the nearest of the ellipses, by default
    threshold: float | None = None
    confidence: float = 0.95  # Share of the population's ground motions [-]
    metric: str | None = None  # Which error, "rms" or "mte"; the first of the ellipses by default


def sort_by_length(windows: Mapping[str, xr.Dataset]) -> dict[str, xr.Dataset]:
    """Choose the ellipses of a page among those of a file, by window.

    Those of whole records are carried to each length to which the records can be cut; where nothing is known
    of that, the windows of the first seconds stand for lengths.
    """
    full_record = windows.get(_RECORD)
    if full_record is not None and "length" in full_record.coords:
        cuts = (float(length) for length in full_record["length"])
        return {
            _RECORD: full_record,
            **{f"{length:g}": carry_to_length(full_record, length) for length in cuts},
        }
    return {label: table for label, table in windows.items() if label != _ARIAS} or dict(windows)


def write_page(
    path: str | Path, ellipses: Mapping[str, xr.Dataset], settings: Settings | None = None, *, source: str
) -> None:
    """Write the explorer of a set of ellipses.

    `ellipses`: `a` [-] and `b` [ms²] over (motion, f, xi, threshold, metric, curve, side) by window: "record"
    or a length in seconds; `settings`: structure and criterion with which the page opens.
    """
    require_ending(path, ".html")
    content = render(pack(ellipses), settings or Settings(), source=source)
    with refuse_unwritable("Cannot write the page", where=path), written_whole(path) as file:
        file.write_text(content, encoding="utf-8", newline="\n")


def render(content: Mapping[str, Any], settings: Settings, *, source: str) -> str:
    """Write packed ellipses, scripts and style into the template."""
    data = {
        "ellipses": dict(content),
        "settings": _opening(content, settings),
        "provenance": f"Written by reliab {__version__} from {source}.",
    }
    script, style = bundle_script(), (_FOLDER / "style.css").read_text(encoding="utf-8")
    parts = {
        "policy": f"default-src 'none'; script-src '{_checksum(script)}'; style-src '{_checksum(style)}'; "
        "base-uri 'none'; form-action 'none'",
        "style": style,
        "data": json.dumps(data, allow_nan=False).replace("<", "\\u003c"),
        "script": script,
    }
    template = (_FOLDER / "template.html").read_text(encoding="utf-8")
    return re.sub(r"\{\{ (\w+) \}\}", lambda match: parts[match[1]], template)


def bundle_script() -> str:
    """Return all scripts of the page as one, each after what it imports, and the main one at the end."""
    sources = {path.stem: path.read_text(encoding="utf-8") for path in sorted(_FOLDER.glob("*.js"))}
    needs = {
        name: dict.fromkeys(module for _, module in _IMPORT.findall(text)) for name, text in sources.items()
    }  # in order, which sets of text are not: equal input gives equal bytes
    order = [name for name in TopologicalSorter(needs).static_order() if name != _MAIN]
    modules = [_as_function(name, sources[name]) for name in order]
    return "\n".join([*modules, f"await (async () => {{\n{_body(sources[_MAIN])}}})();\n"])


def _as_function(name: str, text: str) -> str:
    names = ", ".join(_EXPORT.findall(text))
    return f"const module_{name} = (() => {{\n{_body(text)}return {{ {names} }};\n}})();\n"


def _body(text: str) -> str:
    return _EXPORT.sub("", _IMPORT.sub(r"const \1 = module_\2;", text))


def _checksum(text: str) -> str:
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode('utf-8')).digest()).decode('ascii')}"


def _opening(data: Mapping[str, Any], settings: Settings) -> dict[str, Any]:
    """Return the checked settings by the page's names, with defaults for those not given."""
    for name, value in (("share", settings.experimental_fraction), ("confidence", settings.confidence)):
        if not 0.0 < value <= 1.0:
            raise InputError(f"The {name} must lie between 0 and 1", value=value)
    metrics = data["metrics"]
    if settings.metric not in (None, *metrics):
        raise InputError(
            "The ellipses are not of this metric",
            value=settings.metric,
            remedy=f"Choose among {', '.join(metrics)}",
        )
    return {
        "frequency": _clamp("natural frequency", settings.frequency, data["frequencies"], 1.0),
        "dampingRatio": _clamp("damping ratio", settings.damping_ratio, data["dampingRatios"], 0.02),
        "threshold": _clamp("error threshold", settings.threshold, data["thresholds"], 0.05),
        "share": settings.experimental_fraction,
        "confidence": settings.confidence,
        "metric": settings.metric or metrics[0],
    }


def _clamp(name: str, value: float | None, stored_values: list[float], usual: float) -> float:
    """Return a value within the range of the ellipses; by default the one nearest to a usual value."""
    low, high = min(stored_values), max(stored_values)
    if value is None:
        return min(max(usual, low), high)
    if not low * (1.0 - _ROUNDING) <= value <= high * (1.0 + _ROUNDING):
        raise InputError(
            f"The ellipses are of a {name} from {low:g} to {high:g}",
            value=value,
            remedy="Choose one in that range, or trace ellipses of it with `reliab ellipses` and give them "
            "as `ellipses`",
        )
    return value


def pack(ellipses: Mapping[str, xr.Dataset]) -> dict[str, Any]:
    """Pack the ellipses of windows as the page stores them: 16-bit codes, compressed and written as text.

    A float32 whose mantissa was rounded to eleven binary digits, as in the ellipses that ship, is its sign,
    eight bits of exponent and eleven of mantissa. The sign is plus, and a as well as b span less than 32
    powers of two: sixteen bits above an offset hold it exactly. Zero stands for a motion without an ellipse.
    Other ellipses are rounded to the same digits, 2.4e-4 relative.
    """
    protected_ellipses = [protect_over_lengths(dataset) for dataset in ellipses.values()]
    tables = [_select_inscribed_ellipses(dataset) for dataset in protected_ellipses]
    first = tables[0]
    bits = [
        np.stack([_bits(table[name].values.astype(np.float64)) for table in tables]) for name in ("a", "b")
    ]
    offsets = [int(values[values > 0].min()) - 1 for values in bits]
    codes = np.stack(
        [np.where(values > 0, values - offset, 0) for values, offset in zip(bits, offsets, strict=True)],
        axis=1,
    )
    if codes.max() > _LARGEST_CODE:
        raise InputError(
            "The ellipses differ too much in size for one page",
            value=f"{(codes.max() + 1) / 2**11:.0f}",
            remedy="Trace fewer thresholds or structures",
        )
    codes[1:] = (codes[1:] - codes[0]) % (_LARGEST_CODE + 1)  # differences between windows are small
    planes = codes.astype("<u2").reshape(-1, 1).view(np.uint8).T
    return {
        "windows": list(ellipses),
        "thresholds": first["threshold"].values.astype(float).tolist(),
        "metrics": first["metric"].values.tolist(),
        "sides": names_along(first, "side"),
        "frequencies": first["f"].values.astype(float).tolist(),
        "dampingRatios": first["xi"].values.astype(float).tolist(),
        "motions": first["motion"].values.tolist(),
        "events": first["event"].values.tolist(),
        "share": share_of(first),
        "population": population_of(next(iter(ellipses.values()))),
        "protection": str(first.attrs.get("carried_to", "")),
        "meaningless": [_meaningless(table) for table in tables],
        "offsets": offsets,
        "codes": base64.b64encode(zlib.compress(planes.tobytes())).decode("ascii"),
    }


def _select_inscribed_ellipses(ellipses: xr.Dataset) -> xr.Dataset:
    """Inscribed ellipses, or least-squares ones where no inscribed ones are stored, in the page's order."""
    ellipses = select_share(ellipses)
    curves = names_along(ellipses, "curve")
    if "curve" in ellipses.dims:
        curve = CurveName.INSCRIBED if CurveName.INSCRIBED in curves else curves[0]
        ellipses = ellipses.sel(curve=str(curve))
    if "side" not in ellipses.dims:
        ellipses = ellipses.expand_dims("side")
    return ellipses.sortby(["f", "xi", "threshold"]).transpose(*_ORDER, ...)


def _meaningless(ellipses: xr.Dataset) -> list[list[list[float]]] | None:
    """Smallest threshold [-] that an actuator at rest meets under too many motions, over (metric, f, xi)."""
    if REST not in ellipses:
        return None
    errors = np.sort(ellipses[REST].transpose("motion", "metric", "f", "xi").values.astype(float), axis=0)
    n_known = np.maximum(np.isfinite(errors).sum(axis=0), 1)
    place = np.floor(MOST_AT_REST * n_known).astype(int)
    least = np.take_along_axis(errors, place[np.newaxis], axis=0)[0]
    table: list[list[list[float]]] = np.nan_to_num(least, nan=_NEVER, posinf=_NEVER).tolist()
    return table


def _bits(values: NDArray[np.float64]) -> NDArray[np.int64]:
    """Sign, exponent and eleven bits of mantissa as a float32; zero where there is no ellipse."""
    patterns = np.ascontiguousarray(values, dtype=np.float32).view(np.uint32).astype(np.int64)
    patterns = (patterns + (1 << (_DROPPED_BITS - 1))) >> _DROPPED_BITS
    return np.where(is_ellipse(values, values), patterns, 0)

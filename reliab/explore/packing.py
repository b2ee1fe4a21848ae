"""Ellipses of ground motions as the page stores them: 16-bit codes, compressed and written as text.

A float32 whose mantissa was rounded to eleven binary digits, as in the ellipses that ship, is its sign, eight
bits of exponent and eleven of mantissa. The sign is plus, and a as well as b span less than 32 powers of two:
sixteen bits above an offset hold it exactly. Zero stands for a motion without an ellipse. Other ellipses are
rounded to the same digits, 2.4e-4 relative.
"""

import base64
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.criterion import MOST_AT_REST, REST, is_ellipse, names_along
from reliab.errors import InputError
from reliab.sweep import at_share, share_of
from reliab.vocabulary import CurveName

_DROPPED_BITS = 12
_LARGEST_CODE = 0xFFFF
_NEVER = 1e300
_ORDER = ("threshold", "metric", "side", "f", "xi", "motion")


def pack(ellipses: Mapping[str, xr.Dataset]) -> dict[str, Any]:
    """Pack the ellipses of windows."""
    tables = [_inscribed(dataset) for dataset in ellipses.values()]
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
            "Parameters of the ellipses in one page must lie within 32 powers of two of each other",
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
        "meaningless": [_meaningless(table) for table in tables],
        "offsets": offsets,
        "codes": base64.b64encode(zlib.compress(planes.tobytes())).decode("ascii"),
    }


def _inscribed(ellipses: xr.Dataset) -> xr.Dataset:
    """Inscribed ellipses, or least-squares ones where no inscribed ones are stored, in the page's order."""
    ellipses = at_share(ellipses)
    curves = names_along(ellipses, "curve")
    if "curve" in ellipses.dims:
        chosen = CurveName.INSCRIBED if CurveName.INSCRIBED in curves else curves[0]
        ellipses = ellipses.sel(curve=str(chosen))
    if "side" not in ellipses.dims:
        ellipses = ellipses.expand_dims("side")
    return ellipses.sortby(["f", "xi", "threshold"]).transpose(*_ORDER, ...)


def _meaningless(ellipses: xr.Dataset) -> list[list[list[float]]] | None:
    """Smallest threshold [-] that an actuator at rest meets under too many motions, over (metric, f, xi)."""
    if REST not in ellipses:
        return None
    errors = np.sort(ellipses[REST].transpose("motion", "metric", "f", "xi").values.astype(float), axis=0)
    known = np.maximum(np.isfinite(errors).sum(axis=0), 1)
    place = np.floor(MOST_AT_REST * known).astype(int)
    least = np.take_along_axis(errors, place[np.newaxis], axis=0)[0]
    listed: list[list[list[float]]] = np.nan_to_num(least, nan=_NEVER, posinf=_NEVER).tolist()
    return listed


def _bits(values: NDArray[np.float64]) -> NDArray[np.int64]:
    """Sign, exponent and eleven bits of mantissa as a float32; zero where there is no ellipse."""
    rounded = np.ascontiguousarray(values, dtype=np.float32).view(np.uint32).astype(np.int64)
    rounded = (rounded + (1 << (_DROPPED_BITS - 1))) >> _DROPPED_BITS
    return np.where(is_ellipse(values, values), rounded, 0)

"""Arguments of `reliab.assess` that only `reliab.assessment.assess` keeps."""

import warnings
from collections.abc import Mapping
from typing import TypedDict

from reliab.stated_value import StatedValue


class Former(TypedDict, total=False):
    """Standard deviations of what is stated by name, window of the evaluation index, seed of the draws."""

    stated: Mapping[str, StatedValue]
    taper: str
    seed: int


def accepted(former: Former) -> Former:
    """Return former arguments with a warning for each; any other is none of `assess`."""
    for name in former:
        if name not in Former.__annotations__:
            raise TypeError(f"assess() got an unexpected keyword argument '{name}'")
        warnings.warn(
            f"`{name}` of `reliab.assess` ends with version 0.4; `reliab.assessment.assess` has it",
            DeprecationWarning,
            stacklevel=3,
        )
    return former

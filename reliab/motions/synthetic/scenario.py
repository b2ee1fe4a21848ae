"""Earthquake, distance and site: the input of the ground-motion model."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from reliab.core.errors import InputError


class Mechanism(StrEnum):
    """Style of faulting; the model has no class for normal faults, which count as strike-slip."""

    STRIKE_SLIP = "strike_slip"
    REVERSE = "reverse"


VALID_RANGES: Final = {
    "magnitude": (5.5, 7.9, ""),
    "depth_to_top": (0.0, 31.0, " km"),
    "rupture_distance": (0.07, 31.0, " km"),
    "shear_wave_velocity": (139.0, 2016.0, " m/s"),
    "directivity_length": (1.2, 135.0, " km"),
    "directivity_angle": (0.0, 90.0, "°"),
}
"""Smallest and largest value of each quantity in the records that the model was fitted to, and the unit."""


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """One earthquake as seen from one station, within the range that the model was fitted to.

    Dabaghi & Der Kiureghian (2018), Earthquake Engng Struct. Dyn. 47; Somerville et al. (1997), Seismol.
    Res. Lett. 68(1), for the directivity parameters.

    >>> Scenario(
    ...     magnitude=8.2,
    ...     mechanism=Mechanism.REVERSE,
    ...     depth_to_top=0.0,
    ...     rupture_distance=10.0,
    ...     shear_wave_velocity=360.0,
    ...     directivity_length=20.0,
    ...     directivity_angle=30.0,
    ... )
    Traceback (most recent call last):
    ...
    reliab.core.errors.InputError: The magnitude must lie between 5.5 and 7.9, where the model was fitted;
    found 8.2.
    """

    magnitude: float  # Moment magnitude, 5.5 to 7.9
    mechanism: Mechanism  # Style of faulting
    # Depth of the top of the rupture Z_TOR [km]; the rupture distance is at least this depth
    depth_to_top: float
    rupture_distance: float  # Closest distance from the station to the rupture R_rup [km], 0.07 to 31
    # Mean shear-wave velocity of the upper 30 m of ground V_S30 [m/s], 139 to 2016
    shear_wave_velocity: float
    # Length of the rupture that breaks towards the station, along strike (s) or up dip (d), whichever is
    # larger [km], 1.2 to 135
    directivity_length: float
    # Angle between the direction of rupture and the direction of the station, θ for s or φ for d [degrees], 0
    # to 90
    directivity_angle: float

    def __post_init__(self) -> None:
        for name, (lowest, highest, unit) in VALID_RANGES.items():
            value = getattr(self, name)
            if not lowest <= value <= highest:
                span = f"between {lowest:g} and {highest:g}{unit}"
                raise InputError(
                    f"The {name.replace('_', ' ')} must lie {span}, where the model was fitted", value=value
                )
        if self.depth_to_top > self.rupture_distance:
            raise InputError(
                "The rupture cannot be nearer to the station than its top is deep",
                value=f"{self.rupture_distance:g} km with the top at {self.depth_to_top:g} km",
            )

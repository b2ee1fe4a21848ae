"""From an earthquake and a station to the parameters of a near-fault motion: the published regression.

Dabaghi, M. and Der Kiureghian, A. (2018), Simulation of orthogonal horizontal components of near-fault ground
motion for specified earthquake source and site characteristics, Earthquake Engng Struct. Dyn. 47; the
stochastic model is that of the same authors (2017), Stochastic model for simulation of near-fault ground
motions, Earthquake Engng Struct. Dyn. 46, and of PEER report 2014/20.

Each parameter is transformed to a normal variable ν, for which (2017, eq. 12)

    ν = β₀ + β₁ M + β₂ max(M − 6.5, 0) + β₃ ln R' + β₄ M ln R' + β₅ F Z + β₆ ln V + β₇ s + ε

with R' = √(R_rup² + 6²) [km], F = 1 for reverse faulting and 0 for strike-slip, Z = min(Z_TOR, 1) [km],
V = min(V_S30, 1100) [m/s] and s the larger of the directivity lengths s and d [km]. The errors ε are jointly
normal, with the standard deviations and the correlations below, and are cut at two standard deviations.

The tables are taken from two public programs by different authors (SimCenter's smelt, in C++, and J. Guo's
NearFaultMotionSim, in Python), which agree in all their 15 digits; the printed tables were not at hand, and
the numbers of equations are as smelt cites them. Here the coefficients are rounded to five decimals and the
correlations to four.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from math import exp, expm1, hypot, log, pi
from typing import Final

import numpy as np
import scipy

from reliab.core.arrays import Array


class Mechanism(StrEnum):
    """Style of faulting; the model has no class for normal faults, which count as strike-slip."""

    STRIKE_SLIP = "strike_slip"
    REVERSE = "reverse"


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """One earthquake as seen from one station, within the range that the model was fitted to.

    Dabaghi & Der Kiureghian (2018), Earthquake Engng Struct. Dyn. 47; Somerville et al. (1997), Seismol.
    Res. Lett. 68(1), for the directivity parameters.
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


_MAGNITUDE_HINGE: Final = 6.5
_DISTANCE_FLOOR: Final = 6.0
_DEPTH_CAP: Final = 1.0
_VELOCITY_CAP: Final = 1100.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Regression:
    """The regression of one class of motions, for its p transformed parameters at once."""

    names: tuple[str, ...]  # Names of the parameters
    coefficients: Array  # β₀ to β₇ of each parameter, shape (p, 8)
    deviations: Array  # Standard deviations σ of the errors, shape (p,)
    correlation: Array  # Correlations of the errors, shape (p, p)

    def means(self, scenario: Scenario) -> Array:
        """Mean of the transformed parameters in a scenario, shape (p,)."""
        means: Array = np.sum(self.coefficients * _covariates(scenario), axis=1)
        return means

    @cached_property
    def factor(self) -> Array:
        """Cholesky factor of the correlations, shape (p, p), lower triangular."""
        return np.linalg.cholesky(self.correlation).astype(np.float64)


def _covariates(scenario: Scenario) -> Array:
    log_distance = log(hypot(scenario.rupture_distance, _DISTANCE_FLOOR))
    reverse = scenario.mechanism is Mechanism.REVERSE
    return np.array(
        [
            1.0,
            scenario.magnitude,
            max(scenario.magnitude - _MAGNITUDE_HINGE, 0.0),
            log_distance,
            scenario.magnitude * log_distance,
            min(scenario.depth_to_top, _DEPTH_CAP) if reverse else 0.0,
            log(min(scenario.shear_wave_velocity, _VELOCITY_CAP)),
            scenario.directivity_length,
        ]
    )


def _read(table: str, triangle: str) -> Regression:
    rows = [line.split() for line in table.strip().splitlines()]
    numbers = np.array([[float(entry) for entry in row[1:]] for row in rows])
    correlation = np.eye(len(rows))
    for i, line in enumerate(triangle.strip().splitlines(), start=1):
        correlation[i, :i] = correlation[:i, i] = [float(entry) * 1e-4 for entry in line.split()]
    return Regression(
        names=tuple(row[0] for row in rows),
        coefficients=numbers[:, :8],
        deviations=numbers[:, 8],
        correlation=correlation,
    )


# Units: cm/s for the pulse velocity and for Arias intensities, s, Hz, Hz/s.
# Component 1 lies in the direction of the largest pulse and is described without it (residual); component 2
# is orthogonal to it.
#                            1         M  (M-6.5)+     ln R'   M ln R'       F Z      ln V         s    sigma
_PULSE_TABLE: Final = """
pulse_velocity        1.69863   0.60819  -0.60819  -0.57622         0   0.18307  -0.09393   0.00657  0.38532
pulse_period         -2.47924   0.67040         0         0         0  -0.26396  -0.23255   0.00792  0.58060
pulse_oscillations          0         0         0         0         0         0         0         0        1
pulse_phase                 0         0         0         0         0         0         0         0        1
pulse_time           -4.24873   0.85219         0   0.38960         0  -0.38032  -0.08801         0  0.46860
arias_1              -2.11599   1.47405  -1.37811  -1.07312         0   0.33651         0         0  0.78146
d5_95_1              -0.38109   0.73282         0   0.21650         0  -0.16265  -0.42657         0  0.37195
d0_5_1               -5.56311   0.90524         0   0.38515         0  -0.28243         0         0  0.44212
d0_30_1              -4.77682   0.87998         0   0.31061         0  -0.33923         0         0  0.39355
frequency_1           0.96671  -0.11094         0         0         0         0   0.18329         0  0.40999
slope_1              -2.16588   0.32150         0         0         0         0         0         0  0.82013
bandwidth_1          -1.70735   0.43303         0  -0.41265         0         0         0         0  1.09644
arias_2              -0.26320   1.13061  -1.16957  -1.65164   0.10475   0.40406         0         0  0.74655
d5_95_2              -0.51597   0.75414         0   0.19158         0  -0.12167  -0.42384         0  0.40244
d0_5_2               -5.77208   0.92314         0   0.40294         0  -0.23820         0         0  0.46142
d0_30_2              -5.01588   0.90503         0   0.32684         0  -0.32828         0         0  0.40772
frequency_2           0.43434  -0.12523         0         0         0         0   0.30163         0  0.44017
slope_2              -2.87545   0.41568         0         0         0         0         0         0  0.82463
bandwidth_2          -1.86756   0.45745         0  -0.50110         0         0         0         0  0.96200
"""

# Lower triangle below the diagonal, in units of 1e-4, in the order of the table above.
_PULSE_CORRELATION: Final = """
-1758
-203 1834
1736 13 -1900
1911 4316 2428 1192
4466 -803 1782 -812 597
422 984 1072 912 1637 -244
268 3105 1505 654 7331 584 612
1200 3682 2364 718 7887 857 2454 8552
-3822 510 -1140 -1336 -313 784 -247 120 299
573 223 536 -920 -1538 991 -2248 -490 -618 -2415
1551 1752 642 299 1261 265 459 2000 1978 1125 1124
4072 -979 689 -242 158 8378 364 213 1049 1718 -107 -274
-406 1431 1279 -173 1869 236 7605 1468 2626 -492 -488 871 -1684
165 2952 894 663 6808 72 370 9316 7955 494 -635 1609 139 585
415 3709 2137 729 7493 802 2057 8504 9066 1127 -911 2564 607 2431 8412
-2829 410 -697 -1462 75 1255 -838 232 381 8647 -886 2755 951 101 320 1000
1062 -682 212 1000 -1658 813 -339 -39 -144 -2862 4215 -1759 1663 -1343 396 -849 -4330
486 2433 1231 -409 1925 454 -275 2444 2260 1579 2395 7925 -378 858 1833 2773 2624 -1849
"""

# Components 1 and 2 lie along the major and the intermediate principal axis of the horizontal motion.
#                            1         M  (M-6.5)+     ln R'   M ln R'       F Z      ln V         s    sigma
_NO_PULSE_TABLE: Final = """
arias_1               8.09696   1.00610  -1.39348  -4.85870   0.47264   0.43455  -0.86256         0  1.05272
d5_95_1              -1.03474   0.76909         0   0.41224         0  -0.37774  -0.42423         0  0.39843
d0_5_1               -4.72728   0.70972         0   0.47097         0  -0.12352         0         0  0.45683
d0_30_1              -4.44400   0.79809         0   0.34541         0  -0.23082         0         0  0.30573
frequency_1           0.24713  -0.14921         0         0         0         0   0.37720         0  0.44752
slope_1              -1.44303   0.22305         0         0         0         0         0         0  0.94129
bandwidth_1          -0.38041   0.15934         0  -0.29821         0         0         0         0  1.00768
arias_2               7.30683   0.99926  -1.33083  -4.95306   0.49055   0.44250  -0.83531         0  1.02823
d5_95_2              -0.40371   0.67238         0   0.33537         0  -0.33032  -0.36670         0  0.37588
d0_5_2               -4.79820   0.70916         0   0.47256         0  -0.07558         0         0  0.45841
d0_30_2              -4.35042   0.78529         0   0.32546         0  -0.22153         0         0  0.29412
frequency_2           0.42485  -0.18120         0         0         0         0   0.40155         0  0.39997
slope_2              -2.97912   0.42002         0         0         0         0         0         0  0.83155
bandwidth_2          -0.70369   0.16057         0  -0.14579         0         0         0         0  0.88787
"""

_NO_PULSE_CORRELATION: Final = """
-1836
890 854
1041 3074 8132
143 -150 -2254 -1629
2029 -1494 7 -946 -1875
-1519 888 -841 -192 -1637 -854
9452 -794 563 1310 720 1520 -1098
-778 8484 1372 2895 -806 -283 606 -745
496 951 9076 7528 -1730 22 -674 477 782
967 2887 7883 9085 -1651 -879 -179 1170 2947 7861
918 -597 -1892 -1515 8971 -875 -880 1047 -896 -1775 -1684
1037 -161 -219 -638 -778 6475 -1059 1375 -502 87 -774 -1838
-1212 1139 -932 -499 -42 -1571 7613 -1072 968 -672 -275 69 -1109
"""

PULSE: Final = _read(_PULSE_TABLE, _PULSE_CORRELATION)
"""Motions with a velocity pulse: five parameters of the pulse, seven of each component."""

NO_PULSE: Final = _read(_NO_PULSE_TABLE, _NO_PULSE_CORRELATION)
"""Motions without a pulse: seven parameters of each component."""


# Beta distributions: the two shape parameters, the lower and the upper bound.
_OSCILLATIONS: Final = (1.30326, 3.96858, 2.0, 3.2)
_LOG_BANDWIDTH: Final = (5.33552, 3.82954, -4.7, 0.0)

_PHASE_BOUND: Final = 2.0
"""The phase of a pulse is uniform between 0 and this many half turns."""

# Two-sided exponential density c exp(b x) below zero and c exp(-a x) above, between the bounds [Hz/s].
_SLOPE_RATE_ABOVE: Final = 14.29355
_SLOPE_RATE_BELOW: Final = 6.40242
_SLOPE_LOWEST: Final = -3.5
_SLOPE_HIGHEST: Final = 1.5


def _beta_quantile(nu: float, shape: tuple[float, float, float, float]) -> float:
    first, second, lowest, highest = shape
    return lowest + (highest - lowest) * float(
        scipy.special.betaincinv(first, second, scipy.special.ndtr(nu))
    )


def oscillations(nu: float) -> float:
    """Return the number of half cycles γ of a pulse, beta-distributed between 2 and 3.2.

    >>> round(oscillations(0.0), 3)
    2.257
    """
    return _beta_quantile(nu, _OSCILLATIONS)


def phase(nu: float) -> float:
    """Return the phase of a pulse in half turns, uniform between 0 and 2.

    >>> phase(0.0)
    1.0
    """
    return _PHASE_BOUND * float(scipy.special.ndtr(nu))


def bandwidth(nu: float) -> float:
    """Return the damping ratio ζ of the noise filter, whose logarithm is beta-distributed between −4.7 and 0.

    >>> round(bandwidth(0.0), 3)
    0.144
    """
    return exp(_beta_quantile(nu, _LOG_BANDWIDTH))


def slope(nu: float) -> float:
    """Return the rate of change of the filter frequency [Hz/s], with a two-sided exponential distribution.

    Its density is c exp(6.40 x) below zero and c exp(−14.29 x) above, cut at −3.5 and 1.5 Hz/s, c = 4.4218.

    >>> round(slope(0.0), 4)
    -0.0505
    """
    lower_part = -expm1(_SLOPE_RATE_BELOW * _SLOPE_LOWEST) / _SLOPE_RATE_BELOW
    upper_part = -expm1(-_SLOPE_RATE_ABOVE * _SLOPE_HIGHEST) / _SLOPE_RATE_ABOVE
    area = float(scipy.special.ndtr(nu)) * (lower_part + upper_part)
    if area < lower_part:
        return log(exp(_SLOPE_RATE_BELOW * _SLOPE_LOWEST) + _SLOPE_RATE_BELOW * area) / _SLOPE_RATE_BELOW
    remaining = float(scipy.special.ndtr(-nu)) * (lower_part + upper_part)
    tail = exp(-_SLOPE_RATE_ABOVE * _SLOPE_HIGHEST)
    return -log(tail + _SLOPE_RATE_ABOVE * remaining) / _SLOPE_RATE_ABOVE


_CENTIMETRE = 0.01


@dataclass(frozen=True, kw_only=True)
class ComponentParameters:
    """Parameters of one horizontal component."""

    arias_intensity: float  # Arias intensity I_a [m/s]
    strong_duration: float  # Time between 5 % and 95 % of the Arias intensity, D5-95 [s]
    onset_duration: float  # Time from the start to 5 % of it, D0-5 [s]
    rise_duration: float  # Time from the start to 30 % of it, D0-30 [s]
    frequency: float  # Frequency of the noise filter when 30 % is reached [Hz]
    frequency_slope: float  # Rate of change of that frequency [Hz/s]
    bandwidth: float  # Damping ratio ζ of the noise filter, between 0 and 1

    @property
    def strong_end(self) -> float:
        """Time from the start to 95 % of the Arias intensity, D0-95 [s]."""
        return self.onset_duration + self.strong_duration


@dataclass(frozen=True, kw_only=True)
class PulseParameters:
    """Parameters of the velocity pulse of a recording."""

    velocity: float  # Amplitude V_p [m/s]
    period: float  # Period T_p of the oscillation [s]
    oscillations: float  # Length of the pulse in periods, γ
    phase: float  # Phase of the oscillation against its envelope [rad]
    peak_time: float  # Time from the start to the peak of the envelope [s]

    @property
    def start(self) -> float:
        """Time at which the pulse begins [s]."""
        return self.peak_time - 0.5 * self.oscillations * self.period


@dataclass(frozen=True, kw_only=True)
class RecordingParameters:
    """Parameters of both components of one recording."""

    # Along the major principal axis, or in the direction of the pulse (without the pulse itself)
    first: ComponentParameters
    second: ComponentParameters  # Orthogonal to the first
    pulse: PulseParameters | None = None  # The velocity pulse in the direction of the first component


def regression_of(*, pulse_like: bool) -> Regression:
    """Return the regression for motions with or without a pulse."""
    return PULSE if pulse_like else NO_PULSE


def physical_parameters(normal: Array, *, pulse_like: bool) -> RecordingParameters:
    """Transform the normal variables of the regression to physical parameters.

    `normal` (19,) with a pulse or (14,).

    >>> parameters = physical_parameters(NO_PULSE.coefficients[:, 0], pulse_like=False)
    >>> round(parameters.second.arias_intensity, 2)
    14.9
    """
    values = dict(zip(regression_of(pulse_like=pulse_like).names, normal.tolist(), strict=True))
    return RecordingParameters(
        first=_component(values, "1"),
        second=_component(values, "2"),
        pulse=_pulse(values) if pulse_like else None,
    )


def _component(values: Mapping[str, float], number: str) -> ComponentParameters:
    return ComponentParameters(
        arias_intensity=exp(values[f"arias_{number}"]) * _CENTIMETRE,
        strong_duration=exp(values[f"d5_95_{number}"]),
        onset_duration=exp(values[f"d0_5_{number}"]),
        rise_duration=exp(values[f"d0_30_{number}"]),
        frequency=exp(values[f"frequency_{number}"]),
        frequency_slope=slope(values[f"slope_{number}"]),
        bandwidth=bandwidth(values[f"bandwidth_{number}"]),
    )


def _pulse(values: Mapping[str, float]) -> PulseParameters:
    return PulseParameters(
        velocity=exp(values["pulse_velocity"]) * _CENTIMETRE,
        period=exp(values["pulse_period"]),
        oscillations=oscillations(values["pulse_oscillations"]),
        phase=pi * phase(values["pulse_phase"]),
        peak_time=exp(values["pulse_time"]),
    )

"""The effects that a product is told to know (the names of CAMPAIGN.md)."""

from blind_campaigns.catalogue import (
    HERTZ,
    SLOWEST_S,
    SOFTEST_HZ,
    Definition,
    Scales,
    between,
    between_decades,
    same,
    sign,
    whole_steps,
)
from blind_campaigns.march import EXPLICIT_NEWMARK, FORWARD_EULER
from blind_campaigns.system import Array


def _delay_drift(size: float, scales: Scales, shape: Array) -> dict[str, float]:
    """Return a drift that never makes the delay negative."""
    rate = min(size / scales.omega, SLOWEST_S) / scales.duration
    shrinking = sign(shape[0]) < 0.0 and rate * scales.duration < 0.9 * scales.delay
    return {"delay_rate_s_per_s": -rate if shrinking else rate}


def _hysteresis(size: float, scales: Scales, shape: Array) -> dict[str, float]:
    return {
        "force_n": size * scales.force_rms,
        "displacement_m": between_decades(0.08, 0.6, shape[0]) * scales.displacement_rms,
        "beta": between(0.5, 0.8, shape[1]),
        "exponent": between(1.0, 3.0, shape[2]),
    }


def _integration_error(size: float, scales: Scales, shape: Array) -> dict[str, float]:
    step = whole_steps(size / scales.omega, scales.integration_step)
    if shape[0] < 0.5:
        return {"scheme": FORWARD_EULER, "step_s": step, "newmark_gamma": 0.5}
    gamma = between(0.7, 1.0, shape[1])
    return {"scheme": EXPLICIT_NEWMARK, "step_s": step, "newmark_gamma": gamma}


def _cubic(size: float, scales: Scales, shape: Array) -> dict[str, float]:
    """Return hardening of any size, or softening that leaves the tangent stiffness positive."""
    softening = sign(shape[0]) < 0.0 and size < 0.3
    return {"cubic_n_per_m3": (-size if softening else size) * scales.stiffness / scales.displacement_peak**2}


ACTUATOR = (
    Definition(
        name="first_order_lag", block="actuator", channel="measured_m", units={"time_constant_s": "s"},
        build=lambda size, scales, _: {"time_constant_s": min(size / scales.omega, SLOWEST_S)},
        fields=same(time_constant_s="lag"), largest=2.0,
    ),
    Definition(
        name="second_order_dynamics", block="actuator", channel="measured_m",
        units={"natural_frequency_hz": "Hz", "damping_ratio": "1"},
        build=lambda size, scales, shape: {
            "natural_frequency_hz": max(scales.omega / size / HERTZ, SOFTEST_HZ),
            "damping_ratio": between(0.3, 0.9, shape[0]),
        },
        fields={"natural_frequency_hz": ("servo_omega", HERTZ), "damping_ratio": ("servo_damping", 1.0)},
        largest=0.6,
    ),
    Definition(
        name="delay_drift", block="actuator", channel="measured_m", units={"delay_rate_s_per_s": "s/s"},
        build=_delay_drift, fields=same(delay_rate_s_per_s="delay_rate"), largest=2.0,
    ),
    Definition(
        name="rate_limit", block="actuator", channel="measured_m", units={"velocity_limit_m_per_s": "m/s"},
        build=lambda size, scales, _: {"velocity_limit_m_per_s": (1.0 - size) * scales.velocity_peak},
        fields=same(velocity_limit_m_per_s="velocity_limit"), largest=0.85,
    ),
    Definition(
        name="stroke_saturation", block="actuator", channel="measured_m", units={"stroke_m": "m"},
        build=lambda size, scales, _: {"stroke_m": (1.0 - size) * scales.displacement_peak},
        fields=same(stroke_m="stroke"), largest=0.8,
    ),
    Definition(
        name="backlash", block="actuator", channel="measured_m", units={"width_m": "m"},
        build=lambda size, scales, _: {"width_m": 2.0 * size * scales.displacement_rms},
        fields=same(width_m="play"), largest=0.6,
    ),
)  # fmt: skip

SENSOR = (
    Definition(
        name="sensor_bias", block="sensor", channel="measured_m", units={"bias_m": "m"},
        build=lambda size, scales, shape: {"bias_m": sign(shape[0]) * size * scales.displacement_rms},
        largest=1.0,
    ),
    Definition(
        name="sensor_drift", block="sensor", channel="measured_m", units={"drift_m_per_s": "m/s"},
        build=lambda size, scales, shape: {
            "drift_m_per_s": sign(shape[0]) * size * scales.displacement_rms / scales.duration
        },
        largest=3.0,
    ),
    Definition(
        name="force_bias", block="sensor", channel="force_n", units={"bias_n": "N"},
        build=lambda size, scales, shape: {"bias_n": sign(shape[0]) * size * scales.force_rms},
        fields=same(bias_n="force_bias"), largest=1.0,
    ),
)  # fmt: skip

SPECIMEN = (
    Definition(
        name="cubic_stiffness", block="specimen", channel="force_n", units={"cubic_n_per_m3": "N/m³"},
        build=_cubic, fields=same(cubic_n_per_m3="cubic"), largest=3.0,
    ),
    Definition(
        name="quadratic_stiffness", block="specimen", channel="force_n", units={"quadratic_n_per_m2": "N/m²"},
        build=lambda size, scales, shape: {
            "quadratic_n_per_m2": sign(shape[0]) * size * scales.stiffness / scales.displacement_peak
        },
        fields=same(quadratic_n_per_m2="quadratic"), largest=0.45,
    ),
    Definition(
        name="coulomb_friction", block="specimen", channel="force_n",
        units={"force_n": "N", "regularisation_velocity_m_per_s": "m/s"},
        build=lambda size, scales, _: {
            "force_n": size * scales.force_rms,
            "regularisation_velocity_m_per_s": 2e-3 * scales.velocity_peak,
        },
        fields=same(force_n="coulomb", regularisation_velocity_m_per_s="coulomb_velocity"), largest=0.8,
    ),
    Definition(
        name="viscous_damping", block="specimen", channel="force_n", units={"damping_n_s_per_m": "N·s/m"},
        build=lambda size, scales, _: {"damping_n_s_per_m": size * scales.viscosity},
        fields=same(damping_n_s_per_m="damping"), largest=1.0,
    ),
    Definition(
        name="quadratic_damping", block="specimen", channel="force_n",
        units={"coefficient_n_s2_per_m2": "N·s²/m²"},
        build=lambda size, scales, _: {
            "coefficient_n_s2_per_m2": 0.5 * size * scales.viscosity / scales.velocity_rms
        },
        fields=same(coefficient_n_s2_per_m2="quadratic_damping"), largest=2.0,
    ),
    Definition(
        name="hysteresis", block="specimen", channel="force_n",
        units={"force_n": "N", "displacement_m": "m", "beta": "1", "exponent": "1"},
        build=_hysteresis, largest=0.8,
        fields=same(
            force_n="hysteresis_force", displacement_m="hysteresis_displacement",
            beta="hysteresis_beta", exponent="hysteresis_exponent",
        ),
    ),
    Definition(
        name="added_mass", block="specimen", channel="force_n", units={"mass_kg": "kg"},
        build=lambda size, scales, _: {"mass_kg": size * scales.stiffness / scales.omega**2},
        fields=same(mass_kg="inertia"), largest=0.5,
    ),
    Definition(
        name="gap", block="specimen", channel="force_n", units={"gap_m": "m"},
        build=lambda size, scales, _: {"gap_m": size * scales.displacement_rms},
        fields=same(gap_m="gap"), largest=1.0,
    ),
)  # fmt: skip

LOOP = (
    Definition(
        name="excitation_scale", block="excitation", channel="balance_n", units={"scale": "1"},
        build=lambda size, _, shape: {"scale": 1.0 + sign(shape[0]) * min(size, 0.6)}, largest=0.6,
    ),
    Definition(
        name="time_step_error", block="excitation", channel="balance_n", units={"ratio": "1"},
        build=lambda size, _, shape: {"ratio": 1.0 + size if sign(shape[0]) > 0.0 else 1.0 / (1.0 + size)},
        largest=1.0,
    ),
    Definition(
        name="integration_error", block="numerical", channel="balance_n",
        units={"scheme": "1", "step_s": "s", "newmark_gamma": "1"}, build=_integration_error, largest=0.5,
        fields=same(scheme="scheme", step_s="controller_step", newmark_gamma="newmark_gamma"),
    ),
)  # fmt: skip

"""Effects that no product is told about: an honest one says so, and where they act."""

from blind_campaigns.catalogue import (
    HERTZ,
    SLOWEST_S,
    Definition,
    Scales,
    between,
    between_decades,
    same,
    sign,
)
from blind_campaigns.system import Array


def _power_law(size: float, scales: Scales, shape: Array) -> dict[str, float]:
    exponent = between(0.3, 0.6, shape[0])
    coefficient = size * scales.force_rms / scales.velocity_rms**exponent
    return {"coefficient": coefficient, "exponent": exponent}


def _dropout(size: float, _scales: Scales, shape: Array) -> dict[str, float]:
    hold = between_decades(0.02, 0.2, shape[0])
    return {"hold_s": hold, "rate_per_s": size / hold, "seed": float(int(shape[1] * 2**30))}


OUTSIDE = (
    Definition(
        name="amplitude_dependent_delay", block="actuator", channel="measured_m", in_library=False,
        units={"delay_s_per_m": "s/m", "envelope_time_s": "s"}, largest=2.0,
        build=lambda size, scales, shape: {
            "delay_s_per_m": min(size / scales.omega, SLOWEST_S) / scales.displacement_peak,
            "envelope_time_s": between(0.5, 2.0, shape[0]),
        },
        fields=same(delay_s_per_m="delay_per_m", envelope_time_s="envelope_time"),
    ),
    Definition(
        name="position_dependent_gain", block="actuator", channel="measured_m", in_library=False,
        units={"gain_per_m": "1/m"}, largest=0.4,
        build=lambda size, scales, shape: {"gain_per_m": sign(shape[0]) * size / scales.displacement_peak},
        fields=same(gain_per_m="gain_per_m"),
    ),
    Definition(
        name="gain_drift", block="actuator", channel="measured_m", in_library=False,
        units={"gain_rate_per_s": "1/s"}, largest=0.8,
        build=lambda size, scales, shape: {"gain_rate_per_s": sign(shape[0]) * size / scales.duration},
        fields=same(gain_rate_per_s="gain_rate"),
    ),
    Definition(
        name="nonlinear_sensor_scale", block="sensor", channel="measured_m", in_library=False,
        units={"per_m2": "1/m²"}, largest=0.5,
        build=lambda size, scales, shape: {"per_m2": sign(shape[0]) * size / scales.displacement_peak**2},
    ),
    Definition(
        name="intermittent_dropout", block="sensor", channel="measured_m", in_library=False,
        units={"hold_s": "s", "rate_per_s": "1/s", "seed": "1"}, largest=0.3, build=_dropout,
    ),
    Definition(
        name="stiffness_degradation", block="specimen", channel="force_n", in_library=False,
        units={"rate_per_s": "1/s"}, largest=0.8,
        build=lambda size, scales, _: {"rate_per_s": size / scales.duration},
        fields=same(rate_per_s="degradation_rate"),
    ),
    Definition(
        name="one_sided_spring", block="specimen", channel="force_n", in_library=False,
        units={"stiffness_n_per_m": "N/m", "start_m": "m"}, largest=2.0,
        build=lambda size, scales, shape: {
            "stiffness_n_per_m": size * scales.stiffness,
            "start_m": between(0.0, 1.0, shape[0]) * scales.displacement_rms,
        },
        fields=same(stiffness_n_per_m="one_sided_stiffness", start_m="one_sided_start"),
    ),
    Definition(
        name="displacement_dependent_damping", block="specimen", channel="force_n", in_library=False,
        units={"damping_n_s_per_m3": "N·s/m³"}, largest=2.0,
        build=lambda size, scales, _: {
            "damping_n_s_per_m3": size * scales.viscosity / scales.displacement_rms**2
        },
        fields=same(damping_n_s_per_m3="damping_per_m2"),
    ),
    Definition(
        name="one_way_damping", block="specimen", channel="force_n", in_library=False,
        units={"damping_n_s_per_m": "N·s/m"}, largest=1.0,
        build=lambda size, scales, _: {"damping_n_s_per_m": size * scales.viscosity},
        fields=same(damping_n_s_per_m="one_way_damping"),
    ),
    Definition(
        name="power_law_damping", block="specimen", channel="force_n", in_library=False,
        units={"coefficient": "N·(s/m)ⁿ", "exponent": "1"}, largest=0.8, build=_power_law,
        fields=same(coefficient="power_coefficient", exponent="power_exponent"),
    ),
    Definition(
        name="viscoelastic_branch", block="specimen", channel="force_n", in_library=False,
        units={"stiffness_n_per_m": "N/m", "time_s": "s"}, largest=1.0,
        build=lambda size, scales, shape: {
            "stiffness_n_per_m": size * scales.stiffness,
            "time_s": between_decades(0.4, 2.5, shape[0]) / scales.omega,
        },
        fields=same(stiffness_n_per_m="branch_stiffness", time_s="branch_time"),
    ),
    Definition(
        name="slip_lock", block="specimen", channel="force_n", in_library=False,
        units={"ratio": "1"}, largest=0.5, build=lambda size, _scales, _shape: {"ratio": size},
        fields=same(ratio="slip_ratio"),
    ),
    Definition(
        name="periodic_disturbance", block="specimen", channel="force_n", in_library=False,
        units={"force_n": "N", "frequency_hz": "Hz", "phase_rad": "rad"}, largest=0.8,
        build=lambda size, scales, shape: {
            "force_n": 1.4 * size * scales.force_rms,
            "frequency_hz": between_decades(2.0, 20.0, shape[0]),
            "phase_rad": HERTZ * shape[1],
        },
        fields={
            "force_n": ("disturbance_force", 1.0),
            "frequency_hz": ("disturbance_omega", HERTZ),
            "phase_rad": ("disturbance_phase", 1.0),
        },
    ),
)  # fmt: skip

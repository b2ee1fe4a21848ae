"""Tracking controllers of the multi-axial benchmark, all set up for the nominal plant.

Each is a linear filter from the targets of both actuators to the commands sent, in discrete time. LQG feeds
the readings back, too. RoDeAC (Fermandois and co-workers 2024) learns the coefficients of its filter while
the test runs.
"""

import json
import math
from dataclasses import dataclass
from typing import Final

import numpy as np
import scipy

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.shipped import shipped

from .plant import nominal_plant
from .structure import RATE

CONTROLLERS: Final = ("none", "decoupling", "feedforward", "lqg", "rodeac")
"""Names of the controllers of the study."""

PERFECT: Final = "perfect"
"""Name of actuators that move as they are told, for the floor of the criteria."""

_QUICK: Final = 2.0 * math.pi * 120.0  # rad/s, of the low-pass that makes an inverse realisable
_HIGHEST: Final = 12.0  # Hz up to which the feedforward undoes an actuator
_RIDGE: Final = 3e-4  # of the squares of its coefficients beside those of its errors
_EFFORT: Final = 0.3  # LQG, weight ρ of the feedback's commands beside that of the errors
_SENSOR: Final = 0.0124  # mm, noise of the displacement sensors
_UNMODELLED: Final = 0.01  # mm a step, noise of the commands
_DRIFT: Final = 0.03  # mm a step, by which the input drifts
_REMAINS: Final = 0.999  # of the drift from step to step
_CORNER: Final = 20.0  # Hz, of the filters before the parameters of RoDeAC are learned
_TAPS: Final = 4


@dataclass(frozen=True, kw_only=True, eq=False)
class Controller:
    """A filter w₊ = A w + B r + E y, u = C w + D r of targets r and readings y [mm], and what is learned."""

    name: str
    dynamics: Array  # A, B, C, D and E, shapes (n, n), (n, 2), (2, n), (2, 2) and (n, 2)
    targets: Array
    states: Array
    direct: Array
    readings: Array
    # Coefficients of the last targets of each actuator, and their covariance, shapes (2, 4) and (2, 4, 4);
    # empty where nothing is learned
    coefficients: Array
    covariance: Array


def find_controller(name: str) -> Controller:
    """Return the controller of a name, set up for the nominal plant."""
    if name == "rodeac":
        return _rodeac()
    systems = {
        "none": lambda: _linear(name, np.zeros((0, 0)), np.zeros((0, 2)), np.zeros((2, 0)), np.eye(2)),
        "decoupling": lambda: _decoupling(name),
        "feedforward": lambda: _feedforward(name),
        "lqg": lambda: _lqg(name),
    }
    if name not in systems:
        raise InputError(
            f"A controller of the multi-axial benchmark must be one of {', '.join(CONTROLLERS)}", value=name
        )
    return systems[name]()


def filter_coefficients() -> tuple[Array, Array]:
    """Coefficients of the fourth-order Butterworth low-pass that RoDeAC learns behind."""
    numerator, denominator = scipy.signal.butter(4, _CORNER, fs=RATE)
    return np.asarray(numerator), np.asarray(denominator)


def _linear(name: str, a: Array, b: Array, c: Array, d: Array, e: Array | None = None) -> Controller:
    none = np.zeros((0, _TAPS))
    return Controller(
        name=name,
        dynamics=np.ascontiguousarray(a),
        targets=np.ascontiguousarray(b),
        states=np.ascontiguousarray(c),
        direct=np.ascontiguousarray(d),
        readings=np.zeros_like(b) if e is None else np.ascontiguousarray(e),
        coefficients=none,
        covariance=np.zeros((0, _TAPS, _TAPS)),
    )


def _rodeac() -> Controller:
    content = json.loads(
        shipped("datasets", "marths_benchmark/RoDeAC_initial_parameters.json").read_text(encoding="utf-8")
    )
    linear = find_controller("none")
    return Controller(
        name="rodeac",
        dynamics=linear.dynamics,
        targets=linear.targets,
        states=linear.states,
        direct=linear.direct,
        readings=linear.readings,
        coefficients=np.array([np.ravel(content[f"theta0_{actuator}"]) for actuator in (1, 2)]),
        covariance=np.array([content[f"P0_{actuator}"] for actuator in (1, 2)]),
    )


def _decoupling(name: str) -> Controller:
    """Inverse of the nominal plant behind a low-pass of third order.

    With H = N diag(1/D₁, 1/D₂) the inverse is diag(D₁, D₂) adj(N)/det N.
    """
    plant = nominal_plant()
    (n11, n12), (n21, n22) = plant.numerators
    d1, d2 = plant.denominators
    zeros = np.concatenate([np.roots(np.polysub(np.polymul(n11, n22), np.polymul(n12, n21))), [-_QUICK] * 3])
    gain = _QUICK**3 / np.polysub(np.polymul(n11, n22), np.polymul(n12, n21))[0]
    entries = ((d1, n22, 1.0), (d1, n12, -1.0)), ((d2, n21, -1.0), (d2, n11, 1.0))
    sections = [
        (i, j, _sections(np.concatenate([np.roots(own), np.roots(n)]), zeros, sign * gain * own[0] * n[0]))
        for i, row in enumerate(entries)
        for j, (own, n, sign) in enumerate(row)
    ]
    a = scipy.linalg.block_diag(*(part[0] for _, _, part in sections))
    b = np.vstack([np.outer(part[1], np.eye(2)[j]) for _, j, part in sections])
    c = np.hstack([np.outer(np.eye(2)[i], part[2]) for i, _, part in sections])
    d = np.zeros((2, 2))
    for i, j, part in sections:
        d[i, j] = part[3]
    return _linear(name, a, b, c, d)


def _sections(zeros: Array, poles: Array, gain: float) -> tuple[Array, Array, Array, float]:
    """State of a filter of given zeros, poles [1/s] and gain, by the bilinear transform."""
    numerator, denominator = scipy.signal.zpk2tf(*scipy.signal.bilinear_zpk(zeros, poles, gain, RATE))
    a, b, c, d = scipy.signal.tf2ss(np.real(numerator), np.real(denominator))
    return a, b[:, 0], c[0], float(d[0, 0])


def _feedforward(name: str) -> Controller:
    """Four coefficients of the last targets of each actuator that undo its own gain, lag and delay.

    They are those of least squares, H(iω) Σ θ_k e^(−iωkh) ≈ 1 from 0.1 to 12 Hz, with the hold's half sample,
    and small: large ones would raise the noise, which the specimen feeds back.
    """
    frequency = np.linspace(0.1, _HIGHEST, 240)
    s = np.asarray(2j * np.pi * frequency, dtype=np.complex128)
    transfer = nominal_plant().transfer(s) * np.exp(-0.5 * s / RATE)[:, np.newaxis, np.newaxis]
    lags = np.exp(-np.outer(s, np.arange(_TAPS)) / RATE)
    rows = []
    for actuator in range(2):
        columns = transfer[:, actuator, actuator][:, np.newaxis] * lags
        small = np.sqrt(_RIDGE * s.size) * np.eye(_TAPS)
        stacked = np.vstack([columns.real, columns.imag, small])
        goal = np.concatenate([np.ones(s.size), np.zeros(s.size + _TAPS)])
        rows.append(np.linalg.lstsq(stacked, goal, rcond=None)[0])
    taps = np.array(rows, dtype=np.float64)
    shift = np.asarray(np.kron(np.eye(_TAPS - 1, k=-1), np.eye(2)), dtype=np.float64)
    entry = np.vstack([np.eye(2), np.zeros((2 * (_TAPS - 2), 2))])
    states = np.hstack([np.diag(taps[:, tap]) for tap in range(1, _TAPS)])
    return _linear(name, shift, entry, states, np.diag(taps[:, 0]))


def _lqg(name: str) -> Controller:
    """Feedforward of each actuator, and linear-quadratic-Gaussian feedback of what it leaves.

    The tracking error y − r is that of the nominal plant with an input that drifts (couplings, errors of the
    model), which a Kalman filter estimates with the states. It is cancelled, and the states are led back by
    the gain of least Σ |y − r|² + ρ|u|². The weights are ours, chosen on the nominal plant under El Centro;
    those of the benchmark's sample controller are not public.
    """
    ahead = _feedforward(name)
    a, b, c = nominal_plant().sampled(1.0 / RATE)
    order, commands = b.shape
    gain = _regulator(a, b, c.T @ c, _EFFORT * np.eye(commands))
    whole = np.block([[a, b], [np.zeros((commands, order)), _REMAINS * np.eye(commands)]])
    shown = np.hstack([c, np.zeros((2, commands))])
    driven = np.vstack([b, np.zeros((commands, commands))])
    process = np.zeros((order + commands, order + commands))
    process[:order, :order] = _UNMODELLED**2 * b @ b.T
    process[order:, order:] = _DRIFT**2 * np.eye(commands)
    observer = _regulator(whole.T, shown.T, process, _SENSOR**2 * np.eye(2)).T
    back = np.hstack([gain, np.eye(commands)])
    return _linear(
        name,
        scipy.linalg.block_diag(ahead.dynamics, whole - driven @ back - observer @ shown),
        np.vstack([ahead.targets, -observer]),
        np.hstack([ahead.states, -back]),
        ahead.direct,
        np.vstack([np.zeros_like(ahead.targets), observer]),
    )


def _regulator(a: Array, b: Array, errors: Array, efforts: Array) -> Array:
    """Gain of the linear-quadratic regulator in discrete time."""
    cost = scipy.linalg.solve_discrete_are(a, b, errors, efforts)
    return np.asarray(np.linalg.solve(efforts + b.T @ cost @ b, b.T @ cost @ a))

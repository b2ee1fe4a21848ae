"""Ours beside software that others wrote, on the same numbers: digits of agreement and ratio of time.

    python -m venv PEERS && PEERS/bin/pip install eqsig pyrotd reliability openturns
    python tests/benchmarks/peers.py --python PEERS/bin/python

Peers run in an interpreter of their own, which this script calls with `--peer`, since their needs may
contradict ours. A peer that is not installed is named and left out. Times are the shortest of five, without
starting the interpreter; both run on this machine one after the other. Delay solvers are compared by
engines.py.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from benchmark_script import shortest_time

PERIODS = np.geomspace(0.2, 4.0, 40)
DAMPING = 0.05
SHARE, ASSURANCE = 0.95, 0.9
REPETITIONS = 5


def measure_time(work: Callable[[], object]) -> tuple[np.ndarray, float]:
    """Answer of a piece of work, and its shortest time [s]."""
    answer, seconds = shortest_time(work, REPETITIONS, time.perf_counter)
    return np.asarray(answer, dtype=float), seconds


def eqsig(record, step, _values):
    from eqsig import sdof

    return measure_time(lambda: sdof.pseudo_response_spectra(record, step, PERIODS, DAMPING)[2])


def pyrotd(record, step, _values):
    import pyrotd as peer

    peer.processes = 1
    return measure_time(lambda: peer.calc_spec_accels(step, record, 1.0 / PERIODS, DAMPING).spec_accel)


def reliability(_record, _step, values):
    from reliability.Fitters import Fit_Lognormal_2P

    def fit_values():
        fit = Fit_Lognormal_2P(failures=values, show_probability_plot=False, print_results=False)
        return fit.mu, fit.sigma

    return measure_time(fit_values)


def openturns(_record, _step, values):
    import openturns as peer

    sample = peer.Sample(values[:, np.newaxis])

    def fit_values():
        # maximum likelihood with the location held at zero is that of a normal distribution of logarithms
        fit = peer.NormalFactory().buildAsNormal(peer.Sample(np.log(np.asarray(sample))))
        return fit.getMu()[0], fit.getSigma()[0] * np.sqrt((values.size - 1) / values.size)

    return measure_time(fit_values)


def openturns_tolerance(_record, _step, values):
    import openturns as peer

    root = np.sqrt(values.size)
    shift = peer.Normal().computeQuantile(SHARE)[0] * root
    return measure_time(
        lambda: [peer.NonCentralStudent(values.size - 1, shift).computeQuantile(ASSURANCE)[0] / root]
    )


def grid(_record, _step, values):
    """Posterior of mean and deviation on a grid under p(μ, σ) ∝ 1/σ: quantiles of a further value."""
    from scipy.special import ndtr

    logarithms = np.log(values)
    n, mean, spread = values.size, logarithms.mean(), logarithms.std()

    def quantiles():
        mu = mean + spread * np.linspace(-8.0, 8.0, 801)[:, np.newaxis] / np.sqrt(n)
        log_sigma = np.log(spread) + np.linspace(-8.0, 8.0, 801) / np.sqrt(2.0 * n)
        squares = n * (spread**2 + (mu - mean) ** 2)
        density = -n * log_sigma - 0.5 * squares * np.exp(-2.0 * log_sigma)
        weights = np.exp(density - density.max())
        weights /= weights.sum()
        places = mean + spread * np.linspace(-2.2, -1.2, 41)
        probabilities = [(weights * ndtr((place - mu) * np.exp(-log_sigma))).sum() for place in places]
        return [np.interp(1.0 - SHARE, probabilities, places)]

    return measure_time(quantiles)


PEERS = {
    "eqsig": ("samples", eqsig),
    "pyrotd": ("spectrum", pyrotd),
    "reliability": ("fit", reliability),
    "OpenTURNS": ("fit", openturns),
    "OpenTURNS, non-central t": ("tolerance", openturns_tolerance),
    "grid of 801 × 801": ("predictive", grid),
}
QUESTIONS = {
    "samples": "response spectrum from peaks at samples, 40 periods, 5 %",
    "spectrum": "response spectrum from peaks between samples, 40 periods, 5 %",
    "fit": "lognormal fit of 100 values",
    "tolerance": "factor of a 95 %/90 % tolerance bound",
    "predictive": "predictive 5 % quantile of a lognormal",
}


def ours(question, motion, values):
    """Our answer to a question, and its time."""
    from reliab_studies.synthetic_vs_real.comparison import response_spectra

    from reliab.criterion.distributions import Lognormal
    from reliab.criterion.methods.tolerance import tolerance_factor
    from reliab.sampling.normal_inverse_chi_squared import NormalInverseChiSquared
    from reliab.structures.frame import exact_step, follow_load

    def predictive():
        posterior = NormalInverseChiSquared.posterior(np.log(values))
        return [float(posterior.predictive_quantile(1.0 - SHARE))]

    def spectrum_at_samples():
        peaks = []
        for w in 2.0 * np.pi / PERIODS:
            dynamics = np.array([[0.0, 1.0], [-(w**2), -2.0 * DAMPING * w]])
            transition, early, late = exact_step(dynamics, np.array([[0.0], [-1.0]]), motion.time_step)
            history = follow_load(transition, early[:, 0].copy(), late[:, 0].copy(), motion.acceleration, 1)
            peaks.append(w**2 * np.abs(history[0]).max())
        return peaks

    answers = {
        "samples": spectrum_at_samples,
        "spectrum": lambda: response_spectra([motion], PERIODS).values[0],
        "fit": lambda: Lognormal.fit(values).parameters,
        "tolerance": lambda: [tolerance_factor(values.size, SHARE, ASSURANCE)],
        "predictive": predictive,
    }
    return measure_time(answers[question])


def ask(python: str, peer: str, data: Path) -> dict | None:
    """Answer of a peer; None where it is not installed or fails."""
    call = [python, __file__, "--peer", peer, "--data", str(data)]
    process = subprocess.run(call, capture_output=True, text=True, check=False)  # noqa: S603 - this very file
    if process.returncode != 0:
        reason = (process.stderr.strip().splitlines() or ["no message"])[-1]
        print(f"| {QUESTIONS[PEERS[peer][0]]} | {peer} | left out: {reason} | |")
        return None
    return json.loads(process.stdout.splitlines()[-1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--python", default=sys.executable, help="interpreter that has the peers")
    parser.add_argument("--peer", help="answer as this peer and end")
    parser.add_argument("--data", type=Path)
    options = parser.parse_args()
    if options.peer:
        with np.load(options.data) as data:
            answer, seconds = PEERS[options.peer][1](data["record"], float(data["step"]), data["values"])
        print(json.dumps({"answer": answer.tolist(), "seconds": seconds}))
        return
    from reliab.motions.loading import load_motions

    motion = load_motions("synthetic")[0]
    values = np.exp(np.random.default_rng(2017).normal(-3.0, 0.4, 100))
    print("| question | peer | digits that agree | our time over the peer's |\n|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder) / "data.npz"
        np.savez(data, record=motion.acceleration, step=motion.time_step, values=values)
        for peer, (question, _) in PEERS.items():
            peer_answer = ask(options.python, peer, data)
            if peer_answer is None:
                continue
            answer, seconds = ours(question, motion, values)
            difference = float(np.max(np.abs(np.asarray(peer_answer["answer"]) / answer - 1.0)))
            digits = -np.log10(max(difference, 1e-16))
            print(
                f"| {QUESTIONS[question]} | {peer} | {digits:.1f} | {seconds / peer_answer['seconds']:.3g} |"
            )


if __name__ == "__main__":
    main()

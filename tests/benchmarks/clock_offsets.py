"""Print what `diagnose` says of a force that was recorded earlier or later than the displacement.

`python tests/benchmarks/clock_offsets.py [--seed 0] [--snr 50]` simulates three tests of 8 s at 200 Hz of a
spring, of a spring with a damper and of a spring with dry friction, with noise on both channels, for
offsets of 1, 2, 4 and 8 ms in both directions, and prints verdict, names, offset and rivals.
"""

import numpy as np
from benchmark_script import argument_parser

from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.diagnose import diagnose
from reliab.discrepancy.result.diagnosis import Diagnosis
from reliab.structures.frame import Specimen

RATE, DURATION, STIFFNESS, PEAK = 200.0, 8.0, 4.0e4, 0.005
DAMPING_TIME = 0.012
"""Damping over stiffness of the damper [s]."""

OFFSETS = tuple(sign * size for sign in (-1.0, 1.0) for size in (0.001, 0.002, 0.004, 0.008))


def campaign_of(specimen: str, lag: float, seed: int, snr: float) -> Campaign:
    """Simulate the tests of a specimen; `lag` of the force [s], `snr` of both channels [dB]."""
    tests = []
    for k in range(3):
        random = np.random.default_rng([seed, k])
        time = np.arange(0.0, DURATION, 1.0 / RATE)
        turns = 2.0 * np.pi * random.uniform(0.5, 2.5, 6)[:, np.newaxis]
        phases = random.uniform(0.0, 7.0, 6)[:, np.newaxis]
        late = turns * (time - lag) + phases
        displacement, speed = PEAK * np.sin(late).sum(axis=0), PEAK * (turns * np.cos(late)).sum(axis=0)
        force = STIFFNESS * displacement
        if specimen == "damper":
            force += DAMPING_TIME * STIFFNESS * speed
        if specimen == "friction":
            force += 0.25 * STIFFNESS * displacement.std() * np.tanh(speed / 1e-4)
        exact = {Channel.MEASURED: PEAK * np.sin(turns * time + phases).sum(axis=0), Channel.FORCE: force}
        noise = 10.0 ** (-snr / 20.0)
        channels = {
            name: values + noise * values.std() * random.standard_normal(values.size)
            for name, values in exact.items()
        }
        tests.append(MeasuredTest(file=f"{k}.csv", motion="", held_out=k == 2, channels=channels))
    return Campaign(
        name=specimen,
        structure=None,
        mass=1.0,
        actuator=None,
        specimen=Specimen(stiffness=STIFFNESS),
        rate=RATE,
        tests=tuple(tests),
    )


def describe_diagnosis(diagnosis: Diagnosis) -> str:
    """Say verdict, names with probabilities and first values, and rivals."""
    names = []
    for effect in (*diagnosis.effects, *diagnosis.doubtful):
        first = effect.estimates[0]
        rivals = ", ".join(f"{r.name} {r.probability:.2f}" for r in effect.rivals if r.probability > 0.01)
        names.append(
            f"{effect.name} {effect.probability:.2f} ({first.value:.3g} ± {first.sd:.1g} {first.units}"
            f"{'; or ' + rivals if rivals else ''})"
        )
    unknown = (
        [] if diagnosis.unknown is None else [diagnosis.unknown.expression or diagnosis.unknown.description]
    )
    return f"{diagnosis.verdict}: {', '.join([*names, *unknown])}"


def main() -> None:
    parser = argument_parser(__doc__, seed=0)
    parser.add_argument("--snr", type=float, default=50.0, help="signal to noise [dB]")
    options = parser.parse_args()
    for specimen in ("spring", "damper", "friction"):
        for lag in (0.0, *OFFSETS):
            diagnosis = diagnose(campaign_of(specimen, lag, options.seed, options.snr))
            print(f"{specimen}, force {1e3 * lag:+.0f} ms: {describe_diagnosis(diagnosis)}", flush=True)


if __name__ == "__main__":
    main()

"""PySINDy beside ours on the same blind campaigns: how often each names the hidden effect.

python tests/benchmarks/pysindy_beside_ours.py CAMPAIGNS LABELS [--python PYTHON_WITH_PYSINDY]

PySINDy is no dependency of the project: it runs in another interpreter, which this script calls with
`--sindy`. It gets what suits it best: the specimen's block only, with its calibration done (stiffness and
offset within the same regression), the smoothed motion with its derivatives, and a library with one term for
every effect of the specimen that is linear in its parameters. Sequentially thresholded least squares then
names the terms that are left; its threshold is the largest that predicts training tests left out in turn
within 5 % of the best. Only campaigns with one such effect that exceeds the noise are asked.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

CALIBRATION = ("stiffness", "force_bias")
TERMS = (
    "viscous_damping",
    "quadratic_damping",
    "coulomb_friction",
    "cubic_stiffness",
    "quadratic_stiffness",
    "added_mass",
)
THRESHOLDS = (0.001, 0.003, 0.01, 0.03, 0.1, 0.3)
HIGHEST = 20.0
"""Cut-off of the smoothing filter [Hz]."""


def motion_and_force(folder, tests):
    """Smoothed motion and force of tests, from the CSV files alone."""
    from scipy.signal import butter, sosfiltfilt

    rate = _rate(folder)
    low_pass = butter(4, HIGHEST, fs=rate, output="sos")
    for test in tests:
        table = np.genfromtxt(folder / test, delimiter=",", names=True)
        names = table.dtype.names
        x = sosfiltfilt(low_pass, table["measured_m"])
        v = np.gradient(x, 1.0 / rate)
        a = np.gradient(v, 1.0 / rate)
        force = sosfiltfilt(low_pass, table["force_n"]) if "force_n" in names else None
        yield x, v, a, force


def _rate(folder):
    import tomllib

    return tomllib.loads((folder / "campaign.toml").read_text(encoding="utf-8"))["sampling"]["rate_hz"]


def _training(folder):
    import tomllib

    tests = tomllib.loads((folder / "campaign.toml").read_text(encoding="utf-8"))["tests"]
    return [test["file"] for test in tests if not test.get("held_out", False)]


def columns(x, v, a):
    """Stiffness and offset, then the terms of the effects in their order."""
    friction = np.tanh(v / (0.003 * np.abs(v).max()))
    return np.column_stack([x, np.ones_like(x), v, v * np.abs(v), friction, x**3, x**2, a])


def named_by_sindy(folder):
    """Effects that PySINDy's sequentially thresholded least squares leaves."""
    import pysindy

    data = list(motion_and_force(folder, _training(folder)))
    tables = [columns(*one[:3]) for one in data]
    forces = [one[3] for one in data]
    scale, size = np.concatenate(tables).std(axis=0), np.concatenate(forces).std()
    scale[len(CALIBRATION) - 1] = 1.0
    tables, forces = [table / scale for table in tables], [force / size for force in forces]

    def fitted(threshold, rows):
        optimizer = pysindy.STLSQ(threshold=threshold, alpha=0.0)
        optimizer.fit(
            np.concatenate([tables[k] for k in rows]), np.concatenate([forces[k] for k in rows])[:, None]
        )
        return np.asarray(optimizer.coef_).ravel()

    def error(threshold):
        left = []
        for out in range(len(tables)):
            found = fitted(threshold, [k for k in range(len(tables)) if k != out])
            left.append(np.mean((forces[out] - tables[out] @ found) ** 2))
        return np.mean(left)

    errors = [error(threshold) for threshold in THRESHOLDS]
    best = max(t for t, e in zip(THRESHOLDS, errors, strict=True) if e <= 1.05 * min(errors))
    found = fitted(best, range(len(tables)))[len(CALIBRATION) :]
    return sorted(name for name, value in zip(TERMS, found, strict=True) if value != 0.0)


def named_by_us(folder):
    """Effects that the diagnosis names, offsets aside."""
    from reliab.discrepancy.campaign.reading import read_campaign
    from reliab.discrepancy.diagnose import diagnose

    found = diagnose(read_campaign(folder))
    return sorted({effect.name for effect in found.effects} - {"force_bias", "sensor_bias"})


def asked(campaigns, labels):
    """Campaigns with one effect of the specimen that stands in PySINDy's library."""
    for path in sorted(labels.glob("*.json")):
        label = json.loads(path.read_text(encoding="utf-8"))
        names = [effect["name"] for effect in label["effects"]]
        loudness = label["effects"][0]["effect_to_noise_db"] if names else -99.0
        seen = label["observation"] in ("full", "measured_force", "specimen_only")
        if len(names) == 1 and names[0] in TERMS and seen and loudness >= 0.0:
            yield campaigns / label["campaign"], names[0], label["noise"]["kind"], loudness


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("campaigns", type=Path)
    parser.add_argument("labels", type=Path, nargs="?")
    parser.add_argument("--python", default=sys.executable)
    parser.add_argument("--sindy", action="store_true", help="print what PySINDy names in one campaign")
    given = parser.parse_args()
    if given.sindy:
        print(json.dumps(named_by_sindy(given.campaigns)))
        return
    right = {"PySINDy": 0, "ours": 0}
    count = 0
    for folder, truth, noise, loudness in asked(given.campaigns, given.labels):
        call = [given.python, __file__, str(folder), "--sindy"]
        output = subprocess.run(call, capture_output=True, text=True, check=True).stdout  # noqa: S603 - our own
        answers = {"PySINDy": json.loads(output.splitlines()[-1]), "ours": named_by_us(folder)}
        count += 1
        for name, answer in answers.items():
            right[name] += answer == [truth]
        print(f"{folder.name} {truth} {loudness:+.0f} dB {noise}: {answers}", flush=True)
    print(f"{count} campaigns; named right and alone: {right}")


if __name__ == "__main__":
    main()

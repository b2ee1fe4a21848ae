"""A ladder of independent fits beside the diagnosis of a specimen: which error is left on held-out tests.

python tests/benchmarks/ladder.py CAMPAIGN... [--table FILE.csv] [--without-answers] [--passive]

Each CAMPAIGN is a folder with a campaign.toml whose tests hold measured_m and force_n. The ladder shares
nothing with the product: it reads the files itself and fits the force by least squares, linear (stiffness,
damping, mass, offset) and with dry friction, a power of the velocity, a square and a cubic spring, a Bouc–Wen
element, a relaxing branch, and pairs of them. Numbers that enter linearly are solved for exactly, the others
by a bounded search from several starts. With `--passive` mass, dampers and elements that dissipate are not
negative, as in a specimen whose force has its sign right. The rung of the smallest error on the fitted
tests is the ladder's answer. `reliab diagnose CAMPAIGN --json -` is then asked for its own.

With PySINDy installed (`pip install pysindy`), a sparse regression of the force on polynomials of
displacement and velocity and on terms with corners stands beside the ladder, with the threshold of the
smallest error on the fitted tests.

The table has one row for each rung and one for the answer of the product: errors on fitted and on held-out
tests, RMS over that of the force.
"""

import csv
import importlib.util
import itertools
import json
import subprocess
import sys
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numba
import numpy as np
from benchmark_script import argument_parser
from scipy import optimize, signal

HIGHEST, LEAST_RATE = 20.0, 200.0  # Hz, of the filter that smooths the displacement, and after thinning
MOST_TRIALS = 25
FIELDS = ("campaign", "model", "fitted", "held_out")


@dataclass(frozen=True, kw_only=True)
class Cycles:
    """A test: motion and force at even steps, and the samples that are held out."""

    x: np.ndarray
    v: np.ndarray
    a: np.ndarray
    force: np.ndarray
    held_out: np.ndarray


@numba.njit(cache=True)
def bouc_wen(x, yielding, beta, gamma, exponent):
    """Hysteretic displacement over the one at which it yields, by midpoint steps, shape (n,)."""
    z, path = 0.0, np.zeros(x.size)
    for k in range(1, x.size):
        steps = int(abs(x[k] - x[k - 1]) / yielding * 10) + 1
        h = (x[k] - x[k - 1]) / steps / yielding
        for _ in range(steps):
            middle = z + 0.5 * h * (1.0 - abs(z) ** exponent * (beta * np.sign(h * z) + gamma))
            z += h * (1.0 - abs(middle) ** exponent * (beta * np.sign(h * middle) + gamma))
            z = min(max(z, -5.0), 5.0)
        path[k] = z
    return path


def hysteretic(p, x, _v, _step, length):
    """Bouc–Wen element that tends to ±1; β + γ = 1."""
    gamma = p[1]
    return [bouc_wen(x, length * np.exp(p[0]), 1.0 / (1.0 + gamma), gamma / (1.0 + gamma), np.exp(p[2]))]


def relaxing(p, x, _v, step, time):
    """Stretch of the spring of a Maxwell branch, a high-pass filter of the first order."""
    decay = np.exp(-step / (time * np.exp(p[0])))
    return [signal.lfilter([0.5 * (1.0 + decay), -0.5 * (1.0 + decay)], [1.0, -decay], x - x[0])]


@dataclass(frozen=True, kw_only=True)
class Rung:
    """Columns of a regression that depend on some numbers, where to start, and bounds."""

    columns: Callable
    starts: Sequence[Sequence[float]] = ((),)
    bounds: Sequence[tuple[float, float]] = ()
    elastic: bool = False  # Whether it only stores energy, so that its factors may have either sign
    count: int = 1  # How many columns it has


def rungs(length: float, speed: float) -> dict[str, Rung]:
    """Terms beside the linear ones, for the largest displacement [m] and speed [m/s]."""
    log = np.log
    return {
        "coulomb": Rung(
            columns=lambda p, _x, v, _step: [np.tanh(v / (speed * np.exp(p[0])))],
            starts=[[log(0.01)], [log(0.1)]],
            bounds=[(log(1e-3), log(2.0))],
        ),
        "power": Rung(
            columns=lambda p, _x, v, _step: [np.sign(v) * (np.abs(v) / speed) ** p[0]],
            starts=[[0.3], [1.6]],
            bounds=[(0.02, 4.0)],
        ),
        "cubic": Rung(
            columns=lambda _p, x, _v, _step: [(x / length) ** 2, (x / length) ** 3], elastic=True, count=2
        ),
        "bouc_wen": Rung(
            columns=lambda p, x, v, step: hysteretic(p, x, v, step, length),
            starts=[[log(0.05), 0.0, 0.5], [log(0.2), 0.0, 0.5], [log(0.6), 0.0, 0.5], [log(0.1), -0.7, 0.2]],
            bounds=[(log(1e-3), log(5.0)), (-0.98, 5.0), (-1.0, 2.3)],
        ),
        "relaxation": Rung(
            columns=lambda p, x, v, step: relaxing(p, x, v, step, length / speed),
            starts=[[0.0], [2.0]],
            bounds=[(-4.0, 5.0)],
        ),
    }


def read(folder: Path) -> tuple[list[Cycles], float]:
    """Read the tests of a campaign, and their step [s]; of a single test the last third is held out."""
    description = tomllib.loads((folder / "campaign.toml").read_text(encoding="utf-8"))
    rate, tests = description["sampling"]["rate_hz"], description["tests"]
    are_held_out = [test.get("held_out", False) for test in tests]
    if not any(are_held_out):
        are_held_out = [False] * (len(tests) - 1) + [len(tests) > 1]
    thinning = max(1, int(rate // LEAST_RATE))
    cycles = []
    for test, out in zip(tests, are_held_out, strict=True):
        table = np.genfromtxt(folder / test["file"], delimiter=",", names=True)
        x = table["measured_m"]
        if rate > 2.5 * HIGHEST:
            x = signal.sosfiltfilt(signal.butter(4, HIGHEST, fs=rate, output="sos"), x)
        v = np.gradient(x, 1.0 / rate)
        held_out = np.full(x.size, fill_value=out)
        if len(tests) == 1:
            held_out[2 * x.size // 3 :] = True
        rows = (x, v, np.gradient(v, 1.0 / rate), table["force_n"], held_out)
        x, v, a, force, held_out = (row[::thinning] for row in rows)
        cycles.append(Cycles(x=x, v=v, a=a, force=force, held_out=held_out))
    return cycles, thinning / rate


class Regression:
    """Least squares of the force on fitted samples, for some rungs of the ladder."""

    def __init__(
        self, tests: Sequence[Cycles], step: float, model: Sequence[Rung], *, passive: bool = False
    ) -> None:
        self.tests, self.step, self.chosen, self.passive = tests, step, model, passive
        self.force = np.concatenate([test.force for test in tests])
        self.out = np.concatenate([test.held_out for test in tests])

    def columns(self, p):
        """Columns of every test, one below the other, for the numbers that do not enter linearly."""
        sizes = [len(rung.bounds) for rung in self.chosen]
        parts = np.split(np.asarray(p, dtype=float), np.cumsum(sizes)[:-1]) if sizes else []
        blocks = []
        for test in self.tests:
            columns = [test.x, test.v, test.a, np.ones_like(test.x)]
            for rung, part in zip(self.chosen, parts, strict=True):
                columns += rung.columns(part, test.x, test.v, self.step)
            blocks.append(np.column_stack(columns))
        return np.concatenate(blocks)

    def residual(self, p):
        """What the best linear numbers leave of the force, fitted to what is not held out."""
        columns = self.columns(p)
        training = columns[~self.out]
        size = np.linalg.norm(training, axis=0) + 1e-300
        if self.passive:
            elastic = [
                False,
                False,
                False,
                True,
                *(rung.elastic for rung in self.chosen for _ in range(rung.count)),
            ]
            lower = np.where(elastic, -np.inf, 0.0)
            factors = (
                optimize.lsq_linear(training / size, self.force[~self.out], bounds=(lower, np.inf)).x / size
            )
        else:
            factors = np.linalg.lstsq(training / size, self.force[~self.out], rcond=1e-10)[0] / size
        return self.force - columns @ factors

    def solve(self, starts):
        """Numbers of the smallest error on fitted samples."""
        bounds = np.array([bound for rung in self.chosen for bound in rung.bounds]).T
        if not bounds.size:
            return np.zeros(0)
        solutions = [
            optimize.least_squares(
                lambda p: self.residual(p)[~self.out],
                np.clip(start, bounds[0] + 1e-9, bounds[1] - 1e-9),
                bounds=(bounds[0], bounds[1]),
                diff_step=1e-3,
                max_nfev=MOST_TRIALS,
            )
            for start in starts
        ]
        return min(solutions, key=lambda solution: solution.cost).x

    def errors(self, p):
        """Error on fitted and on held-out samples, RMS over that of the force."""
        residual = self.residual(p)
        return [
            float(np.linalg.norm(residual[part]) / np.linalg.norm(self.force[part]))
            for part in (~self.out, self.out)
        ]


def regress_sparsely(tests: Sequence[Cycles], length: float, speed: float) -> tuple[float, float]:
    """Errors on fitted and on held-out samples of a force that few of many terms make up, by PySINDy."""
    from pysindy import STLSQ, PolynomialLibrary

    blocks = []
    for test in tests:
        x, v = test.x / length, test.v / speed
        polynomials = np.asarray(PolynomialLibrary(degree=3).fit_transform(np.column_stack([x, v])))
        corners = [abs(x), x * abs(x), abs(v), v * abs(v), np.sign(v), np.tanh(20.0 * v), abs(x) * v]
        blocks.append(np.column_stack([polynomials, *corners, x * abs(v), test.a / np.abs(test.a).max()]))
    columns, force, out = (
        np.concatenate(parts)
        for parts in (blocks, [test.force for test in tests], [test.held_out for test in tests])
    )
    errors = []
    for threshold in (1e-3, 1e-2, 3e-2, 1e-1):
        regression = STLSQ(threshold=threshold, alpha=1e-6)
        regression.fit(columns[~out], force[~out, np.newaxis] / np.abs(force).max())
        residual = force - columns @ regression.coef_.ravel() * np.abs(force).max()
        errors.append([float(np.linalg.norm(residual[p]) / np.linalg.norm(force[p])) for p in (~out, out)])
    return tuple(min(errors))


def climb(folder: Path, *, passive: bool = False) -> list[dict[str, object]]:
    """Fit every rung, and pairs of them from where each came to rest."""
    tests, step = read(folder)
    length = max(float(np.abs(test.x[~test.held_out]).max(initial=0.0)) for test in tests)
    speed = max(float(np.quantile(np.abs(test.v), 0.999)) for test in tests if not test.held_out.all())
    rungs_by_name, solutions, rows = rungs(length, speed), {}, []
    names = [(), *((name,) for name in rungs_by_name), *itertools.combinations(rungs_by_name, 2)]
    for model in names:
        regression = Regression(tests, step, [rungs_by_name[name] for name in model], passive=passive)
        starts = list(itertools.product(*(rungs_by_name[name].starts for name in model)))
        if len(model) > 1:
            starts = [[solutions[name] for name in model], *starts[:1]]
        p = regression.solve([[number for part in start for number in part] for start in starts])
        if len(model) == 1:
            solutions[model[0]] = p
        here, there = regression.errors(p)
        rows.append(
            {
                "campaign": folder.name,
                "model": " + ".join(model) or "linear",
                "fitted": here,
                "held_out": there,
            }
        )
    if importlib.util.find_spec("pysindy"):
        here, there = regress_sparsely(tests, length, speed)
        rows.append({"campaign": folder.name, "model": "PySINDy", "fitted": here, "held_out": there})
    return rows


def answer(folder: Path) -> dict[str, object]:
    """Ask the product, in a process of its own."""
    command = [sys.executable, "-m", "reliab", "diagnose", str(folder), "--json", "-"]
    process = subprocess.run(command, check=True, capture_output=True, text=True)  # noqa: S603 - our own
    content = json.loads(process.stdout)
    block = next(block for block in content["blocks"] if block["block"] == "specimen")
    best = next(row for row in block["candidates"] if row["believed"])
    return {
        "campaign": folder.name,
        "model": f"reliab, {content['verdict']}: {' + '.join(block['effects']) or 'nothing'}",
        "fitted": best["left_out_nrmse"],
        "held_out": block["gap"]["nrmse_after"],
    }


def main() -> None:
    parser = argument_parser(__doc__, table=Path, without_answers=False, passive=False)
    parser.add_argument("campaigns", type=Path, nargs="+")
    options = parser.parse_args()
    rows = []
    for folder in options.campaigns:
        rows_of_campaign = climb(folder, passive=options.passive)
        rungs_climbed = [row for row in rows_of_campaign if row["model"] != "PySINDy"]
        best = min(rungs_climbed, key=lambda row: row["fitted"])
        print(f"{folder.name}: ladder {best['held_out']:.4f} ({best['model']})", flush=True)
        for row in rows_of_campaign[len(rungs_climbed) :]:
            print(f"  PySINDy {row['held_out']:.4f}", flush=True)
        rows += rows_of_campaign
        if not options.without_answers:
            rows.append(answer(folder))
            ratio = rows[-1]["held_out"] / best["held_out"]
            print(f"  {rows[-1]['model']} {rows[-1]['held_out']:.4f}, {ratio:.2f} times that", flush=True)
    if options.table:
        with options.table.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, FIELDS)
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    main()

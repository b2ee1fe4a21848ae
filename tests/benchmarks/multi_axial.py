"""Errors of uncertain runs of the multi-axial benchmark, rebuilt from sensors with a stated noise.

    python tests/benchmarks/multi_axial.py RECORDS --seed S --plants N [--ordinary] [--table FILE.csv]

The benchmark's own noise, which both sensors share, is 27 to 38 dB below x and absent in θ. Here runs have
none; each sensor's is added afterwards, independent, so many decibels below the RMS of its displacement. Each
plant meets one record with every controller. Printed by controller and displacement: rebuilt over true RMS^R,
how often it is within 2 %, how often the 90 % interval holds the true error, the largest deviation without
noise, of its RMS. The rows of a plant are added to the table as soon as they are known, and plants that stand
there already are not run again.
"""

from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import paths  # noqa: F401 - makes the laboratory importable
from benchmark_script import argument_parser
from rebuilt_error.laboratory import read_at2

from reliab.study.description import PACKAGE

controllers, loop, plants, outcomes, structure = (
    import_module(f"{PACKAGE}.marths_benchmark.{name}")
    for name in ("controllers", "loop", "plant", "outcomes", "structure")
)

LONGEST = 40.0  # s
THRESHOLD = 0.05
LOSS_OF_CONTROL = 10.0  # times the motion with perfect actuators
DRAWS, FEW_DRAWS = 64, 2


def judge_plant(
    plant: Any, ground: np.ndarray, decibels: float, rng: np.random.Generator, *, ordinary: bool
) -> Iterator[dict[str, object]]:
    """Judge a run with every controller."""
    perfect = loop.run_perfect(ground)
    ideal = structure.to_node(perfect.target)
    for name in controllers.CONTROLLERS:
        run = loop.run_test(ground, plant, controllers.find_controller(name), seed=None)
        if not (np.abs(run.true) < LOSS_OF_CONTROL * np.abs(perfect.target).max(axis=1, keepdims=True)).all():
            continue
        error_history = structure.to_node(run.true) - ideal
        true = np.sqrt(np.mean(error_history**2, axis=1)) / np.abs(ideal).max(axis=1)
        white = rng.standard_normal(run.true.shape) * run.true.std(axis=1, keepdims=True)
        noisy = outcomes.rebuilt_error(
            run.target, run.true + 10.0 ** (-decibels / 20.0) * white, DRAWS, ordinary=ordinary
        )
        clean = outcomes.rebuilt_error(run.target, run.true, FEW_DRAWS)
        for degree, exact, error in zip(noisy.displacements, clean.displacements, true, strict=True):
            yield {
                "plant": plant.name,
                "controller": name,
                "displacement": degree.name,
                "true": error,
                "ratio": degree.rms.value / error,
                "near": abs(degree.rms.value / error - 1.0) < 0.02,
                "width": (degree.rms.high - degree.rms.low) / error,
                "held": degree.rms.low <= error <= degree.rms.high,
                "without_noise": abs(exact.rms.value / error - 1.0),
                "false_safe": error > THRESHOLD and degree.probability(THRESHOLD) > 0.95,
                "judged": degree.judged,
            }


def main() -> None:
    options = argument_parser(
        __doc__, "folder", seed=int, plants=10, decibels=40.0, ordinary=False, table=Path
    ).parse_args()
    records = sorted(options.folder.rglob("*.AT2"))
    has_table = options.table is not None and options.table.exists()
    tables = [pd.read_csv(options.table, dtype={"plant": str})] if has_table else []
    plants_done = set(tables[0]["plant"]) if has_table else set()
    for number, plant in enumerate(plants.draw_plants(options.plants, options.seed)):
        if plant.name in plants_done:
            continue
        rng = np.random.default_rng([options.seed, number])
        ground = (
            structure.SCALE
            * read_at2(records[rng.integers(len(records))], structure.RATE)[: int(LONGEST * structure.RATE)]
        )
        tables.append(
            pd.DataFrame(judge_plant(plant, ground, options.decibels, rng, ordinary=options.ordinary))
        )
        if options.table is not None:
            tables[-1].to_csv(options.table, mode="a", index=False, header=not options.table.exists())
    table = pd.concat(tables)
    table = table[table["judged"]]
    columns = {
        "true": "median",
        "ratio": "median",
        "near": "mean",
        "width": "median",
        "held": "mean",
        "without_noise": "max",
        "false_safe": "sum",
    }
    groups = table.groupby(["controller", "displacement"], sort=False)
    print(groups.agg(columns).assign(errors=groups.size()).to_string(float_format="{:.4g}".format))
    print(
        f"{len(table)} errors: within 2 % {table['near'].mean():.1%}, held {table['held'].mean():.1%}, "
        f"false-safe {table['false_safe'].sum()}"
    )


if __name__ == "__main__":
    main()

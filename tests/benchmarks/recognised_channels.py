"""How many columns of laboratories' files are recognised: `python tests/benchmarks/recognised_channels.py`.

Files are made of names in which laboratories keep their channels (OpenFresco's controllers, MTS stations,
dSPACE and LabVIEW programs, theses and data papers), in random order, units, scale and delimiter, beside
channels that belong to nothing. Two thirds of the names were at hand while the vocabulary was written; the
last third is held out, by a checksum of the name. Printed are the columns with the right part and factor, the
files about which the user is asked, and those that are silently wrong. `--names countries` takes whole
headers of laboratories of eight countries (`channel_names/`), each in the language that is spoken there.
"""

import argparse
import json
import tempfile
import tomllib
import zlib
from collections import Counter
from pathlib import Path
from random import Random

import numpy as np
from benchmark_script import argument_parser

from reliab.core.errors import InputError
from reliab.recordings.reading import read_recording

NAMES = tomllib.loads((Path(__file__).parent / "channel_names/names.toml").read_text(encoding="utf-8"))
_LISTS = ("at_hand", "held_out", "all", "laboratories", "countries", "countries_held_out")
_BARE = 0.2  # share of files without units
_LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254, "inch": 0.0254, "Millimeters": 1e-3}
_FORCES = {"N": 1.0, "kN": 1e3, "kip": 4448.2216152605, "lbf": 4.4482216152605}
_FACTORS = {
    **_LENGTHS,
    **_FORCES,
    **dict.fromkeys(("s", "sec", "sn", "秒"), 1.0),
    **dict.fromkeys(("m/s2", "m/s^2"), 1.0),
    "gal": 1e-2,
    "cm/s2": 1e-2,
    "mm/s2": 1e-3,
    "g": 9.80665,
    "G": 9.80665,
    "tf": 9806.65,
    "kips": _FORCES["kip"],
}
_PARTS = {"t": "time", "c": "command", "m": "measured", "f": "force", "g": "ground acceleration"}


def main() -> None:
    parser = argument_parser(__doc__, files=200, seed=1, show=False)
    parser.add_argument("--names", choices=_LISTS, default="held_out")
    options = parser.parse_args()
    counts, random = Counter(), Random(options.seed)  # noqa: S311
    options.headers = _headers(options.names)
    with tempfile.TemporaryDirectory() as folder:
        for number in range(options.files):
            _evaluate(random, Path(folder) / f"{number}.csv", options, counts)
    columns = counts["right"] + counts["wrong"] + counts["asked"] + counts["missed"]
    print(json.dumps({**counts, "columns": columns, "right_share": counts["right"] / columns}))


def is_held_out(name: str) -> bool:
    return zlib.crc32(name.lower().encode()) % 3 == 0


def _draw_name(random: Random, part: str, names: str) -> str:
    source = "laboratories" if names == "laboratories" and part != "time" else "author"
    names = "all" if part == "time" else names
    choices = [" ".join(name.split()) for name in NAMES[source][part].split(";")]
    choices_of_list = [
        name
        for name in choices
        if names in {"all", "laboratories"} or is_held_out(name) is (names == "held_out")
    ]
    return random.choice(choices_of_list)


def _headers(names: str) -> list[list[tuple[str, str, str]]]:
    """Whole headers of a list, each of names with unit and role; none for lists of single names."""
    path = Path(__file__).parent / "channel_names" / f"{names}.txt"
    lines = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
    return [
        [tuple(part.strip() for part in column.split("|")) for column in line.partition(":")[2].split(";")]
        for line in lines
        if line and not line.startswith("#")
    ]


def _evaluate(random: Random, path: Path, options: argparse.Namespace, counts: Counter) -> None:
    truth = (
        _write_header(random, path, random.choice(options.headers))
        if options.headers
        else _write(random, path, options.names)
    )
    try:
        channels = {channel.part.value: channel for channel in read_recording(path).channels}
    except InputError as error:
        counts["asked"] += len(truth)
        counts["files_asked"] += 1
        if options.show:
            print("ASKED", path.read_text(encoding="utf-8").splitlines()[:2], str(error)[:260])
        return
    wrong = 0
    for part, (name, factor) in truth.items():
        channel = channels.get(part)
        if channel is None:
            counts["missed"] += 1
        elif channel.column == name and np.isclose(channel.factor, factor, rtol=1e-6):
            counts["right"] += 1
            continue
        else:
            counts["wrong"] += 1
            wrong += 1
        if options.show:
            print(part, repr(name), factor, channel, path.read_text(encoding="utf-8").splitlines()[:2])
    asked_parts = (
        {"force", "ground acceleration"} if options.headers else {"force"}
    )  # a table accelerates, too
    for part in asked_parts & set(channels) - set(truth):
        wrong += 1
        if options.show:
            print("NOT ONE", part, channels[part], path.read_text(encoding="utf-8").splitlines()[:2])
    counts["files_silently_wrong"] += bool(wrong)


def _write(random: Random, path: Path, names: str) -> dict[str, tuple[str, float]]:
    """Write a file; which column is which, and its factor to SI units."""
    noise, time, command, measured, force = _motion(random)
    length, strength = random.choice(list(_LENGTHS)), random.choice(list(_FORCES))
    columns: dict[str, tuple[str, np.ndarray]] = {}
    truth: dict[str, tuple[str, float]] = {}
    for part, values, unit, factor in (
        ("time", time, "s", 1.0),
        ("command", command, length, _LENGTHS[length]),
        ("measured", measured, length, _LENGTHS[length]),
        ("force", force, strength, _FORCES[strength]),
    ):
        if part == "force" and random.random() < 0.3:
            continue
        name = _draw_name(random, part, names)
        while name in columns:
            name = _draw_name(random, part, names)
        columns[name] = (unit, values / factor)
        truth[part] = (name, factor)
    if random.random() < _BARE:  # which then is metres and newtons, as far as anyone can tell
        columns = {
            name: ("", values * truth[part][1])
            for part, (name, _) in truth.items()
            for values in [columns[name][1]]
        }
        truth = {part: (name, 1.0) for part, (name, _) in truth.items()}
    sources = ("author", "laboratories") if names == "laboratories" else ("author",)
    distractors = [pair for source in sources for pair in NAMES["others"][source]]
    for name, unit in random.sample(distractors, random.randrange(4)):
        columns[name] = (unit, _other_channel(name, time, command, measured, force, noise))
    heads = _save(random, path, columns)
    return {part: (heads[name], factor) for part, (name, factor) in truth.items()}


def _write_header(random: Random, path: Path, header) -> dict[str, tuple[str, float]]:
    """Write a file with the channels of a header; a fifth of them without units, a third in other ones."""
    noise, time, command, measured, force = _motion(random)
    manner = random.choices(("as written", "other", "bare"), (0.5, 0.3, 0.2))[0]
    bare = manner == "bare" and all("=" not in unit for _, unit, role in header if role != "o")
    swaps = dict(
        zip(("mm", "kN"), (random.choice(list(_LENGTHS)), random.choice(list(_FORCES))), strict=True)
    )
    ground = np.convolve(noise.normal(size=time.size), np.ones(5) / 5.0, "same")
    motion = {"t": time, "c": command, "m": measured, "f": force, "g": ground}
    columns: dict[str, tuple[str, np.ndarray]] = {}
    truth: dict[str, tuple[str, float]] = {}
    for name, unit_in_header, role in header:
        unit = (
            "" if bare else swaps.get(unit_in_header, unit_in_header) if manner == "other" else unit_in_header
        )
        if role not in motion:
            accelerates = "acc" in name.lower() and role == "a"
            columns[name] = (
                unit,
                np.gradient(np.gradient(measured))
                if accelerates
                else _other_of_unit(unit, time, command, measured, noise),
            )
            continue
        factor = _FACTORS[unit.removeprefix("=")] if unit else 1.0
        columns[name] = ("" if unit.startswith("=") else unit, motion[role] / factor)
        truth[_PARTS[role]] = (name, factor)
    heads = _save(random, path, columns)
    return {part: (heads[name], factor) for part, (name, factor) in truth.items()}


def _other_of_unit(unit, time, command, measured, noise):
    """What stands beside the channels of a test: an error, a second displacement, a valve, anything else."""
    if unit in {"mm", "in", "m"}:
        return 1e3 * (command - measured) if noise.random() < 0.5 else 700.0 * np.roll(measured, 7)
    return 50.0 * np.gradient(command) if unit in {"V", "mA", "%"} else noise.normal(size=time.size)


def _save(random: Random, path: Path, columns) -> dict[str, str]:
    """Write the columns in random order; the head of each."""
    order = list(columns)
    random.shuffle(order)
    style = random.choice(("brackets", "square", "line"))
    header = {"brackets": "{} ({})", "square": "{} [{}]", "line": "{}"}[style]
    heads = {name: header.format(name, columns[name][0]) if columns[name][0] else name for name in order}
    separator = random.choice((",", ";", "\t"))
    lines = [separator.join(heads[name] for name in order)]
    if style == "line":
        lines.append(separator.join(columns[name][0] for name in order))
    rows = np.column_stack([columns[name][1] for name in order])
    lines += [separator.join(f"{value:.9g}" for value in row) for row in rows]
    path.write_text("\n".join(lines), encoding="utf-8")
    return heads


def _motion(random: Random):
    noise = np.random.default_rng(random.randrange(1 << 30))
    rate, size = random.choice((100.0, 256.0, 512.0, 1024.0)), 3000
    time = np.arange(size) / rate
    frequencies = [random.uniform(0.3, 3.0) for _ in range(4)]
    phases = [random.uniform(0.0, 6.0) for _ in range(4)]

    def motion_at(instants):
        return sum(
            0.01 * np.sin(2.0 * np.pi * f * instants + p) / f
            for f, p in zip(frequencies, phases, strict=True)
        )

    delay = random.uniform(-0.002, 0.02)
    command, measured = motion_at(time), random.uniform(0.96, 1.02) * motion_at(time - delay)
    measured = measured + 1e-5 * noise.normal(size=size)
    force = 1e5 * measured + 20.0 * noise.normal(size=size)
    return noise, time, command, measured, force


def _other_channel(name, time, command, measured, force, noise):
    drift = np.gradient(command)
    channels_by_name = {
        "Axial Disp Error": 1e3 * (command - measured),
        "Tracking error": 1e3 * (command - measured),
        "Servovalve command": 50.0 * drift,
        "Voltage command": 400.0 * command,
        "Valve output": 45.0 * drift,
        "Actuator velocity": 1e3 * np.gradient(measured),
        "Force command": 1e-3 * force,
        "Spool position": 48.0 * drift,
        "Compensated command": 1e3 * (command + 2.0 * drift),
        "Predicted displacement": 1e3 * (command + drift),
        "Frame drift": 700.0 * np.roll(measured, 5),
        "Table displacement": 20.0 * np.sin(0.003 * np.arange(time.size) ** 1.1),
        "Counter": np.arange(time.size),
        "state": np.ones(time.size),
    }
    return channels_by_name.get(name, noise.normal(size=time.size))


if __name__ == "__main__":
    main()

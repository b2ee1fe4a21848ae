"""Sound files of every kind that is read, written by code: the seeds that are damaged.

A case is a folder as a mapping from path to content. Every function writes the seeds of one kind; no real
record is among them.
"""

import io
import json
import pickle
import tempfile
from functools import cache
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import xarray as xr
from motions.conftest import AT2, RECORDS
from normal_values import NormalValues
from recordings.layouts import LAYOUTS, record
from scipy.io import netcdf_file, savemat

from reliab.criterion.derivation import derive_criterion, published_criterion
from reliab.effects.registry import find_effect
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite
from reliab.sampling.ensembles import Ensembles, draw
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel, write_model
from reliab.structures.frame import Specimen
from reliab.structures.structure import Structure
from reliab.sweep.ellipse_dataset import write_ellipses
from reliab.sweep.request import ScaledGrid, SweepRequest
from reliab.sweep.run import run_sweep

Case = dict[str, bytes]

ROOT = Path(__file__).resolve().parents[2]
RATE = 128
CANARY = "opened_by_pickle"


def read_back(folder: Path) -> Case:
    """All files below a folder."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


@cache
def motions() -> list[Case]:
    return [
        {name: text.encode(encoding)} for name, text in RECORDS.items() for encoding in ("utf-8", "utf-16")
    ]


@cache
def catalogue() -> list[Case]:
    table = "motion,file,dt_s,units,channel,header_npts\nA/90,a.AT2,0.005,g,,7\n"
    return [{"catalog.csv": table.encode(), "a.AT2": AT2.encode()}]


@cache
def test_histories() -> pd.DataFrame:
    """Six seconds of a test of a structure of 1 Hz with a delay of 4 ms."""
    time = np.arange(6 * RATE) / RATE
    random = np.random.default_rng(17)

    def command(instants):
        return 0.01 * np.sin(2.0 * np.pi * instants) * np.sin(np.pi * np.clip(instants, 0.0, 6.0) / 6.0) ** 2

    measured = command(time - 0.004) + 1e-6 * random.normal(size=time.size)
    return pd.DataFrame({"time_s": time, "command_m": command(time), "measured_m": measured})


@cache
def tests() -> list[Case]:
    table = test_histories()
    columns = {name: table[name].to_numpy() for name in table}
    text = table.to_csv(index=False)
    german = table.to_csv(index=False, sep=";", decimal=",")
    matlab = io.BytesIO()
    savemat(matlab, {"test": columns, "rate": float(RATE)}, do_compression=True)
    return [
        {"test.csv": text.encode()},
        {"test.csv": f"# rate = {RATE}\n{german}".encode()},
        {"test.csv": text.encode("utf-16")},
        {"test.csv": matlab.getvalue()},
        {"test.csv": _hdf5(columns)},
        {"test.csv": _classic_netcdf(columns)},
        {"test.csv": pickle.dumps(_Canary())},
    ]


@cache
def recordings() -> list[Case]:
    """Files of laboratories in all layouts."""
    cases = []
    for write in LAYOUTS:
        with tempfile.TemporaryDirectory() as folder:
            write(Path(folder))
            cases += [{"test": content} for content in read_back(Path(folder)).values()][-1:]
    return cases


@cache
def records() -> list[Case]:
    with tempfile.TemporaryDirectory() as folder:
        return [{"test": (record(Path(folder))).read_bytes()}]


@cache
def channels() -> list[Case]:
    text = '[channels.command]\ncolumn = ["a", "b"]\nunit = "mm"\nsign = -1\nzero = 0.5\n'
    text += "[sampling]\nrate_hz = 100\n"
    return [{"channels.toml": text.encode()}]


class _Canary:
    """An object that makes a file where it is unpickled."""

    def __reduce__(self):
        return Path.touch, (Path(tempfile.gettempdir()) / CANARY,)


def _hdf5(columns: dict[str, np.ndarray]) -> bytes:
    content = io.BytesIO()
    with h5py.File(content, "w") as file:
        group = file.create_group("test")
        for name, values in columns.items():
            group.create_dataset(name, data=values, compression="gzip").attrs["units"] = name[-1]
        file.attrs["rate_hz"] = float(RATE)
    return content.getvalue()


def _classic_netcdf(columns: dict[str, np.ndarray]) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "test.nc"
        with netcdf_file(path, "w") as file:
            file.createDimension("sample", len(columns["time_s"]))
            for name, values in columns.items():
                file.createVariable(name, "f8", ("sample",))[:] = values
        return path.read_bytes()


@cache
def campaign() -> list[Case]:
    table = test_histories()
    force = table.assign(
        force_n=4e4 * table["measured_m"], ground_acceleration_mps2=np.gradient(table["command_m"])
    )
    text = """name = "small"
[structure]
frequency_hz = 1.0
damping_ratio = 0.05
mass_kg = 1000.0
experimental_fraction = 1.0
[actuator]
gain = 1.0
delay_s = 0.004
[specimen]
stiffness_n_per_m = 40000.0
[sampling]
rate_hz = 128
[[tests]]
file = "a.csv"
motion = "one"
[[tests]]
file = "b.csv"
held_out = true
"""
    rows = force.round(9).to_csv(index=False).encode()
    return [{"campaign.toml": text.encode(), "a.csv": rows, "b.csv": rows}]


@cache
def studies() -> list[Case]:
    return [{"study.toml": path.read_bytes()} for path in sorted((ROOT / "studies").glob("*/study.toml"))]


@cache
def ellipse_dataset() -> xr.Dataset:
    """Ellipses of 30 motions of 10 earthquakes at two structures."""
    random = np.random.default_rng(17)
    shape = (30, 2, 1, 1, 1, 1, 1)
    a, b = (np.exp(random.normal(mean, 0.4, shape)) for mean in (-8.0, 1.0))
    dims = ("motion", "f", "xi", "threshold", "metric", "curve", "side")
    return xr.Dataset(
        {"a": (dims, a), "b": (dims, b)},
        coords={
            "motion": [f"E{k // 3}/M{k}" for k in range(30)],
            "event": ("motion", [f"E{k // 3}" for k in range(30)]),
            "checksum": ("motion", [f"{k:064d}" for k in range(30)]),
            "f": [0.5, 1.0],
            "xi": [0.02],
            "threshold": [0.05],
            "metric": ["rms"],
            "curve": ["ellipse"],
            "side": ["lag"],
        },
        attrs={"window": "record", "experimental_fraction": 1.0},
    )


@cache
def ellipse_tables() -> list[Case]:
    dataset = ellipse_dataset()
    table = dataset[["a", "b"]].to_dataframe().reset_index()[["motion", "event", "f", "xi", "a", "b"]]
    return [
        {"ellipses.csv": table.to_csv(index=False).encode()},
        {"ellipses.csv": b"a,b\n1e-4,20\n2e-4,30\n"},
    ]


@cache
def ellipse_files() -> list[Case]:
    with tempfile.TemporaryDirectory() as folder:
        write_ellipses(ellipse_dataset(), Path(folder) / "ellipses.nc")
        return [read_back(Path(folder))]


@cache
def criteria() -> list[Case]:
    laws = ("guo_2017_18", "guo_2017_12")
    criterion = derive_criterion(ellipse_dataset(), method="quantile", confidence=0.8)
    texts = [*(published_criterion(law).to_json() for law in laws), criterion.to_json()]
    return [{"criterion.json": text.encode()} for text in texts]


@cache
def models() -> list[Case]:
    test = HybridTest(
        structure=Structure(frequency=1.0, damping_ratio=0.02),
        mass=1000.0,
        actuator=Actuator(gain=1.0, delay=0.003),
        specimen=Specimen(stiffness=4e4),
        effects=(find_effect("coulomb_friction")(force_n=20.0, regularisation_velocity_m_per_s=1e-4),),
    )
    with tempfile.TemporaryDirectory() as folder:
        model = UpdatedModel(name="small", test=test, deviations={"gain": 0.001, "delay_s": 1e-4})
        write_model(Path(folder) / "model.toml", model)
        return [read_back(Path(folder))]


@cache
def frames() -> list[Case]:
    return [{"frame.toml": path.read_bytes()} for path in sorted((ROOT / "datasets/frames").glob("*.toml"))]


CHAIN_MODEL = NormalValues(values=np.random.default_rng(1).normal(-1.0, 0.6, 30))
CHAIN_SETTINGS = Ensembles(steps=40, walkers=8, count=2)


@cache
def chains() -> list[Case]:
    with tempfile.TemporaryDirectory() as folder:
        draw(CHAIN_MODEL, CHAIN_SETTINGS, file=Path(folder) / "chains.h5", group="run")
        return [read_back(Path(folder))]


@cache
def suite() -> MotionSuite:
    random = np.random.default_rng(4)
    time = np.arange(0.0, 4.0, 0.02)
    return MotionSuite.from_motions(
        Motion(
            name=f"E{k}/H",
            event=f"E{k}",
            acceleration=random.standard_normal(time.size) * np.sin(np.pi * time / 4.0) ** 2,
            time_step=0.02,
        )
        for k in range(2)
    )


REQUEST = SweepRequest(
    frequencies=(1.0,), damping_ratios=(0.02,), grid=ScaledGrid(gain_steps=6, delay_steps=8)
)


@cache
def stores() -> list[Case]:
    with tempfile.TemporaryDirectory() as folder:
        store = run_sweep(suite(), REQUEST, Path(folder) / "results.zarr")
        return [{f"results.zarr/{name}": content for name, content in read_back(Path(store)).items()}]


@cache
def plants() -> list[Case]:
    coefficients = {"num": [1.0, 2.0], "den": [1.0, 3.0, 4.0]}
    roots = {"z": [], "p": [-2 + 1j, -2 - 1j], "k": 5.0}
    state_space = {"A": [[-1.0, 0.0], [0.0, -2.0]], "B": [[1.0], [1.0]], "C": [[1.0, 1.0]], "D": 0.0}
    forms: list[dict[str, object]] = [coefficients, roots, state_space]
    return [{"plant.mat": _matlab(form)} for form in forms]


def _matlab(variables: dict[str, object]) -> bytes:
    content = io.BytesIO()
    savemat(content, variables)
    return content.getvalue()


@cache
def manifests() -> list[Case]:
    stage = {"inputs": "0" * 64, "files": {"a.json": "1" * 64}, "date": "2026-11-22"}
    stages = {"one": {**stage, "packages": {"numpy": "2.0"}}, "report": {"inputs": ""}}
    content = {"study": {"kind": "criterion", "title": "small"}, "stages": stages}
    return [{"manifest.json": json.dumps(content).encode()}]


@cache
def defaults() -> list[Case]:
    text = '[assess]\nf = "1±0.01"\nxi = 0.02\n[explore]\nf = 1.0\n'
    return [{"reliab.toml": text.encode()}]

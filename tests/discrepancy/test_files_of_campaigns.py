"""A campaign is the same whatever layouts the files have that its campaign.toml names."""

import shutil
from dataclasses import replace

import h5py
import numpy as np
import pandas as pd
import pytest
from nptdms import ChannelObject, TdmsWriter
from scipy.io import netcdf_file, savemat

from reliab.core.shipped import shipped
from reliab.discrepancy.campaign.campaign import Channel, MeasuredTest, describe_held_out
from reliab.discrepancy.campaign.reading import read_campaign

RIG = shipped("datasets", "campaigns") / "rig_a"


def matlab(table, path):
    savemat(path, {name: table[name].to_numpy() for name in table})


def dspace(table, path):
    time, *remaining = table
    channels = np.array(
        [(f"Model Root/{name}/Out1", table[name].to_numpy()) for name in remaining],
        dtype=[("Name", object), ("Data", object)],
    )
    savemat(path, {"capture": {"X": {"Name": "Time", "Data": table[time].to_numpy()}, "Y": channels}})


def hdf5(table, path):
    with h5py.File(path, "w") as file:
        for name in table:
            file[f"daq/{name}"] = table[name].to_numpy()


def tdms(table, path):
    with TdmsWriter(str(path)) as writer:
        writer.write_segment([ChannelObject("Log", name, table[name].to_numpy()) for name in table])


def netcdf(table, path):
    with netcdf_file(path, "w") as file:
        file.createDimension("sample", len(table))
        for name in table:
            file.createVariable(name, "d", ("sample",))[:] = table[name].to_numpy()


def german(table, path):
    table.to_csv(path, sep=";", decimal=",", index=False, float_format="%.17g")


@pytest.mark.parametrize(
    ("write", "ending"),
    [
        (matlab, "mat"),
        (dspace, "mat"),
        (hdf5, "h5"),
        (tdms, "tdms"),
        (netcdf, "nc"),
        (german, "txt"),
    ],
)
def test_a_campaign_of_other_files_is_the_same(tmp_path, write, ending):
    shutil.copytree(RIG, tmp_path / "rig")
    description = tmp_path / "rig" / "campaign.toml"
    text = description.read_text(encoding="utf-8")
    for path in sorted((tmp_path / "rig").glob("*.csv")):
        if path.name in text:
            write(pd.read_csv(path, comment="#"), path.with_suffix(f".{ending}"))
            text = text.replace(path.name, f"{path.stem}.{ending}")
            path.unlink()
    description.write_text(text, encoding="utf-8")
    for test, reference in zip(read_campaign(tmp_path / "rig").tests, read_campaign(RIG).tests, strict=True):
        assert test.channels.keys() == reference.channels.keys()
        for name, values in test.channels.items():
            np.testing.assert_allclose(values, reference.channels[name], rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize(("growth", "part", "begin"), [(0.0, "last", 600), (1.0, "middle", 300)])
def test_held_out_third_of_a_single_test_stays_within_the_motion_of_the_others(growth, part, begin):
    time = np.arange(900) / 900.0
    displacement = (1.0 + growth * time) * np.sin(60.0 * time)
    test = MeasuredTest(file="a.csv", motion="", held_out=False, channels={Channel.MEASURED: displacement})
    campaign = replace(read_campaign("rig_a"), tests=(test,))
    (proof,) = campaign.proof
    assert (proof.begin, proof.end) == (begin, begin + 300)
    assert sum(stretch.end - stretch.begin for stretch in campaign.training) == 600
    assert campaign.held_out == f"{part} third of a.csv"
    assert describe_held_out([test, test], ["b.csv", "c.csv"]) == "b.csv, c.csv"

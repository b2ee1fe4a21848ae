"""Files that others made: saved by MATLAB 4 to 7.4 on Solaris, Linux and Windows, and by LabVIEW.

They ship with SciPy (BSD-3-Clause) and npTDMS (LGPL-3.0) as data of their tests, and are read there. The
expected numbers are those that SciPy's tests state, and what npTDMS itself reads.
"""

from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from nptdms import TdmsFile

from reliab.core.errors import InputError
from reliab.recordings.readers.registry import read_tests
from reliab.recordings.reading import read_recording


def data_of(package, *below):
    folder = Path(find_spec(package).origin).parent.joinpath(*below)
    if not folder.is_dir():
        pytest.skip(f"{package} was installed without the data of its tests")
    return folder


SAVED = sorted((Path(find_spec("scipy.io").origin).parent / "matlab" / "tests" / "data").glob("*.mat"))
THETA = np.arange(9) * np.pi / 4.0


@pytest.mark.parametrize(
    "name",
    [
        "testdouble_4.2c_SOL2.mat",
        "testdouble_6.1_SOL2.mat",
        "testdouble_6.5.1_GLNX86.mat",
        "testdouble_7.1_GLNX86.mat",
        "testdouble_7.4_GLNX86.mat",
        "testhdf5_7.4_GLNX86.mat",
    ],
)
def test_vectors_that_matlab_saved(name):
    (test,) = read_tests(data_of("scipy.io", "matlab", "tests", "data") / name)
    np.testing.assert_allclose(test.values["testdouble"], THETA, rtol=1e-15)


@pytest.mark.parametrize("name", ["testmulti_7.1_GLNX86.mat", "testmulti_7.4_GLNX86.mat"])
def test_a_vector_beside_other_variables(name):
    (test,) = read_tests(data_of("scipy.io", "matlab", "tests", "data") / name)
    np.testing.assert_allclose(test.values["theta"], THETA, rtol=1e-15)


@pytest.mark.parametrize("release", ["6.1_SOL2", "6.5.1_GLNX86", "7.1_GLNX86", "7.4_GLNX86"])
def test_fields_of_a_structure_and_cells_that_matlab_saved(release):
    folder = data_of("scipy.io", "matlab", "tests", "data")
    (structure,) = read_tests(folder / f"teststruct_{release}.mat")
    np.testing.assert_allclose(
        structure.values["teststruct.doublefield"], [np.sqrt(2.0), np.e, np.pi], rtol=1e-15
    )
    (cells,) = read_tests(folder / f"testcell_{release}.mat")
    np.testing.assert_array_equal(cells.values["testcell(4)"], [1.0, 2.0, 3.0])


@pytest.mark.parametrize("path", SAVED, ids=lambda path: path.name)
def test_no_file_that_matlab_saved_is_taken_for_a_test(path):
    """None of them is one: each gives one sentence, and no warning."""
    with pytest.raises(InputError):
        read_recording(path)


@pytest.mark.parametrize("name", ["raw1.tdms", "big_endian.tdms", "Digital_Input.tdms"])
def test_channels_that_labview_wrote(name):
    path = data_of("nptdms", "test", "data") / name
    (test,) = read_tests(path)
    group = TdmsFile.read(path).groups()[0]  # of SignalExpress the test; thinned copies stand behind it
    for channel in group.channels():
        np.testing.assert_array_equal(test.values[channel.name], channel[:])
        assert np.diff(test.series[channel.name].times) == pytest.approx(channel.properties["wf_increment"])
        assert test.units.get(channel.name, "") == channel.properties.get("unit_string", "")

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.motions.checking import inspect
from reliab.motions.loading import read_motion

Write = Callable[[str, str | bytes], Path]
SAMPLES = np.array([0.1, -0.2, 0.3, -0.25])
SINGLE_COLUMN = "".join(f"{value}\n" for value in SAMPLES)


@pytest.mark.parametrize(
    "line",
    [
        *("dt = 0.01", "dt: 10 ms", "DT= 10.0 MSEC", "dt_ms = 10", "dt [ms]: 10", "dt in ms: 10", "dt 10 ms"),
        *("time step: 10 milliseconds", "time increment 0.01 sec", "sample period: 10000 microseconds"),
        *("delta t = 10000 µs", "SAMPLING INTERVAL (sec) : 0.01", "dt: 0,01", "dt: 100 Hz"),
        *("data at 10 msec intervals", "data at equally-spaced intervals of .010 sec."),
        *("INTERVALO DE MUESTREO, C1-C6 (s) : /.01/.01/.01",),
        *("sampling frequency: 0.1 kHz", "SamplingFrequency(Hz) 100", "Sampling Freq(Hz) 100Hz", "fs = 100"),
        *(
            "sampling rate: 0.01 s",
            "Sampling rate (s): 0.01",
            "AT 100 SAMPLES/SEC",
            "4 samples, 100 sps",
            "Samples per second: 100",
        ),
        *("dt\n# 0.01", "SamplingFrequency(Hz)\n# 100"),
    ],
)
def test_step_is_read_with_its_unit(line: str, write: Write) -> None:
    motion = read_motion(write("a.txt", f"# {line}\n# units: m/s2\n{SINGLE_COLUMN}"))
    assert motion.time_step == pytest.approx(0.01, rel=1e-12)
    np.testing.assert_array_equal(motion.acceleration, SAMPLES)


def test_rate_with_a_separator_of_thousands_is_read(write: Write) -> None:
    path = write("a.txt", f"# Sampling rate: 1,024 Hz\n# units: m/s2\n{SINGLE_COLUMN}")
    assert read_motion(path).time_step == 1 / 1024


@pytest.mark.parametrize(
    ("line", "result"),
    [
        ("dt: 10", "10 s"),
        ("dt: 0.01 min", "0.6 s"),
        ("sampling rate: 0.01", "100 s"),
        ("sampling rate: 1e5 Hz", "1e-05 s"),
        ("dt: 0.0001", "0.0001 s"),
    ],
)
def test_implausible_step_is_questioned(line: str, result: str, write: Write) -> None:
    path = write("a.txt", f"# {line}\n# units: m/s2\n{SINGLE_COLUMN}")
    with pytest.raises(
        InputError, match=f"line 1: .*those of records are 0.0005 to 0.1 s; found {result}"
    ) as caught:
        read_motion(path)
    assert "confirm it with `time_step`" in caught.value.remedy


def test_implausible_step_can_be_confirmed(write: Write) -> None:
    path = write("a.txt", f"# dt: 0.5\n# units: m/s2\n{SINGLE_COLUMN}")
    assert read_motion(path, time_step=0.5).time_step == 0.5
    folder = write("catalog.csv", "motion,file,dt_s\na,a.txt,0.5\n").parent
    assert inspect(folder).faults == []


@pytest.mark.parametrize(
    ("line", "factor"),
    [
        ("scale factor: 0.5", 0.5),
        ("SCALE FACTOR = -2", -2.0),
        ("scaling factor 0.5", 0.5),
        ("scale: 0.5", 0.5),
        ("scale factor 2/4", 0.5),
        ("scale factor: 50 (gal)/count", 0.5),
        ("scale factor of 2 already applied", 1.0),
        ("scaled by 2", 1.0),
        ("full scale: 2 g", 1.0),
        ("Magnitude scale: Mw", 1.0),
        ("1 count = 1", 1.0),
    ],
)
def test_scale_factor_is_applied(line: str, factor: float, write: Write) -> None:
    units = "" if "gal" in line else "# units: m/s2\n"
    path = write("a.txt", f"# dt = 0.01\n# {line}\n{units}{SINGLE_COLUMN}")
    np.testing.assert_allclose(read_motion(path).acceleration, factor * SAMPLES, rtol=1e-15)
    notes = [note.value for note in inspect(path).notes]
    assert notes == ([] if factor == 1 else [f"scale factor {50 if 'gal' in line else factor:g} of line 2"])


@pytest.mark.parametrize(
    ("line", "rule"),
    [
        ("scale factor: 0", "scale factor in the header is no number"),
        ("scale factor: see manual", "scale factor in the header is no number"),
        (
            "scale factor: 2\n# scale factor: 3",
            "Two different .*scale factor.* in one file; found 3.0 here and 2.0 in line 3",
        ),
        ("multiply the samples by 9.81", "whether this factor scales the samples"),
        ("1 count = 0.01 gal", "whether this factor scales the samples"),
        ("offset: 0.5", "to which column this offset belongs"),
        ("units: 0.1 m/s2", "Unknown unit of acceleration; found '0.1 m/s2'"),
        ("acceleration [0.1 g]", "Unknown unit of acceleration; found '0.1 g'"),
        ("acceleration [counts]", "Unknown unit of acceleration; found 'counts'"),
        ("dt: 5 ms", "Two different time steps in one file; found 0.005 here and 0.01 in line 1"),
        ("dt (s): 10 ms", "in two units; found s and ms"),
        ("velocity [cm/s]", "Not a record of acceleration; found velocity"),
        ("Displacement, cm", "Not a record of acceleration; found displacement"),
        ("DATA_TYPE: VELOCITY", "Not a record of acceleration; found velocity"),
        ("Response spectrum, 5 % damping", "Not a record of acceleration; found a spectrum"),
    ],
)
def test_inapplicable_statement_is_refused_by_name(line: str, rule: str, write: Write) -> None:
    path = write("a.txt", f"# dt = 0.01\n# units: m/s2\n# {line}\n{SINGLE_COLUMN}")
    with pytest.raises(InputError, match=rule):
        read_motion(path)


@pytest.mark.parametrize(
    "line",
    [
        *("Shear wave velocity (m/s): 760", "VS30_M/S: 760", "Velocity:  peak  -298.49 mm/s   at  59.02 sec"),
        *(
            "Spectrally matched to the response spectrum of the code",
            "INSTR PERIOD = 0.04 SEC,  DAMPING = .6",
        ),
        *("Offset removed", "PGA (g): 0.35", "time interval: 12:30-14:00", "Resolution: 24-bit", "gaps: 0"),
        *("missing samples: 0", "sampling rate of the recorder", "Offset removed: 0.5"),
    ],
)
def test_irrelevant_line_is_skipped(line: str, write: Write) -> None:
    motion = read_motion(write("a.txt", f"# dt = 0.01\n# units: m/s2\n# {line}\n{SINGLE_COLUMN}"))
    np.testing.assert_array_equal(motion.acceleration, SAMPLES)
    assert motion.time_step == 0.01


def test_units_of_the_peak_are_used_where_no_others_are_stated(write: Write) -> None:
    path = write("a.txt", f"# dt = 0.01\n# Peak acceleration = 0.3 cm/s2\n{SINGLE_COLUMN}")
    np.testing.assert_allclose(read_motion(path).acceleration, SAMPLES / 100, rtol=1e-15)


@pytest.mark.parametrize(
    ("third", "kind"),
    [
        *(
            ("VELOCITY (CM/S)", "velocity"),
            ("VEL. (CM/S)", "velocity"),
            ("VELOCITY-TIME HISTORY", "velocity"),
        ),
        *(("GROUND VELOCITY, CM/SEC", "velocity"), ("VELOCITY", "velocity"), ("Vel, cm/s", "velocity")),
        *(("DISPLACEMENT, CM", "displacement"), ("DISPL (CM)", "displacement")),
        *(("displacement in cm", "displacement"), ("INTEGRATED DISPLACEMENT (CM)", "displacement")),
    ],
)
def test_at2_of_velocity_or_displacement_is_refused(third: str, kind: str, write: Write) -> None:
    text = f"PEER\nSomequake 1/2/2003, STA 1\n{third}\nNPTS= 4, DT= .01 SEC\n{SINGLE_COLUMN}"
    with pytest.raises(InputError, match=f"line 3: Not a record of acceleration; found {kind}"):
        read_motion(write("a.AT2", text))


@pytest.mark.parametrize(
    ("mark", "declaration"),
    [
        *(("-999", ""), ("-999.0", ""), ("9999.", ""), ("1e20", ""), ("-7.5", "")),
        ("0.3", "missing value: 0.3\n# no-data value: 0.3"),
        ("-99", "missing data marked as -99"),
    ],
)
def test_gap_marks_are_refused(mark: str, declaration: str, write: Write) -> None:
    samples = [f"{value:.4f}" for value in np.sin(np.arange(60.0))]
    samples[20:24] = [mark] * 4
    header = f"# dt = 0.01\n# units: cm/s2\n# {declaration}\n"
    with pytest.raises(InputError, match=r"has gaps; found the mark of a missing sample, .*, 4 times"):
        read_motion(write("a.txt", header + "\n".join(samples)))


def test_number_like_a_mark_within_the_record_is_a_sample(write: Write) -> None:
    samples = [f"{value:.1f}" for value in 1400 * np.sin(np.arange(60.0))]
    samples[20] = "-999.0"
    path = write("a.txt", "# dt = 0.01\n# units: mm/s2\n" + "\n".join(samples))
    assert read_motion(path).acceleration[20] == pytest.approx(-0.999)

"""Short synthetic records in every format, written by the tests themselves."""

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

KNET = """Origin Time       2018/01/24 19:51:00
Lat.              41.0
Long.             142.5
Depth. (km)       30
Mag.              6.2
Station Code      XYZ001
Station Lat.      41.5267
Station Long.     140.9244
Station Height(m) 39
Record Time       2018/01/24 19:51:43
Sampling Freq(Hz) 10Hz
Duration Time(s)  1
Dir.              N-S
Scale Factor      3920(gal)/6182761
Max. Acc. (gal)   0.048
Last Correction   2018/01/24 19:51:43
Memo.{blank}
   13186    13190    13196    13187    13185    13194    13191    13185{blank}
   13190    13106
""".format(blank=" ")

CSMIP_CHANNEL = """Corrected accelerogram   XYZ-L2500-12044.02       Chan  {number}: {label}    from
Uncorrected Accelerogram Data             Processed: 02/13/12, CGS  146be002
Record of Mon Feb 13, 2012 13:06:45.0 PST             (Avol1 v9.2,12/11 CSMIP)
Made for a test               (Origin: 02/13/12, 21:06:02.8 UTC)
Station No. 99999   40.941N, 123.633W      Etna  s/n 2500  (3 Chns of  3 at Sta)
Chan  {number}: {label}
     8 points of instrument- and baseline-corrected accel, veloc and displ data
At equally-spaced intervals of    .005  sec.
Peak acceleration =   222.250    cm/sec/sec  at     .030   sec.
    1  100    1    3    3  200    1    3    1   24   12 2500    089146    1    0
  .0108814  .6700000 66.000000  .0037019      .000 629.00000  .0791795 30.590000
     8 points of accel data equally spaced at  .005 sec, in cm/sec2. (8f10.6)
  -.001239  1.171726-12.626200 -7.202959123.456700 -8.110211 222.25000  8.140768
     8 points of veloc data equally spaced at  .005 sec, in cm/sec.  (8f10.7)
  9.000000  9.000000  9.000000  9.000000  9.000000  9.000000  9.000000  9.000000
     8 points of displ data equally spaced at  .005 sec, in cm.      (8f10.7)
  7.000000  7.000000  7.000000  7.000000  7.000000  7.000000  7.000000  7.000000
/&  ----------  End of data for channel  {number}  ----------
"""
CSMIP_SAMPLES = [-0.001239, 1.171726, -12.6262, -7.202959, 123.4567, -8.110211, 222.25, 8.140768]

_REALS = [-999.0] * 100
_REALS[33] = 0.02  # step of the raw record
_REALS[61] = 5.0  # step of these samples in milliseconds
COSMOS_REALS = "\n".join("".join(f"{value:15.6f}" for value in _REALS[i : i + 5]) for i in range(0, 100, 5))
COSMOS = f"""Corrected acceleration    (Format v01.20 with 13 text lines)
Record of a test
Hypocenter: 61.34640 -149.95520 H= 46km Mw=7.0
Origin: 2018/11/30 17:29:29    UTC
Statn No: 37-000011 Code:AK-XYZ     UAF  Nowhere
Coords: 60.9677 -144.6051  Site geology:
Recorder: (see cmnt)      ( ? Chns of   3 at Sta) Sensor: (see comment)
Rcrd start time: 2018/11/30 17:29:39.137 UTC (Q=5) RcrdId: (see comment)
Sta Chan   1: 90 deg (Rcrdr Chan  1) Location:
Raw record length = 210.000 sec, Uncor max =    101730, at  82.680 sec.
Processed:2019-03-03 05:46:55 GMT, UNKN, Max =   -6.852 cm/sec2 at   76.215 sec
Record filtered below  0.03 Hz (periods over 33.33 secs), and above 20.0 Hz
Values used when parameter or data value is unknown/unspecified:   -999, -999.00
  10 Integer-header values follow on   1 lines, Format= (10I8)
       2       1       4     120       1    -999    -999      11    -999    -999
 100 Real-header values follow on  20 lines, Format= (5F15.6)
{COSMOS_REALS}
   1 Comment line(s) follow, each starting with a "|":
| Recorder: none
       5 acceleration pts, approx    0 secs, units=cm/sec2(04),Format=(1E15.6)
   3.437285e-01
   3.438810e-01
  -3.440236e+01
   3.441520e-01
   3.442641e-01
End-of-data for Chan  1 acceleration
"""

AT2 = """PEER NGA STRONG MOTION DATABASE RECORD
Nowhere-01, 10/18/1989, Testing Station, 90
ACCELERATION TIME SERIES IN UNITS OF G
NPTS=      7, DT=   .0050 SEC,
   .1000000E+00  -.2000000E+00   .3000000E+00  -.4000000E+00   .5000000E+00
  -.6000000E-01   .7000000E-02
"""

COLUMNS = """# time [s], acceleration [m/s2]
0.00, 0.1
0.01, -0.2
0.02, 0.3
0.03, -0.25
"""

RECORDS = {
    "record.AT2": AT2,
    "record.NS": KNET,
    "record.V2": CSMIP_CHANNEL.format(number=1, label="360 Deg"),
    "record.V2c": COSMOS,
    "record.csv": COLUMNS,
}


@pytest.fixture(scope="session")
def records() -> dict[str, str]:
    """One sound record of every format, by a file name."""
    return RECORDS


@pytest.fixture(scope="session")
def obspy() -> Any:
    """The library ObsPy; what uses it is skipped where it is not installed."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return pytest.importorskip("obspy")


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str, str | bytes], Path]:
    """Write a file below a new folder and return its path."""

    def writer(name: str, content: str | bytes) -> Path:
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return writer

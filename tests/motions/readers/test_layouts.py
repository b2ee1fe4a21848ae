"""Layouts of national networks, written here after their public descriptions."""

from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.core.vocabulary import STANDARD_GRAVITY as G
from reliab.motions.checking import inspect
from reliab.motions.loading import load_motions

Write = Callable[[str, str | bytes], Path]
COUNT, STEP = 43, 0.01
TIMES = STEP * np.arange(COUNT)
ONE, TWO, UP = (scale * np.sin(9 * TIMES + phase) for scale, phase in ((80.0, 0.2), (60.0, 1.0), (20.0, 2.0)))


def lines(values: Iterable[float], form: str, line_values: int) -> str:
    cells = [format(value, form) for value in values]
    return "".join("".join(cells[i : i + line_values]) + "\n" for i in range(0, len(cells), line_values))


def numeric_header(integers: int, reals: int, width: int = 5) -> str:
    return (
        "".join(f"{1:{width}d}" for _ in range(10)) + "\n"
    ) * integers + f"{0.5:8.3f}{1.25:8.3f}\n" * reals


def afad() -> str:
    rows = "".join(f"{a:14.6f}{b:14.6f}{c:14.6f}\n" for a, b, c in zip(ONE, TWO, UP, strict=True))
    return f"""STRONG GROUND MOTION RECORDS OF TURKIYE
PLACE                   : SOMEWHERE
EARTHQUAKE DATE         : 17/08/1999 00:01:39.07 (GMT)
EARTHQUAKE MAGNITUDE    : 7.4 Mw
RECORD TIME             : 17/08/1999 00:01:45.000000 (GMT)
NUMBER OF DATA          : {COUNT}
SAMPLING INTERVAL (sec) : {STEP}
RAW PGA VALUES (gal)    : (N-S) 80 (E-W) 60 (U-D) 20
COMMENTS                :

     N-S           E-W           U-D
{rows}"""


def cwb() -> str:
    rows = "".join(
        f"{t:10.3f}{c:10.3f}{a:10.3f}{b:10.3f}\n" for t, a, b, c in zip(TIMES, ONE, TWO, UP, strict=True)
    )
    return f"""#Earthquake Information
#Origin Time(GMT+08): 2018/02/06-23:50:42
#EpicenterLongitude(E): 121.69
#Magnitude(Ml): 6.0
#Station Information
#StationCode: XYZ
#StartTime(GMT+08): 2018/02/06-23:50:29.000
#RecordLength(sec): 0.43
#SampleRate(Hz): 100
#AmplitudeUnit:  gal. DCoffset(corr)
#AmplitudeMAX. U:    4.094~   -4.353
#DataSequence: Time U(+); N(+); E(+)
#Data: 4F10.3
{rows}"""


def knet_csv() -> str:
    rows = "".join(
        f"2019/01/02 17:47:{27 + t:05.2f},{t:.2f},{a - 18.6:.3f},{b - 1.4:.3f},{c + 26.1:.3f}\n"
        for t, a, b, c in zip(TIMES, ONE, TWO, UP, strict=True)
    )
    return f"""#K-NET CSV
#Event
#OriginTime,Latitude,Longitude,Depth(km),Magnitude
#2019/01/02 17:47:00,36.708,140.952,32,3.8
#Station
#Code,Latitude,Longitude,Height(m)
#XYZ005,37.6389,140.9853,17
#Record
#SamplingFrequency(Hz)
#100
#DurationTime(s)
#0.43
#Offset
#N-S(gal),E-W(gal),U-D(gal)
#-18.60,-1.40,26.10
#Time,RelativeTime(s),N-S(gal),E-W(gal),U-D(gal)
{rows}"""


def asa() -> str:
    rows = "".join(f"{a:12.6f}{c:12.6f}{b:12.6f}\n" for a, b, c in zip(ONE, TWO, UP, strict=True))
    return f"""============================================================
                 ARCHIVO ESTANDAR DE ACELERACION
============================================================
CLAVE DE LA ESTACION                    : XYZ1
COORDENADAS DE LA ESTACION              : 16.705  LAT. N
                                        : 99.130  LONG. W
ORIENTACION C1-C6 (rumbo;orientacion)   : /N00E/V/N90E
VEL. DE MUESTREO, C1-C6 (muestras/s)    : /100/100/100
INTERVALO DE MUESTREO, C1-C6 (s)        : /.01/.01/.01
FECHA DEL SISMO [GMT]                   : 2017/09/19
HORA EPICENTRO (GMT)                    : 18:14:40
DURACION DEL REGISTRO (s), C1-C6        : /.43/.43/.43
NUM. TOTAL DE MUESTRAS, C1-C6           : /{COUNT}/{COUNT}/{COUNT}
ACEL. MAX.(GAL), EN LA MUESTRA, C1-C6   : /80/20/60
============================================================
  CANAL-1     CANAL-2     CANAL-3
  N00E        V           N90E
{rows}"""


def geonet() -> str:
    def component(name: str, values: np.ndarray) -> str:
        return f"""Corrected accelerogram 20161113_110256_XYZ_20 GNS Science
Site XYZ       42 31 24S  172 49 50E     Basalt file:  20161113_110300_XYZ
Instrument Basalt_2430
Resolution: 24-bit   Instr Period: 0.0050 s   Damping: 0.700
5 km south-west of Somewhere
2016 November 13         11:02:56 UT
Epicentre  42 41 33S 173 01 19E  Bearing S40E  Dist   25km  Depth   15km Mw 7.82
Number of points  {COUNT}    Duration 0.43 sec
Instrument corrected data at 0.010 sec intervals
Band-pass filter transition bands are .10-.25 Hz and 24.50-25.50 Hz
Component {name}  Longitudinal Accelerometer Axis
Acceleration:  peak    800.0 mm/s/s at  48.14 sec     rms    292.2 mm/s/s
Velocity:      peak  -298.49 mm/s   at  59.02 sec     rms    46.28 mm/s
Displacement:  peak   99.407 mm     at  53.60 sec     rms   14.626 mm
{numeric_header(4, 6, 8)}{lines(10 * values, "8.1f", 10)}{lines(values, "8.1f", 10) * 2}"""

    return component("N10E", ONE) + component("S80E", TWO) + component("Up", UP)


def volume_1(*, layout: str) -> str:
    def component(number: int, values: np.ndarray) -> str:
        tenths = values / 100 / G * 10
        pairs = np.column_stack([TIMES, tenths]).ravel()
        header = numeric_header(5 if layout == "usc" else 7, 7)
        title = {
            "renadic": "UNCORRECTED ACCELEROGRAM DATA              PROCESSED: 06/30/2011",
            "usc": "TAPE OF UNCORRECTED ACCELEROGRAM DATA OF 04/29/94",
            "bhrc": "* VOL1DS FILE:  5522/01\nInst Type = SSA-2",
        }[layout]
        origin = (
            "Origin Time : 2012/08/11   12:23:16" if layout == "bhrc" else "(ORIGIN: 08/11/2012 12:23:16 GMT)"
        )
        body = lines(tenths, " 12.6E", 10) if layout == "bhrc" else lines(pairs, "7.3f", 10)
        return f"""{title}
{origin}
CHAN  {number}: L        (STA CHN:  1)
INSTR PERIOD = 0.0400 SEC,  DAMPING =0.6000,  SENSITIVITY =1.000 VDC/G
NO. OF POINTS =   {COUNT}  RECORD LENGTH = {STEP * COUNT:.3f} SEC
UNITS OF UNCOR ACCEL ARE SEC AND G/10.     MAX  =  0.132 G, AT  11.895 SEC
{header}{body}/&  ----------  END OF DATA FOR CHANNEL  {number}  ----------
"""

    return component(1, ONE) + component(2, UP) + component(3, TWO)


def smc() -> str:
    integers = [-32768] * 48
    integers[15:18] = 2, COUNT, -32768
    reals = [0.17e39] * 50
    reals[1] = 100.0
    return f"""2 CORRECTED ACCELEROGRAM
*
XYZ0E
     1989  10  18    0004 Loma Prieta, CA
Moment Mag=      7.1 Ms=      7.1 Ml=      7.0
station = Somewhere, 42n               component=    225
epicentral dist =     96.0       pk acc =    180.3
inst type=CRA-1      data source = USGS
*
*
*
{lines(integers, "10d", 8)}{lines(reals, "15.7E", 5)}| sampling rate before: 200 Hz
| velocity is in another file
{lines(ONE, "10.4f", 8)}"""


LAYOUTS = {
    "AFAD": (afad(), [ONE, TWO, UP], "1999-08-17 00:01:39.07"),
    "CWB": (cwb(), [UP, ONE, TWO], "2018-02-06 23:50:42"),
    "K-NET CSV": (knet_csv(), [ONE, TWO, UP], "2019-01-02 17:47:00 36.708N 140.952E"),
    "ASA": (asa(), [ONE, UP, TWO], "2017-09-19 18:14:40"),
    "GeoNet": (geonet(), [ONE, TWO, UP], "2016-11-13 11:02:56"),
    "RENADIC": (volume_1(layout="renadic"), [ONE, UP, TWO], "2012-08-11 12:23:16"),
    "USC": (volume_1(layout="usc"), [ONE, UP, TWO], "2012-08-11 12:23:16"),
    "BHRC": (volume_1(layout="bhrc"), [ONE, UP, TWO], "2012-08-11 12:23:16"),
    "SMC": (smc(), [ONE], "LOMA PRIETA CA 1989-10-18"),
}
ROUNDING = {"RENADIC": 0.05, "USC": 0.05, "CWB": 1e-3, "K-NET CSV": 1e-3, "GeoNet": 0.01, "SMC": 1e-4}  # gal


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("name", ["record.dat", "record.strange", "record"])
def test_national_layout_is_read_whatever_its_ending(layout: str, name: str, write: Write) -> None:
    text, components, event = LAYOUTS[layout]
    folder = write(name, text).parent
    suite = load_motions(folder)
    assert len(suite) == len(components)
    for motion, expected in zip(suite, components, strict=True):
        np.testing.assert_allclose(motion.acceleration * 100, expected, atol=ROUNDING.get(layout, 1e-5))
        assert motion.time_step == pytest.approx(STEP, rel=1e-9)
        assert motion.event == event
    assert inspect(folder).faults == []


@pytest.mark.slow
@pytest.mark.parametrize("layout", ["GeoNet", "RENADIC", "USC", "BHRC", "AFAD", "SMC", "ASA", "K-NET CSV"])
def test_record_cut_short_is_refused_and_never_shifted(layout: str, write: Write) -> None:
    rows = LAYOUTS[layout][0].splitlines(keepends=True)
    for index in range(20, len(rows) - 1, 2):
        path = write(f"cut{index}.dat", "".join(rows[:index]))
        if not inspect(path).faults:  # whole components may be left
            for motion in load_motions(path):
                differences = [np.abs(motion.acceleration * 100 - item).max() for item in LAYOUTS[layout][1]]
                assert min(differences) < 0.1


def test_samples_without_a_numeric_header_are_read(write: Write) -> None:
    header = "\n".join(geonet().splitlines()[:14])
    path = write("a.V2A", f"{header}\n{lines(10 * ONE, '8.1f', 10)}")
    (motion,) = load_motions(path)
    np.testing.assert_allclose(motion.acceleration * 100, ONE, atol=0.01)


def test_uneven_times_are_refused_with_a_remedy(write: Write) -> None:
    text = volume_1(layout="renadic").replace("  0.050", "  0.053")
    (fault, *_) = inspect(write("a.v1", text)).faults
    assert "increase by equal steps" in fault.rule
    assert "Interpolate" in fault.remedy


def test_layout_without_its_count_is_named(write: Write) -> None:
    text = volume_1(layout="renadic").replace("NO. OF POINTS", "POINTS")
    with pytest.raises(InputError, match=r"what the columns hold.*# samples: N"):
        load_motions(write("a.v1", text))


@pytest.mark.parametrize("title", ["# Corrected accelerogram of Somewhere", "Corrected accelerogram"])
def test_title_of_a_layout_above_plain_columns_is_no_obstacle(title: str, write: Write) -> None:
    rows = "".join(f"{t:.2f} {a:.6f}\n" for t, a in zip(TIMES, ONE, strict=True))
    (motion,) = load_motions(write("a.txt", f"{title}\n# units: gal\n{rows}"))
    np.testing.assert_allclose(motion.acceleration * 100, ONE, atol=1e-6)


def test_unset_clock_is_no_earthquake(write: Write) -> None:
    text = volume_1(layout="renadic").replace("08/11/2012 12:23:16", "01/01/1980 0:00:00")
    assert set(load_motions(write("station.v1", text)).events) == {"station"}


@pytest.mark.parametrize("title", ["3 CORRECTED VELOCITY", "4 CORRECTED DISPLACEMENT", "6 RESPONSE SPECTRA"])
def test_smc_of_another_quantity_is_refused(title: str, write: Write) -> None:
    with pytest.raises(InputError, match="Not a record of acceleration"):
        load_motions(write("a.smc", smc().replace("2 CORRECTED ACCELEROGRAM", title)))


def test_uncorrected_smc_of_uneven_times_is_refused(write: Write) -> None:
    pairs = np.column_stack([TIMES * (1 + 0.1 * TIMES), ONE]).ravel()
    text = smc().replace(f"{100.0:15.7E}", f"{0.17e39:15.7E}")
    head = text[: text.index("| velocity")]
    with pytest.raises(InputError, match="increase by equal steps"):
        list(load_motions(write("a.smc", f"{head}|\n{lines(pairs, '10.4f', 8)}")))


def esm(stream: str, values: np.ndarray, *, identity: str = "XX-20260505_0000001") -> str:
    return f"""EVENT_NAME: SOMEPLACE
EVENT_ID: {identity}
EVENT_DATE_YYYYMMDD: 20260505
EVENT_TIME_HHMMSS: 100000
NETWORK: XX
STATION_CODE: STA1
VS30_M/S: 760
SAMPLING_INTERVAL_S: 0.010000
NDATA: {COUNT}
STREAM: {stream}
UNITS: cm/s^2
PGA_CM/S^2: 80.0
DATA_TYPE: ACCELERATION
{lines(values, ".6f", 1)}"""


def test_components_in_files_of_their_own_share_the_event(write: Write) -> None:
    write("XX.STA1.HNE.ASC", esm("HNE", ONE))
    write("XX.STA1.HNN.ASC", esm("HNN", TWO))
    write("XX.STA2.HNN.ASC", esm("HNN", TWO + 1, identity=""))
    folder = write("XX.STA3.HNN.ASC", esm("HNN", TWO + 2, identity="XX-20260505_0000002")).parent
    first, second, third, fourth = load_motions(folder).events
    assert first == second == "XX-20260505_0000001"
    assert third == "SOMEPLACE 2026-05-05 10:00:00"
    assert fourth == "XX-20260505_0000002"


def test_csmip_units_in_brackets_are_read(write: Write) -> None:
    text = f"""UNCORRECTED ACCELEROGRAM DATA              PROCESSED: 06/16/98, CDMG 23583
JUNE 28, 1992 08:05 PDT                 (ORIGIN(USGS): 06/28/92, 15:05:30.5 UTC)
CHAN  1:  90 DEG
NO. OF POINTS =  {COUNT}  RECORD LENGTH = 0.420 SEC   AT 200 SAMPLES/SEC
UNITS OF UNCOR ACCEL IS G.                 MAX  =   .058 G, AT   9.425 SEC.
{numeric_header(7, 7)}{COUNT} POINTS OF ACCEL DATA EQUALLY SPACED AT .01 SEC.  (UNITS: G)
{lines(ONE / 980.665, "9.6f", 8)}"""
    (motion,) = load_motions(write("a.RAW", text))
    np.testing.assert_allclose(motion.acceleration * 100, ONE, atol=1e-3)
    assert (motion.time_step, motion.event) == (0.01, "1992-06-28 15:05:30.5")

"""Tables on the terminal: title, headings and each cell below the heading that it belongs to."""

from types import SimpleNamespace

import pytest

from reliab.app.cli import calibrate, validate
from reliab.app.cli.assess import show_design
from reliab.app.cli.criterion import show_criteria
from reliab.app.cli.shown_verdict import show_several
from reliab.assessment.design import Tolerance
from reliab.core.stated_value import StatedValue
from reliab.report import terminal


@pytest.fixture
def tables(monkeypatch):
    """Tables that were printed, by their titles: headings with how they stand, and rows."""
    tables_by_title, make = {}, terminal.rich_table

    def rich_table(table):
        output = make(table)
        tables_by_title.setdefault(table.caption or f"table {len(tables_by_title)}", output)
        return output

    monkeypatch.setattr(terminal, "rich_table", rich_table)
    return tables_by_title


def cells(table):
    """Rows of a table as dictionaries by heading, and where its cells stand."""
    headings = [str(column.header) for column in table.columns]
    columns = [[str(cell) for cell in column.cells] for column in table.columns]
    return [dict(zip(headings, row, strict=True)) for row in zip(*columns, strict=True)]


SHARES = {
    "ratios": [
        {
            "f": 1.25,
            "xi": 0.03,
            "alpha": 0.5,
            "threshold": 0.04,
            "confidence": 0.9,
            "a_ratio": 1.11,
            "b_ratio": None,
            "law": 1.333,
            "a_deviation": -0.012,
            "b_deviation": None,
        }
    ],
    "fits": [
        {
            "f": 1.25,
            "xi": 0.03,
            "threshold": 0.04,
            "a_strength": 138.9,
            "a_largest_deviation": 0.021,
            "b_strength": None,
            "b_largest_deviation": None,
            "white_noise": 142.0,
        }
    ],
}
RIG = {
    "metric": "rms",
    "stable": True,
    "median": 0.0111,
    "largest": 0.0333,
    "threshold": 0.05,
    "share_below": 0.97,
    "motions": [{"A": 1.02, "d_ms": 3.0}, {"A": 0.98, "d_ms": 1.5}],
}
LIMITS = {
    "f": 1.25,
    "xi": 0.03,
    "alpha": 0.75,
    "threshold": 0.04,
    "position": "inside",
    "confidence": 0.9,
    "a": 1.11e-4,
    "b": 2.22,
    "amplitude_limit": 0.0333,
    "delay_limit_ms": 4.44,
    "lead_limit_ms": None,
    "n_motions": 61,
    "motions": "motions",
    "n_events": 17,
    "population": "",
    "joint": True,
    "method": "dirichlet",
    "law": "none",
    "metric": "rms",
    "window": "record",
    "curve": "ellipse",
    "warnings": [],
}
SCORES = {"log_score": 1.1, "gain": 2.2, "standard_error": 3.3, "tail_score": 4.4, "quantile_05": 5.5}
COMPARISON = {
    "distributions": [
        {
            "parameter": "a",
            "f": 1.25,
            "xi": 0.03,
            "threshold": 0.04,
            "lognormality": {"shapiro_wilk": 0.44},
            "scores": [{"distribution": "weibull", **SCORES}],
        }
    ],
    "laws": [
        {"law": "power", "f": f, "threshold": 0.04, "log_score": 10 * f, "region_at_f": 100 * f}
        for f in (1.5, 2.5)
    ],
}


def test_limits_of_shares_stand_below_their_headings(tables, capsys):
    show_criteria({"criteria": [LIMITS], "share_law": SHARES})
    (output,) = (table for title, table in tables.items() if title.startswith("Limits over the share"))
    assert cells(output) == [
        {
            "f [Hz]": "1.25",
            "ξ [-]": "0.03",
            "α [-]": "0.5",
            "error [-]": "0.04",
            "confidence [-]": "0.9",
            "a over a of the largest α": "1.11",
            "b over b of the largest α": "-",
            "law": "1.33",
            "a off by": "-1.2 %",
            "b off by": "-",
        }
    ]
    assert {column.justify for column in output.columns} == {"right"}
    text = " ".join(capsys.readouterr().out.split())
    assert "a at f = 1.25 Hz, ξ = 0.03, error 0.04: s = 139 fits best" in text
    assert "off by 2.1 % at most; by the law s = 142" in text
    assert "b at f" not in text


def test_limits_and_the_error_of_a_rig_stand_below_their_headings(tables, capsys):
    show_criteria({"criteria": [LIMITS], "rig": RIG})
    (limits,) = cells(tables["(A − 1)²/a + d²/b ≤ 1 from 61 motions of 17 earthquakes"])
    assert (limits["f [Hz]"], limits["ξ [-]"], limits["a [-]"], limits["b [ms²]"]) == (
        "1.25",
        "0.03",
        "0.000111",
        "2.22",
    )
    rows = {row[""]: row["value"] for row in cells(tables["Error of the described rig, RMS error"])}
    assert rows == {
        "median of the motions": "1.11 %",
        "largest": "3.33 %",
        "motions below 0.05": "97 %",
        "A, least to largest": "0.9800 to 1.0200",
        "d_ms, least to largest": "1.500 to 3.000",
    }
    show_criteria({"criteria": [LIMITS], "rig": {**RIG, "stable": False}})
    assert "the test of this frame is unstable" in capsys.readouterr().out


def test_distributions_and_laws_stand_below_their_headings(tables, capsys):
    show_criteria({"criteria": [LIMITS], "comparison": COMPARISON})
    _, scores, scores_of_laws, regions_of_laws = map(cells, tables.values())
    assert scores == [
        {
            "distribution": "weibull",
            "log score": "1.1",
            "gain": "2.2",
            "standard error": "3.3",
            "tail score": "4.4",
            "quantile 05": "5.5",
        }
    ]
    assert scores_of_laws == [{"law": "power", "1.5": "15", "2.5": "25"}]
    assert regions_of_laws == [{"law": "power", "1.5": "150", "2.5": "250"}]
    text = " ".join(capsys.readouterr().out.split())
    assert "a at f = 1.25 Hz, ξ = 0.03, error 0.04, earthquakes held out." in text
    assert "p of lognormality: shapiro-wilk 0.44." in text


def test_probabilities_stand_below_their_heading(tables):
    validate.show_probabilities(
        {
            "scheme": "leave_out",
            "truth": "ellipse",
            "bins": [{"stated": 0.9, "observed": 0.85, "low": 0.7, "high": 0.95, "tests": 43}],
        }
    )
    assert cells(tables["Probabilities of tests, leave out"]) == [
        {
            "stated probability": "90.0 %",
            "good tests (95 % interval)": "85.0 % (70.0 % … 95.0 %)",
            "tests": "43",
        }
    ]


def test_several_verdicts_stand_below_their_headings(tables, capsys):
    verdict = {
        "file": "a.csv",
        "metric": "rms",
        "threshold": 0.05,
        "verdict": "not_reliable",
        "probability": 0.25,
        "error": {"rms": {"value": 0.06, "low": 0.055, "high": 0.066}},
        "A": 0.99,
        "d_ms": 1.5,
        "warnings": ["Look."],
        "reliable": False,
        "reasons": ["Too large."],
    }
    show_several([verdict, {"file": "b/c.csv", "fault": "c.csv: no command"}])
    assert cells(tables["Verdicts on 2 tests, RMS error against 5 %"]) == [
        {
            "test": "a.csv",
            "verdict": "not reliable",
            "error": "6.0 %",
            "90 % interval": "5.5 to 6.6 %",
            "probability": "0.25",
            "A": "0.99000",
            "d, ms": "1.5000",
        },
        {
            "test": "b/c.csv",
            "verdict": "not judged",
            **dict.fromkeys(("error", "90 % interval", "probability", "A", "d, ms"), ""),
        },
    ]
    assert capsys.readouterr().out.splitlines()[-3:] == [
        "a.csv: Too large.",
        "a.csv: Warning: Look.",
        "b/c.csv: no command",
    ]


def test_tolerable_errors_stand_below_their_headings_and_bars_are_as_long_as_the_delay(tables, capsys):
    def tolerance(f, delay, confidence=0.9, is_outside=False):  # noqa: FBT002
        return Tolerance(
            frequency=f,
            damping_ratio=0.03,
            threshold=0.05,
            confidence=confidence,
            a=0.0004,
            b=(1e3 * delay) ** 2,
            critical_delay=0.05,
            outside_validity=is_outside,
            population="of here",
        )

    rows = [tolerance(1.25, 0.004), tolerance(2.5, 0.002, is_outside=True)]
    chart = [tolerance(1.0, 0.004), tolerance(2.0, 0.002), tolerance(3.0, 0.009, confidence=0.5)]
    show_design(SimpleNamespace(tolerances=rows, chart=chart))
    limits, bars = map(cells, tables.values())
    assert [
        (row["f [Hz]"], row["confidence"], row["|A − 1| alone"], row["d alone [ms]"]) for row in limits
    ] == [("1.25", "90 %", "0.0200", "4.000"), ("2.5*", "90 %", "0.0200", "2.000")]
    both = rows[0].both
    assert limits[0]["|A − 1| and"] == f"{both[0]:.4f}"
    assert limits[0]["d together [ms]"] == f"{1e3 * both[1]:.3f}"
    assert [(row["f [Hz]"], row["d alone [ms]"], len(row["d"])) for row in bars] == [
        ("1", "4.000", 40),
        ("2", "2.000", 20),
    ]
    assert list(tables) == ["Tolerable errors at ξ = 0.03 for an error of 5 %", "Over the frequency, at 90 %"]
    output = capsys.readouterr().out
    assert "Valid for ground motions like these: of here." in output
    assert "the criterion does not cover *" in output


def test_calibrated_channels_stand_below_their_headings(tables):
    calibrate._show(  # noqa: SLF001 - the table alone
        SimpleNamespace(
            skew_ms=StatedValue(1.25, 0.05),
            scale=StatedValue(1.002, 0.0005),
            hysteresis=None,
            noise_m=1.5e-5,
            command_noise_m=0.0,
            resolution_m=2e-6,
            notes=(),
        )
    )
    output = cells(tables["What the measured channel adds to the motion"])
    rows = {row[""]: (row["value"], row["± 1 sd"]) for row in output}
    assert list(rows.values()) == [
        ("1.25", "0.05"),
        ("1.002", "0.0005"),
        ("not determined", ""),
        ("1.5e-05", ""),
        ("0", ""),
        ("2e-06", ""),
    ]
    assert [name.partition(" ")[0] for name in rows] == [
        "delay",
        "scale",
        "hysteresis",
        "noise",
        "noise",
        "step",
    ]

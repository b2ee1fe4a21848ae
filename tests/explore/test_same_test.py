"""A test of any layout is at the same place on the page as in `reliab assess`, through one file or two."""

import layouts
import pytest

import reliab
from reliab.app.cli import run

FIRST = (layouts.mts_793, layouts.tdms)
EACH = [pytest.param(write, marks=[] if write in FIRST else pytest.mark.slow) for write in layouts.LAYOUTS]


def placed(path):
    answer = reliab.assess(path, f=1.0, xi=0.02).to_dict()
    return {"amplitude": answer["A"], "delay": answer["d_ms"] / 1e3}


def on_page(by_javascript, path):
    text = path.read_bytes().decode("utf-8", errors="replace")
    (answer,) = by_javascript(("test", {"text": text, "threshold": 0.05}))
    return answer


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("write", EACH)
def test_the_page_reads_what_record_writes_of_it(by_javascript, tmp_path, write):
    path, table = write(tmp_path), tmp_path / "for_page.csv"
    assert run(["record", str(path), "--csv", str(table)]) == 0
    answer, expected = on_page(by_javascript, table), placed(path)
    assert {key: answer[key] for key in expected} == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("write", EACH)
def test_a_file_that_the_page_does_not_read_itself_is_refused_with_the_command_that_helps(
    by_javascript, tmp_path, write
):
    path = write(tmp_path)
    answer = on_page(by_javascript, path)
    if "refused" in answer:
        assert "`reliab record FILE --csv TEST.csv`" in answer["refused"]
    else:
        expected = placed(path)
        assert {key: answer[key] for key in expected} == pytest.approx(expected, rel=1e-6)

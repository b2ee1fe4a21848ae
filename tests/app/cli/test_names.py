"""Names are data: nothing in them is markup, steers the terminal or stops a command."""

import json
import os
import subprocess
import sys

import pytest
from fuzz.corpus import campaign, ellipse_dataset
from fuzz.damage import write
from motions.conftest import AT2

from reliab.app.cli import run
from reliab.app.cli.output import console, show_table
from reliab.core.encodings import printable
from reliab.sweep.ellipse_dataset import write_ellipses

NAMES = {
    "typst": '#panic("x") $a$ *b* _c_ @d <e> `f` \\',
    "html": "<script>alert(1)</script>&amp;",
    "markup of Rich": "[/red] [bold]a[/bold] [link=https://x]b[/link] :smile:",
    "escapes of terminals": "\x1b[31mred\x1b]0;title\x07\x9b2J\r\x08",
    "separators of paths": "../../a/b\\c:d|e",
    "right to left": "\u202eזלזלה\u2066 العربية\u2028",
    "long": "n" * 10_000,
    "bytes that are not text": "\udcff\udc80",
    "other scripts": "地震 землетрясение 🌋",
}


@pytest.mark.parametrize("name", NAMES.values(), ids=NAMES)
def test_a_terminal_shows_a_name_as_it_is(name, capsys):
    console().print(name)
    show_table(name, (name,), [(name,)])
    output = capsys.readouterr().out
    assert not set(output) & set("\x1b\x07\x08\r\x9b\u202e\u2066\u2028")
    if len(name) < 100 and printable(name) == name:
        assert output.count(name.strip()) >= 2


def test_names_of_motions_are_kept_in_results(tmp_path, capsys):
    names = list(NAMES.values())[:6]
    dataset = ellipse_dataset()
    labels = [*names, *dataset["motion"].values.tolist()[len(names) :]]
    write_ellipses(dataset.assign_coords(motion=labels), tmp_path / "ellipses.nc")
    for options in (["--json", "-"], []):
        source = ["--ellipses", str(tmp_path / "ellipses.nc"), "--confidence", "0.8"]
        assert run(["criterion", *source, *options]) == 0
        assert "\x1b" not in capsys.readouterr().out


@pytest.mark.parametrize("name", ["[bold].AT2", "\x1b[31m.AT2", "a" * 240 + ".AT2", "<b>$x$#.AT2"])
def test_records_of_any_name_are_listed(tmp_path, capsys, name):
    (tmp_path / name).write_text(AT2)
    for options in ([], ["--json", "-"]):
        assert run(["motions", "list", str(tmp_path), *options]) == 0
        text = capsys.readouterr()
        assert "\x1b" not in text.out
        assert not text.err


@pytest.mark.slow
def test_a_record_with_an_undecodable_name_is_listed(tmp_path):
    (tmp_path / os.fsdecode(b"\xff\xfe.AT2")).write_text(AT2)
    program = "from reliab.app.cli import main; main()"
    arguments = [sys.executable, "-c", program, "motions", "list", str(tmp_path), "--json", "-"]
    process = subprocess.run(arguments, capture_output=True, check=False)  # noqa: S603 - this very package
    assert process.returncode == 0, process.stderr
    assert b"udcff" in process.stdout


def test_an_error_names_a_file_without_steering_the_terminal(tmp_path, capsys):
    assert run(["diagnose", str(tmp_path / "\x1b[2J")]) == 2
    errors = capsys.readouterr().err
    assert "\x1b[2J" not in errors
    assert r"\x1b[2J" in errors


@pytest.mark.slow
def test_a_campaign_and_its_tests_may_have_any_names(tmp_path, capsys):
    name = "".join(NAMES[kind] for kind in ("typst", "html", "markup of Rich", "separators of paths"))
    content = dict(campaign()[0])
    text = content["campaign.toml"].decode()
    text = text.replace('"small"', json.dumps(f"{name}\x1b[31m")).replace(
        '"one"', json.dumps(f"\u202e{name}")
    )
    write({**content, "campaign.toml": text.encode()}, tmp_path / "campaign")
    assert run(["diagnose", str(tmp_path / "campaign"), "--out", str(tmp_path / "out")]) == 0
    output = capsys.readouterr().out
    assert not set(output) & set("\x1b\u202e")
    assert "[bold]a[/bold]" in output
    assert sorted(path.name for path in tmp_path.iterdir()) == ["campaign", "out"]
    assert (tmp_path / "out/report.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.slow
def test_tests_are_judged_and_followed_whatever_their_files_are_called(tmp_path, capsys):
    name = "".join([*NAMES.values()][:6])
    path = tmp_path / f"{name.replace('/', '_')}.csv"
    path.write_bytes(campaign()[0]["a.csv"])
    assert run(["assess", str(path), "--f", "1", "--xi", "0.05"]) == 0
    path_again = path.with_stem(f"{path.stem} again")
    path_again.write_bytes(path.read_bytes())
    assert run(["assess", str(path), str(path_again), "--f", "1", "--xi", "0.05"]) == 0
    run(["monitor", str(path), "--f", "1", "--xi", "0.05", "--wait", "0.05"])
    text = "".join(capsys.readouterr())
    assert not set(text) & set("\x1b\x07\x08\r\x9b\u202e\u2066\u2028")

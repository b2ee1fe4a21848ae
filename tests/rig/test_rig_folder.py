"""The folder of a rig, and its commands."""

import csv
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from rig_rows import keep, rig_test

from reliab.app.api.rigs import export_rig, list_rig
from reliab.app.cli import run
from reliab.core.errors import InputError
from reliab.rig.rig_folder import RigFolder, require_date

ROOT = Path(__file__).parents[2]
WRITER = """
import sys
sys.path[:0] = {paths!r}
from pathlib import Path
from rig_rows import keep, rig_test
for number in range({first}, {last}):
    keep(Path({folder!r}), rig_test(number))
"""


def writer(folder, first, last):
    """Start a process that adds tests."""
    code = WRITER.format(
        paths=[str(ROOT), str(ROOT / "tests/rig")], folder=str(folder), first=first, last=last
    )
    return subprocess.Popen([sys.executable, "-c", code])  # noqa: S603


def names(folder):
    return [row["name"] for row in RigFolder.open(folder).table().rows]


def test_tests_are_listed_in_the_order_of_their_dates(tmp_path):
    keep(tmp_path, rig_test(1, date="2026-02-01"), rig_test(2, date="2026-01-15"), rig_test(3))
    assert names(tmp_path) == ["test_3.csv", "test_2.csv", "test_1.csv"]


def test_the_table_is_made_again_when_it_is_lost_or_damaged(tmp_path):
    keep(tmp_path, rig_test(1, covariates={"current": 0.4}), rig_test(2, note="line\nbreak, =1+1", rms=None))
    folder = RigFolder.open(tmp_path)
    rows = folder.table().rows
    assert folder.table().rows == rows
    for damage in ("", "sha256,name\nx", "\x00\x01"):
        (tmp_path / "table.csv").write_text(damage)
        assert folder.table().rows == rows
    (tmp_path / "table.csv").unlink()
    assert folder.table().rows == rows
    assert rows[0]["current"] == 0.4


def test_no_text_of_the_table_is_a_formula(tmp_path):
    texts = {"note": "=1+1", "name": "@x", "covariates": {"=y": 1.0}}
    keep(tmp_path, rig_test(1, **texts), rig_test(2))
    rows = RigFolder.open(tmp_path).table().rows
    assert RigFolder.open(tmp_path).table().rows == rows
    assert rows[0]["note"] == "=1+1"
    with (tmp_path / "table.csv").open(encoding="utf-8") as table:
        cells = [cell for row in csv.reader(table) for cell in row]
    assert "'=1+1" in cells
    assert not any(cell.startswith(("=", "@")) for cell in cells)


def test_reading_a_copy_of_a_rig_does_not_write(tmp_path):
    keep(tmp_path, rig_test(1, note="a", A=0.99123), rig_test(2, covariates={"current": 0.4}, rms=None))
    folder, table = RigFolder.open(tmp_path), tmp_path / "table.csv"
    rows, text = folder.table().rows, table.read_bytes()
    for file in (tmp_path / "tests").iterdir():
        os.utime(file, (1.0, 1.0))
    second = folder.table().rows
    assert table.read_bytes() == text
    assert [{**row, "file_state": ""} for row in second] == [{**row, "file_state": ""} for row in rows]
    keep(tmp_path, rig_test(3))
    assert len(folder.table()) == 3
    assert table.read_bytes() != text


def test_edited_row_is_read_from_its_test_again(tmp_path):
    keep(tmp_path, rig_test(1, A=0.99123), rig_test(2, note="a\r\nb"))
    folder, cache = RigFolder.open(tmp_path), tmp_path / "table.csv"
    rows = folder.table().rows
    sound = cache.read_bytes()
    for broken in (sound.replace(b"0.99123", b"nan"), sound.replace(b",xi,", b",alpha,"), sound[:-20]):
        cache.write_bytes(broken)
        assert folder.table().rows == rows
        assert cache.read_bytes() == sound


@pytest.mark.slow
def test_many_tests_are_listed_without_reading_them_again(tmp_path, monkeypatch):
    keep(tmp_path, rig_test(0))
    first = next((tmp_path / "tests").iterdir())
    content = json.loads(first.read_text())
    for number in range(1, 1000):
        content["test"] = rig_test(number).to_dict()
        (tmp_path / "tests" / f"{content['test']['sha256']}.json").write_text(json.dumps(content))
    assert len(RigFolder.open(tmp_path).table()) == 1000
    monkeypatch.setattr(RigFolder, "read", None)
    began = time.process_time()
    assert len(list_rig(tmp_path).to_dict()["tests"]) == 1000
    assert time.process_time() - began < 0.5


def test_table_follows_other_processes(tmp_path):
    keep(tmp_path, rig_test(1), rig_test(2))
    folder = RigFolder.open(tmp_path)
    assert len(folder.table()) == 2
    keep(tmp_path, rig_test(3))
    folder.remove(rig_test(1).sha256)
    keep(tmp_path, rig_test(2, A=0.5))
    assert [(row["name"], row["A"]) for row in folder.table().rows] == [
        ("test_2.csv", 0.5),
        ("test_3.csv", 0.99),
    ]


def test_a_damaged_test_is_named_and_costs_no_other(tmp_path):
    keep(tmp_path, rig_test(1), rig_test(2))
    path = next((tmp_path / "tests").glob("*.json"))
    content = json.loads(path.read_text())
    for damage in ("{", json.dumps({**content, "test": {**content["test"], "A": "1"}})):
        path.write_text(damage)
        table = RigFolder.open(tmp_path).table()
        assert len(table) == 1
        assert set(table.faults) == {path.name}


def test_a_link_in_a_folder_is_refused(tmp_path):
    keep(tmp_path, rig_test(1))
    (tmp_path / "tests" / f"{'0' * 64}.json").symlink_to("/etc/passwd")
    with pytest.raises(InputError, match="must not contain links"):
        RigFolder.open(tmp_path).table()


def test_a_test_is_known_by_its_name_or_the_beginning_of_its_checksum(tmp_path):
    keep(tmp_path, rig_test(1), rig_test(2), rig_test(3, name="test_2.csv"))
    folder = RigFolder.open(tmp_path)
    assert folder.find(rig_test(2).sha256[:8])["name"] == "test_2.csv"
    assert folder.find("test_1.csv")["sha256"] == rig_test(1).sha256
    for name in ("test_2.csv", "nothing", ""):
        with pytest.raises(InputError, match="of the name or checksum"):
            folder.find(name)


def test_folder_without_rig_is_refused(tmp_path):
    for place in (tmp_path, tmp_path / "nowhere"):
        with pytest.raises(InputError, match=r"This folder is no rig|No such folder"):
            RigFolder.open(place)


@pytest.mark.parametrize("text", ["yesterday", "2026-13-01", ""])
def test_invalid_date_is_refused(text):
    with pytest.raises(InputError, match="neither a day nor a time"):
        require_date(text)


@pytest.mark.slow
@pytest.mark.parametrize("count", [2, pytest.param(40, marks=pytest.mark.slow)])
def test_two_writers_at_once_lose_no_test(tmp_path, count):
    writers = [writer(tmp_path, 0, count), writer(tmp_path, count // 2, count + count // 2)]
    while any(process.poll() is None for process in writers):
        if (tmp_path / "tests").is_dir():
            assert not RigFolder.open(tmp_path).table().faults
        time.sleep(0.05)
    assert [process.wait() for process in writers] == [0, 0]
    assert sorted(names(tmp_path)) == sorted(f"test_{number}.csv" for number in range(count + count // 2))


@pytest.mark.slow
def test_a_killed_writer_loses_nothing_and_leaves_nothing_behind(tmp_path):
    for attempt in range(12):
        folder = tmp_path / str(attempt)
        process = writer(folder, 0, 2000)
        while not (folder / "tests").is_dir():
            time.sleep(0.01)
        time.sleep(0.02 * attempt)
        first = set(names(folder))
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        keep(folder, rig_test(5000))
        second = set(names(folder))
        assert first | {"test_5000.csv"} <= second
        assert not RigFolder.open(folder).table().faults
        for row in RigFolder.open(folder).table().rows:
            assert RigFolder(folder).record_path(row["sha256"]).is_file()
        assert not [*folder.rglob(".unfinished-*")]


def test_a_test_under_the_name_of_another_and_one_of_other_kinds_are_left_out_with_the_reason(tmp_path):
    keep(tmp_path, rig_test(1), rig_test(2), rig_test(3))
    paths = {path.stem: path for path in (tmp_path / "tests").iterdir()}
    first, second = (paths[rig_test(number).sha256] for number in (1, 2))
    second.write_text(first.read_text())
    content = json.loads(first.read_text())
    content["test"]["A"] = "0.99"
    first.write_text(json.dumps(content))
    table = RigFolder.open(tmp_path).table()
    assert [row["name"] for row in table.rows] == ["test_3.csv"]
    assert "checksum is not that of the file's name" in table.faults[second.name]
    assert "'0.99'" in table.faults[first.name]


STRUCTURE = ("--f", "1", "--xi", "0.02")


@pytest.fixture(scope="module")
def tests_of_lab(tmp_path_factory):
    """Two files of a rig that is 2 ms late."""
    folder = tmp_path_factory.mktemp("laboratory")
    time = np.arange(0.0, 12.0, 1.0 / 128.0)
    for seed in (1, 2):
        draw = np.random.default_rng(seed)
        phase = draw.uniform(0.0, 6.0)
        command = 0.02 * np.sin(2.0 * np.pi * time + phase) * np.sin(np.pi * time / 12.0) ** 2
        late = np.interp(time - 0.002, time, command) + 1e-5 * draw.normal(size=time.size)
        columns = {"time_s": time, "command_m": command, "measured_m": late}
        pd.DataFrame(columns).to_csv(folder / f"test_{seed}.csv", index=False)
    return folder


def run_command(capsys, *arguments):
    """What a command writes as JSON."""
    code = run([*map(str, arguments), "--json", "-"])
    out, err = capsys.readouterr()
    return code, json.loads(out) if out else None, err


def test_tests_are_added_once_listed_shown_exported_and_removed(tests_of_lab, tmp_path, capsys):
    rig, files = tmp_path / "rig", sorted(tests_of_lab.glob("*.csv"))
    declared_values = (*STRUCTURE, "--date", "2026-03-01", "--event", "KOBE", "--covariate", "current=0.4")
    code, content, _ = run_command(capsys, "rig", "add", rig, *files, *declared_values)
    assert (code, len(content["added"]), content["tests"]) == (0, 2, 2)
    assert content["added"][0]["d_ms"] == pytest.approx(2.0, abs=0.1)
    assert run_command(capsys, "rig", "add", rig, *files, *STRUCTURE)[1]["present"] == [
        "test_1.csv",
        "test_2.csv",
    ]
    code, _, err = run_command(capsys, "rig", "add", rig, files[0], "--f", "2")
    assert code == 2
    assert "f 2 now, 1 then" in err
    assert list_rig(rig).to_dict()["tests"][0]["current"] == 0.4
    _, content, _ = run_command(capsys, "rig", "show", rig, "test_1.csv")
    assert content["terms"]["event"] == "KOBE"
    assert content["assessment"]["A"] == content["test"]["A"]
    assert run(["assess", content["record"]]) == 0
    assert run(["rig", "show", str(rig), "test_1.csv"]) == run(["rig", "list", str(rig)]) == 0
    assert "KOBE" in capsys.readouterr().out
    assert export_rig(rig, tmp_path / "table.csv") == 2
    assert pd.read_csv(tmp_path / "table.csv")["event"].tolist() == ["KOBE", "KOBE"]
    assert run_command(capsys, "rig", "remove", rig, "test_1.csv")[1] == {"removed": ["test_1.csv"]}
    assert [row["name"] for row in list_rig(rig).to_dict()["tests"]] == ["test_2.csv"]


def test_invalid_file_costs_no_other(tests_of_lab, tmp_path, capsys):
    (tmp_path / "wrong.csv").write_text("no,test\n")
    good = tests_of_lab / "test_1.csv"
    code, content, err = run_command(
        capsys, "rig", "add", tmp_path / "rig", tmp_path / "wrong.csv", good, *STRUCTURE
    )
    assert code == 2
    assert list(content["faults"]) == [str(tmp_path / "wrong.csv")]
    assert len(content["added"]) == 1
    assert "the other tests are in the rig" in err


@pytest.mark.parametrize("text", ["current", "A=1", "current=much", "=3"])
def test_a_covariate_is_a_new_name_with_a_number(text, tmp_path, capsys):
    code = run(["rig", "add", str(tmp_path / "rig"), "sample_test", *STRUCTURE, "--covariate", text])
    assert code == 2
    assert "Error:" in capsys.readouterr().err

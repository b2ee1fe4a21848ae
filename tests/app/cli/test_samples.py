"""`reliab samples` writes what ships, and nothing over other files."""

import pytest

from reliab import read_campaign
from reliab.app.cli import run
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.discrepancy.campaign.reading import campaign_folder

TEST = "datasets/sample_test/test.csv"


@pytest.fixture
def empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_samples_are_written_once_and_kept(empty_folder):
    assert run(["samples"]) == run(["samples"]) == 0
    assert (empty_folder / TEST).read_bytes() == shipped("datasets", "sample_test/test.csv").read_bytes()
    assert read_campaign("datasets/campaigns/rig_c").tests
    assert (empty_folder / "datasets/frames/benchmark_case_1.toml").is_file()


def test_a_file_of_another_content_is_not_written_over(empty_folder, capsys):
    sample_file = empty_folder / TEST
    sample_file.parent.mkdir(parents=True)
    sample_file.write_text("my test", encoding="utf-8")
    assert run(["samples"]) == 2
    assert "nothing was written" in capsys.readouterr().err
    assert [path for path in empty_folder.rglob("*") if path.is_file()] == [sample_file]
    assert sample_file.read_text(encoding="utf-8") == "my test"


def test_an_unwritable_folder_is_named(empty_folder, capsys):
    (empty_folder / "file").write_text("no folder", encoding="utf-8")
    assert run(["samples", "file"]) == 2
    assert "file: Cannot write to the folder for the samples" in capsys.readouterr().err


def test_a_local_campaign_goes_before_a_shipped_one(empty_folder):
    (empty_folder / "rig_b").mkdir()
    assert campaign_folder("rig_b") == shipped("datasets", "campaigns/rig_b")
    (empty_folder / "rig_b" / "campaign.toml").write_text("title = ")
    assert not campaign_folder("rig_b").is_absolute()
    with pytest.raises(InputError, match=r"rig_b.campaign\.toml"):
        read_campaign("rig_b")


@pytest.mark.slow
def test_a_shipped_test_is_followed_by_name(empty_folder, capsys):
    code = run(
        ["monitor", "sample_test", "--f", "1", "--xi", "0.02", "--wait", "0.1", "--json", "times.jsonl"]
    )
    assert code in (0, 1)
    assert (empty_folder / "times.jsonl").read_text(encoding="utf-8").count("\n") > 5
    assert "Error" not in capsys.readouterr().err

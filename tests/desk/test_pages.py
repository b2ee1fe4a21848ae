"""All pages in a real browser without a window; skipped where there is none."""

import json
import subprocess
import sys
import time
import urllib.error
import urllib.request
import zipfile

import pytest
from headless_browser import programs, start

pytest.importorskip("selenium", reason="the browser is driven by selenium, and there is none here")
from desk_browser import DeskBrowser

from reliab.core.shipped import shipped

SAMPLE = shipped("datasets", "sample_test/test.csv")
PAGES = ("judge", "before", "live", "compare", "rig", "diagnose")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("laboratory")


@pytest.fixture(scope="module")
def address(folder):
    command = [sys.executable, "-m", "reliab", "desk", str(folder), "--no-browser", "--json", "-"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as desk:  # noqa: S603
        output = ""
        while not output.rstrip().endswith("}"):
            output += desk.stdout.readline()
        yield json.loads(output)["address"]
        desk.send_signal(2)  # Ctrl+C
        assert desk.wait(30) == 0
    assert [path.name for path in folder.iterdir() if path.name.startswith(".")] == []


@pytest.fixture(scope="module")
def chrome(tmp_path_factory):
    if programs() is None:
        pytest.skip("neither chromium nor its driver is installed here")
    workers = start(tmp_path_factory.mktemp("profile"), width=1280, height=1000)
    yield workers
    workers.quit()


@pytest.fixture
def desk(chrome, address):
    chrome.set_window_size(1280, 1000)
    return DeskBrowser(chrome, address)


def _judge_sample(desk):
    desk.open("")  # the address as it is printed
    desk.drop(SAMPLE)
    desk.wait_for("What was recognised in test.csv")
    desk.state_structure()
    desk.press("Judge this test")
    desk.wait_for("98 % likely to be below 5 %")
    desk.wait_for("The whole report")


def test_a_dropped_test_is_shown_and_judged(desk):
    _judge_sample(desk)
    assert "/judge?desk=" in desk.chrome.current_url
    assert "256 samples a second" in desk.text()
    desk.press("Scale of the displacement sensor")
    desk.wait_for("If you knew it exactly")
    assert "reliab assess test.csv --f '1±0.01' --xi '0.02±0.002'" in desk.text()
    assert {url.split("/")[2] for url in desk.requests() if url.startswith("http")} == {
        desk.address.split("/")[2]
    }
    assert desk.complaints() == []


@pytest.mark.slow
def test_a_judged_test_is_accessible_and_a_reload_loses_nothing(desk):
    _judge_sample(desk)
    assert desk.inaccessible() == {}
    desk.chrome.refresh()
    desk.wait_for("98 % likely to be below 5 %")
    desk.wait_for("The whole report")
    assert desk.complaints() == []


def test_requests_without_the_token_or_of_other_origins_are_not_answered(address):
    root = address.rsplit("/", 2)[0]
    for url, headers in (
        (f"{root}/judge", {}),
        (f"{root}/", {}),
        (f"{root}/static/js/bokeh.min.js", {}),
        (f"{address}judge", {"Origin": "http://evil.example"}),
        (f"{address}judge", {"Host": "evil.example"}),
        (
            f"{address}judge/ws",
            {"Origin": "http://evil.example", "Upgrade": "websocket", "Connection": "Upgrade"},
        ),
    ):
        with pytest.raises(urllib.error.HTTPError) as refusal:
            urllib.request.urlopen(urllib.request.Request(url, headers=headers))  # noqa: S310 - of this machine
        with refusal.value:
            assert refusal.value.code == 404
    with urllib.request.urlopen(f"{address}judge") as page:  # noqa: S310
        assert page.status == 200


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES)
def test_every_page_is_accessible_and_fits_wide_and_narrow_windows(desk, page):
    for width in (1280, 800):
        desk.chrome.set_window_size(width, 1000)
        desk.open(page)
        assert not desk.overflows(), width
    assert desk.inaccessible() == {}
    assert desk.complaints() == []


@pytest.mark.slow
def test_wrong_files_are_refused_with_a_sentence_and_their_names_are_no_markup(desk, tmp_path):
    desk.open("judge")
    path = tmp_path / "<img src=x onerror=document.title='owned'>.csv"
    path.write_text("<svg onload=document.title='owned'>,1\n" * 90, encoding="utf-8")
    desk.drop(path)
    desk.wait_for("No rows of at least two numbers")
    assert "--delimiter" in desk.text()
    noise = tmp_path / "noise.mat"
    noise.write_bytes(bytes(range(256)) * 20)
    desk.drop(noise)
    desk.wait_for("reliab does not read")
    assert "owned" not in desk.chrome.title
    desk.press("Judge this test")
    desk.until(lambda: "Judge this test" in desk.text())
    assert desk.complaints() == []


@pytest.mark.slow
def test_a_correction_changes_the_drawing_and_the_verdict_as_on_the_command_line(desk, tmp_path):
    text = SAMPLE.read_text(encoding="utf-8").replace("command_m", "first").replace("measured_m", "second")
    (tmp_path / "plain.csv").write_text(text, encoding="utf-8")
    desk.open("judge")
    desk.drop(tmp_path / "plain.csv")
    desk.wait_for("Column of measured")
    desk.choose("Column of command", "first")
    time.sleep(0.5)
    desk.choose("Column of measured", "second")
    desk.wait_for("256 samples a second")
    assert 'column = "second"' in desk.text()
    desk.state_structure()
    desk.press("Judge this test")
    desk.wait_for("98 % likely to be below 5 %")
    assert "--channels channels.toml" in desk.text()


@pytest.mark.slow
def test_two_tabs_do_not_mix(desk, tmp_path):
    (tmp_path / "other.csv").write_bytes(SAMPLE.read_bytes())
    desk.open("judge")
    desk.drop(SAMPLE)
    desk.wait_for("What was recognised in test.csv")
    first = desk.chrome.current_window_handle
    desk.chrome.switch_to.new_window("tab")
    desk.open("judge")
    assert "test.csv" not in desk.text()
    desk.drop(tmp_path / "other.csv")
    desk.wait_for("What was recognised in other.csv")
    second = desk.chrome.current_window_handle
    desk.chrome.switch_to.window(first)
    assert "other.csv" not in desk.text()
    desk.chrome.switch_to.window(second)
    desk.chrome.close()
    desk.chrome.switch_to.window(first)


@pytest.mark.slow
def test_the_region_follows_the_sliders_by_keyboard_and_shows_a_rig_and_a_record(desk, tmp_path):
    desk.open("before")
    desk.wait_for("but not both at once")
    slider = next(item for item in desk.elements("input[type=range]") if item.get_attribute("max") == "0.1")
    original = desk.text()
    slider.send_keys("\ue014" * 10)  # right arrow
    desk.until(lambda: desk.text() != original)
    desk.wait_for("--xi 0.03")
    desk.choose("Show the tests of a rig", "the rig that comes with reliab")
    motion = tmp_path / "motion.csv"
    samples = (f"{0.01 * k:.2f},{0.3 * (k % 83 - 41) / 41:.4f}" for k in range(2000))
    motion.write_text("time [s],acceleration [g]\n" + "\n".join(samples), encoding="utf-8")
    assert desk.count_points("own record") == 0
    desk.drop(motion)
    desk.until(lambda: desk.count_points("own record") > 0)
    assert "alert" not in desk.text()


@pytest.mark.slow
def test_a_growing_file_is_followed_to_its_verdict(desk, folder):
    lines = SAMPLE.read_text(encoding="utf-8").splitlines(keepends=True)
    path = folder / "running.csv"
    path.write_text("".join(lines[:3000]), encoding="utf-8")
    desk.open("live")
    desk.choose("File in the folder of the desk", "running.csv")
    desk.state_structure()
    desk.fill("It has ended when nothing comes for [s]", "4")
    desk.press("Follow")
    desk.wait_for("so far")
    with path.open("a", encoding="utf-8") as file:
        file.writelines(lines[3000:])
    desk.wait_for("likely to be below 5 %", 200)
    desk.wait_for("The whole report")
    assert desk.inaccessible() == {}


@pytest.mark.slow
def test_tests_are_compared_and_may_be_removed(desk, tmp_path):
    (tmp_path / "none.csv").write_bytes(SAMPLE.read_bytes())
    desk.open("compare")
    desk.press("Compare")
    desk.wait_for("A comparison needs two tests or more")
    for path in (SAMPLE, tmp_path / "none.csv"):
        desk.drop(path)
        desk.until(lambda path=path: desk.text().count(path.name) > 2)
    desk.state_structure()
    desk.press("Compare")
    desk.wait_for("Ranked by error")
    assert desk.inaccessible() == {}
    desk.press("Remove all tests")
    desk.wait_for("No file yet")
    assert "Ranked by error" not in desk.text()


@pytest.mark.slow
def test_the_history_of_a_rig_is_shown(desk):
    desk.open("rig")
    desk.press("Show the rig")
    desk.wait_for("What to expect of the next test", 200)
    assert desk.inaccessible() == {}


@pytest.mark.slow
def test_a_diagnosis_survives_a_reload_and_is_cancelled(desk, tmp_path):
    campaign = shipped("datasets", "campaigns") / "rig_a"
    with zipfile.ZipFile(tmp_path / "campaign.zip", "w") as archive:
        for path in campaign.iterdir():
            archive.write(path, f"rig/{path.name}")
    desk.open("diagnose")
    desk.drop(tmp_path / "campaign.zip")
    desk.until(lambda: desk.text().count("campaign.zip") > 2)
    desk.press("Diagnose")
    desk.wait_for("Searching the blocks")
    desk.chrome.refresh()
    desk.wait_for("Searching the blocks")
    desk.press("Cancel")
    desk.until(lambda: "Searching" not in desk.text())
    archive = tmp_path / "evil.zip"
    with zipfile.ZipFile(archive, "w") as archive_file:
        archive_file.writestr("../campaign.toml", "x")
    desk.press("Remove all files")
    desk.drop(archive)
    desk.until(lambda: desk.text().count("evil.zip") > 2)
    desk.press("Diagnose")
    desk.wait_for("A file of an archive must lie in it")

"""The page in a real browser without a window; skipped where there is none."""

import json
import re
import time

import layouts
import numpy as np
import pandas as pd
import pytest
from headless_browser import PATIENCE, programs, start

from reliab.assessment.assess import assess
from reliab.core.shipped import shipped
from reliab.explore.page import write_page
from reliab.recordings.reading import read_recording
from reliab.structures.structure import Structure

selenium = pytest.importorskip("selenium", reason="the browser is driven by selenium, and there is none here")
SAMPLE = shipped("datasets", "sample_test/test.csv")
VERDICT = re.compile(r"\b(reliable|unreliable|undecided)\b|error of this test")


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    if programs() is None:
        pytest.skip("neither chromium nor its driver is installed here")
    chrome = start(tmp_path_factory.mktemp("profile"))
    yield chrome
    chrome.quit()


@pytest.fixture(scope="module")
def address(shipped_ellipses, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "criterion.html"
    write_page(path, shipped_ellipses, source="a test")
    return path.as_uri()


@pytest.fixture
def page(browser, address):
    browser.get(address)
    until(browser, "return Boolean(document.documentElement.dataset.ready)")
    return browser


def until(browser, question):
    end = time.monotonic() + PATIENCE
    while not browser.execute_script(question):
        assert time.monotonic() < end, question
        time.sleep(0.05)


def text(browser, name):
    return browser.execute_script("return document.getElementById(arguments[0]).textContent", name)


def drop(browser, path):
    """Drop a file and wait until the page says something of it."""
    browser.execute_script("document.getElementById('test-name').textContent = ''")
    browser.find_element("id", "file").send_keys(str(path))
    until(
        browser,
        "return ['test-name', 'problem'].some((name) => document.getElementById(name).textContent !== '')",
    )


def test_a_dropped_test_is_placed_and_left_to_assess_and_nothing_is_requested(page, address):
    drop(page, SAMPLE)
    python = assess(read_recording(SAMPLE), Structure(frequency=1.0, damping_ratio=0.02))
    numbers = text(page, "numbers")
    assert f"{python.tracking.amplitude:.5f}" in numbers
    assert f"{1e3 * python.tracking.delay:.4f} ms" in numbers
    assert f"{python.population.index:#.4g}: inside the region" in numbers
    place = f"motions{python.scope.position}: length of the record 40.0 s"
    assert f"{place}; range of the motions 9.97 to " in numbers
    assert text(page, "command") == "reliab assess test.csv --f 1 --xi 0.02"
    assert not VERDICT.search(page.find_element("tag name", "body").text)
    requests = [
        message["params"]
        for entry in page.get_log("performance")
        if (message := json.loads(entry["message"])["message"])["method"] == "Network.requestWillBeSent"
    ]
    by_page = [
        each for each in requests if not each["documentURL"].startswith("chrome://")
    ]  # a new profile's
    assert {each["request"]["url"] for each in by_page} == {address}
    assert page.get_log("browser") == []


def test_of_a_test_outside_of_the_motions_no_share_is_promised(page, tmp_path):
    """The sample, after which the rig is at rest for longer than any record lasts."""
    header, *lines = SAMPLE.read_text(encoding="utf-8").splitlines()
    still = lines[-1].partition(",")[2]
    rows = len(lines) - 1  # below the names
    moments = np.arange(rows, rows + 70 * 256) / 256.0
    resting = [f"{moment:.6f},{still}" for moment in moments]
    path = tmp_path / "long.csv"
    path.write_text("\n".join([header, *lines, *resting]), encoding="utf-8")
    drop(page, path)
    assert "motionsoutside: length of the record 110" in text(page, "numbers")
    assert "none: the criterion does not cover such a test" in text(page, "numbers")
    assert text(page, "meaning").startswith("No share of the population's ground motions is promised for")


def test_a_file_that_is_no_text_is_answered_with_the_command_that_makes_one(page, tmp_path):
    drop(page, layouts.tdms(tmp_path))
    assert "`reliab record FILE --csv TEST.csv`" in text(page, "problem")
    assert text(page, "test-name") == ""


def test_hostile_names_and_content_do_nothing(page, tmp_path):
    path = tmp_path / "<img src=x onerror=document.title='owned'>.csv"
    rows = SAMPLE.read_text(encoding="utf-8").replace("time_s", "time_s", 1)
    path.write_text(f"# <script>document.title='owned'</script>\n{rows}", encoding="utf-8")
    drop(page, path)
    assert text(page, "test-name") == path.name
    assert text(page, "command") == "reliab assess FILE --f 1 --xi 0.02"
    bad = tmp_path / "bad.csv"
    bad.write_text("<svg onload=document.title='owned'>,1\n" * 90, encoding="utf-8")
    drop(page, bad)
    assert text(page, "problem").startswith("bad.csv")
    page.execute_script(
        "const script = document.createElement('script');"
        "script.textContent = \"document.title='owned'\"; document.body.append(script)"
    )
    assert "owned" not in page.title
    assert page.execute_script("return document.querySelectorAll('img, #test script').length") == 0


def test_sliders_answer_to_the_keyboard_and_the_region_follows(page):
    before = text(page, "answer")
    slider = page.find_element("id", "damping")
    slider.send_keys("\ue014" * 20)  # right arrow
    assert text(page, "damping-value") == "4 %"
    assert text(page, "answer") != before
    plane = page.find_element("id", "plane")
    page.execute_script("arguments[0].focus()", plane)
    plane.send_keys("\ue013" * 3)  # up arrow: a later actuator
    assert "accepted" in text(page, "probe")
    assert "A = 1.0000" in text(page, "probe")


def test_two_criteria_stand_side_by_side(page):
    page.find_element("id", "keep").click()
    page.find_element("id", "confidence").send_keys("\ue012" * 10)
    assert "95 % of motions" in text(page, "compared-hint")
    regions = (
        "return ['region', 'compared']"
        ".map((name) => document.querySelector(`#plane .${name}`).getAttribute('d'))"
    )
    own, compared = page.execute_script(regions)
    assert own != compared
    page.execute_script(
        "const e = document.getElementById('compared'); e.value = 'printed';"
        "e.dispatchEvent(new Event('input', {bubbles: true}))"
    )
    assert page.execute_script(regions)[1] not in (own, compared)
    until(page, "return document.querySelectorAll('#delay-law .band').length === 1")


def said(browser):
    """All that the page says of a test, at this moment."""
    return browser.execute_script(
        "const test = document.getElementById('test');"
        "return [test.hidden ? '' : test.innerText, document.querySelectorAll('#plane .test-mark').length]"
    )


@pytest.mark.parametrize("second", ["good", "refused"])
def test_nothing_of_the_old_test_stays_when_another_file_is_read(page, tmp_path, second):
    other = tmp_path / "other.csv"
    table = pd.read_csv(SAMPLE, comment="#")
    table["measured_m"] *= 0.97
    (table if second == "good" else table[["time_s", "command_m"]]).to_csv(other, index=False)
    drop(page, SAMPLE)
    numbers = page.execute_script(  # A and index, which the other test does not share
        "return [0, 2].map((row) => document.querySelectorAll('#numbers td')[row].textContent)"
    )
    page.execute_script(  # what the page says after each change of it, from the moment of the file on
        "document.addEventListener('change', () => { window.seen = []; }, true);"
        "const test = document.getElementById('test'), look = () => window.seen?.push(test.hidden ? '' :"
        " test.innerText); new MutationObserver(look).observe("
        "document.body, {subtree: true, childList: true, characterData: true, attributes: true});"
    )
    page.find_element("id", "file").send_keys(str(other))
    if second == "good":
        until(page, "return document.getElementById('test-name').textContent === 'other.csv'")
    else:
        until(page, "return document.getElementById('problem').textContent !== ''")
        assert said(page) == ["", 0]
    seen = page.execute_script("return window.seen")
    assert seen[0] == ""
    assert all(number not in shown for shown in seen for number in numbers)


def test_of_two_files_dropped_at_once_the_last_is_shown(page, tmp_path):
    other = tmp_path / "other.csv"
    other.write_text(SAMPLE.read_text(encoding="utf-8"), encoding="utf-8")
    page.find_element("id", "file").send_keys(str(SAMPLE))
    page.find_element("id", "file").send_keys(str(other))
    until(page, "return document.getElementById('test-name').textContent === 'other.csv'")
    assert text(page, "command").startswith("reliab assess other.csv ")


@pytest.mark.slow
def test_the_command_follows_the_sliders_and_is_copied(page):
    drop(page, SAMPLE)
    page.find_element("id", "damping").send_keys("\ue014" * 10)  # right arrow
    page.find_element("id", "share").send_keys("\ue012" * 10)  # left arrow
    page.find_element("id", "frequency-deviation").send_keys("\ue014" * 10)
    command = "reliab assess test.csv --f 1±0.01 --xi 0.03 --alpha 0.9"
    assert text(page, "command") == command
    page.find_element("id", "copy").click()
    assert page.execute_script("return String(getSelection())") == command

"""The page in a real browser without a window; skipped where there is none."""

import json
import time

import pytest
from headless_browser import PATIENCE, programs, start

from reliab.explore.page import write_page

selenium = pytest.importorskip("selenium", reason="the browser is driven by selenium, and there is none here")


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
    wait_until(browser, "return Boolean(document.documentElement.dataset.ready)")
    return browser


def wait_until(browser, question):
    end = time.monotonic() + PATIENCE
    while not browser.execute_script(question):
        assert time.monotonic() < end, question
        time.sleep(0.05)


def text(browser, name):
    return browser.execute_script("return document.getElementById(arguments[0]).textContent", name)


def test_the_page_requests_nothing_and_complains_of_nothing(page, address):
    requests = [
        message["params"]
        for entry in page.get_log("performance")
        if (message := json.loads(entry["message"])["message"])["method"] == "Network.requestWillBeSent"
    ]
    browser_addresses = ("chrome://", "chrome-untrusted://")  # its own page of a new profile
    page_requests = [row for row in requests if not row["documentURL"].startswith(browser_addresses)]
    assert {row["request"]["url"] for row in page_requests} == {address}
    assert page.get_log("browser") == []


def test_sliders_answer_to_the_keyboard_and_the_region_follows(page):
    original = text(page, "answer")
    slider = page.find_element("id", "damping")
    slider.send_keys("\ue014" * 20)  # right arrow
    assert text(page, "damping-value") == "4 %"
    assert text(page, "answer") != original
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
    own_region, other_region = page.execute_script(regions)
    assert own_region != other_region
    page.execute_script(
        "const e = document.getElementById('compared'); e.value = 'printed';"
        "e.dispatchEvent(new Event('input', {bubbles: true}))"
    )
    assert page.execute_script(regions)[1] not in (own_region, other_region)
    wait_until(page, "return document.querySelectorAll('#delay-law .band').length === 1")


@pytest.mark.slow
def test_the_command_follows_the_sliders_and_is_copied(page):
    page.find_element("id", "damping").send_keys("\ue014" * 10)  # right arrow
    page.find_element("id", "share").send_keys("\ue012" * 10)  # left arrow
    page.find_element("id", "frequency-deviation").send_keys("\ue014" * 10)
    command = "reliab assess TEST.csv --f 1±0.01 --xi 0.03 --alpha 0.9"
    assert text(page, "command") == command
    page.find_element("id", "copy").click()
    assert page.execute_script("return String(getSelection())") == command

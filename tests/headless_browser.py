"""Chromium without a window, driven by selenium, that knows no user and asks no network."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from selenium.webdriver import Chrome

PATIENCE = 60.0  # seconds until a busy machine has answered
_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


def programs() -> tuple[str, str] | None:
    """Browser and driver; None where either is not installed."""
    browser = next(filter(None, map(shutil.which, _NAMES)), None)
    driver = shutil.which("chromedriver")
    return (browser, driver) if browser and driver else None


def start(profile: Path, *, width: int = 1400, height: int = 1600) -> Chrome:
    """Start the browser with an empty folder as its profile; its log and its requests are kept."""
    from selenium.webdriver import Chrome, ChromeOptions
    from selenium.webdriver.chrome.service import Service

    browser_and_driver = programs()
    if browser_and_driver is None:
        raise FileNotFoundError("neither chromium nor its driver is installed here")
    options = ChromeOptions()
    options.binary_location, driver = browser_and_driver
    for argument in (
        *("--headless=new", "--no-sandbox", "--disable-gpu", f"--window-size={width},{height}"),
        *(
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
        ),
        "--disable-dev-shm-usage",  # containers have 64 MB of it
        f"--user-data-dir={profile}",
    ):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    chrome = Chrome(options=options, service=Service(driver))
    chrome.set_script_timeout(PATIENCE)
    return chrome

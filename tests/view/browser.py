# SPDX-License-Identifier: MIT
"""The page of `gnomon view` in a real browser: Chromium, without a window, driven by selenium. GNOMON_SCREENSHOTS names
a folder that gets pictures of the page."""

import os
from pathlib import Path

import pytest
from conftest import Server

webdriver = pytest.importorskip("selenium.webdriver")
from selenium.webdriver.common.action_chains import ActionChains  # noqa: E402
from selenium.webdriver.common.by import By  # noqa: E402
from selenium.webdriver.support.ui import Select, WebDriverWait  # noqa: E402

Driver = webdriver.Chrome


def start(downloads: Path) -> Driver:
    options = webdriver.ChromeOptions()
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1000,600"):
        options.add_argument(argument)
    options.add_experimental_option("prefs", {"download.default_directory": str(downloads)})
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService("/usr/bin/chromedriver"))
    driver.downloads = downloads
    return driver


def wait(driver: Driver, script: str, seconds: float = 60) -> object:
    """Waits until the script's value is true."""
    return WebDriverWait(driver, seconds, poll_frequency=0.05).until(lambda d: d.execute_script("return " + script))


def settle(driver: Driver) -> None:
    """Waits until the last and best picture of what is looked at is shown."""
    wait(driver, "shown.facts !== null && !isDirty && inFlight === 0 && document.body.dataset.last === 'true'"
                 " && performance.now() - lastInput > 2 * stillAfterMs")


def open_page(driver: Driver, server: Server) -> None:
    driver.get(server.address)
    settle(driver)


def find(driver: Driver, name: str) -> "webdriver.remote.webelement.WebElement":
    return driver.find_element(By.ID, name)


def choose(driver: Driver, name: str, value: str) -> None:
    Select(find(driver, name)).select_by_value(value)


def screenshot(driver: Driver, name: str) -> None:
    if "GNOMON_SCREENSHOTS" in os.environ:
        driver.save_screenshot(str(Path(os.environ["GNOMON_SCREENSHOTS"]) / f"{name}.png"))


def drag(driver: Driver, x: int, y: int, key: str | None = None) -> None:
    actions = ActionChains(driver, duration=20)
    if key:
        actions.key_down(key)
    actions.move_to_element(find(driver, "stage")).click_and_hold().move_by_offset(x, y).release()
    if key:
        actions.key_up(key)
    actions.perform()


def command_of(driver: Driver) -> str:
    settle(driver)
    return find(driver, "command").text


def option(command: str, name: str) -> str:
    return next((word.split("=", 1)[1] for word in command.split() if word.startswith(f"--{name}=")), "")

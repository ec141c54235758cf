# SPDX-License-Identifier: MIT
"""What the page of `gnomon view` shows, and that its commands make the same."""

import base64
import io
from pathlib import Path

import pytest
from browser import (
    ActionChains,
    Driver,
    WebDriverWait,
    choose,
    command_of,
    drag,
    find,
    open_page,
    option,
    screenshot,
    settle,
    wait,
)
from conftest import Server
from PIL import Image
from selenium.webdriver.common.keys import Keys
from test_protocol import run


def test_loads_turns_and_copies_the_command(driver: Driver, sundial: Server, tmp_path: Path) -> None:
    open_page(driver, sundial)
    screenshot(driver, "desktop")
    first = command_of(driver)
    assert option(first, "eye") == "" and option(first, "samples") == "8"
    drag(driver, 120, 40)
    turned = command_of(driver)
    assert option(turned, "eye") not in ("", option(first, "eye"))
    find(driver, "stage").send_keys(Keys.ARROW_LEFT, Keys.ARROW_UP, "+", "w")
    settle(driver)
    by_keys = command_of(driver)
    assert option(by_keys, "eye") != option(turned, "eye")
    find(driver, "save").click()
    wait(driver, "true")
    saved = driver.downloads / "view.png"
    WebDriverWait(driver, 20).until(lambda _: saved.exists())
    assert run(by_keys, tmp_path).returncode == 0
    assert saved.read_bytes() == (tmp_path / "view.png").read_bytes()
    # What is shown is that picture, but for JPEG.
    shown = driver.execute_script("return picture.toDataURL('image/png').split(',')[1]")
    on_page = Image.open(io.BytesIO(base64.b64decode(shown))).convert("RGB")
    rendered = Image.open(tmp_path / "view.png")
    assert on_page.size == rendered.size
    difference = [abs(a - b) for a, b in zip(on_page.tobytes(), rendered.tobytes(), strict=True)]
    assert sum(difference) / len(difference) < 2
    find(driver, "reset").click()
    assert command_of(driver) == first


def test_moves_the_sun(driver: Driver, quick: Server) -> None:
    open_page(driver, quick)
    start = command_of(driver)
    drag(driver, 80, 30, Keys.SHIFT)
    by_drag = option(command_of(driver), "light-direction")
    assert by_drag not in ("", option(start, "light-direction"))
    dial = find(driver, "dial")
    ActionChains(driver, duration=20).move_to_element(dial).click_and_hold().move_by_offset(20, 0).release().perform()
    assert option(command_of(driver), "light-direction") != by_drag
    azimuth = float(driver.execute_script("return byId('azimuth').value"))
    assert abs(azimuth - 90) < 3  # east is to the right of north
    find(driver, "stage").send_keys("l", "i")
    assert option(command_of(driver), "light-direction") != by_drag
    find(driver, "stage").send_keys("r")


def test_asks_why_as_explain_does(driver: Driver, sundial: Server, tmp_path: Path) -> None:
    open_page(driver, sundial)
    answers = set()
    for x, y in ((0, 0), (60, 90), (-40, 60), (-200, 100)):
        ActionChains(driver).move_to_element_with_offset(find(driver, "stage"), x, y).click().perform()
        wait(driver, "!byId('explanation').hidden && !byId('answer').textContent.endsWith('...')")
        done = run(driver.execute_script("return asked.facts.command"), tmp_path)
        assert done.returncode == 0
        assert find(driver, "explanation").get_property("textContent") == done.stdout
        answers.add("lit" in find(driver, "answer").text)
    assert answers == {True, False}
    screenshot(driver, "asked")
    find(driver, "stage").send_keys(Keys.CONTROL + Keys.ARROW_DOWN)
    find(driver, "stage").send_keys(Keys.ENTER)
    middle = "byId('answer').textContent.startsWith(`Pixel ${Math.floor(fullSize()[0] / 2)},`)"
    wait(driver, f"{middle} && !byId('answer').textContent.endsWith('...')")
    find(driver, "stage").send_keys(Keys.ESCAPE)
    assert not find(driver, "explanation").is_displayed()


def test_colours_the_hours_of_a_day(driver: Driver, sundial: Server, tmp_path: Path) -> None:
    open_page(driver, sundial)
    day = find(driver, "day")
    driver.execute_script("arguments[0].value = '2026-06-21'; arguments[0].dispatchEvent(new Event('change'))", day)
    wait(driver, "suns.length > 0 || byId('hour-value').textContent !== ''")
    if "ERFA" in find(driver, "hour-value").text:
        pytest.skip("this build has no ERFA")
    find(driver, "stage").send_keys("h")
    settle(driver)
    wait(driver, "shown.path === 'hours' && !byId('legend').hidden")
    screenshot(driver, "hours")
    # A day of midsummer at 48.2 degrees north has 15 h 53 min between the passages of the sun's centre.
    assert find(driver, "most").text in ("15.8 hours of sun", "15.9 hours of sun")
    assert find(driver, "hours").get_attribute("aria-pressed") == "true"
    command = command_of(driver)
    assert command.startswith("gnomon hours") and "--day=2026-06-21" in command and "--step=10" in command
    find(driver, "save").click()
    saved = driver.downloads / "hours.png"
    WebDriverWait(driver, 20).until(lambda _: saved.exists())
    assert run(command, tmp_path).returncode == 0
    assert saved.read_bytes() == (tmp_path / "hours.png").read_bytes()
    drag(driver, 60, 20)  # the camera turns, and the hours stay
    settle(driver)
    assert driver.execute_script("return shown.path") == "hours"
    drag(driver, 30, 10, Keys.SHIFT)  # one sun: its light again
    assert command_of(driver).startswith("gnomon render") and not find(driver, "legend").is_displayed()


def test_compares_with_a_rival(driver: Driver, sundial: Server) -> None:
    open_page(driver, sundial)
    choose(driver, "rival", "shadow-map")
    settle(driver)
    wait(driver, "shown.isComparison")
    assert "Wrong:" in find(driver, "comparison").text and find(driver, "divider").is_displayed()
    assert option(command_of(driver), "technique") == "shadow-map"
    middle = driver.execute_script("return look.divider")
    ActionChains(driver, duration=20).move_to_element(find(driver, "divider")).click_and_hold().move_by_offset(
        100, 0
    ).release().perform()
    assert driver.execute_script("return look.divider") > middle
    screenshot(driver, "compared")
    choose(driver, "show", "difference")
    wait(driver, "byId('divider').hidden")
    screenshot(driver, "difference")
    choose(driver, "show", "divider")
    choose(driver, "rival", "")
    settle(driver)


def test_plays_an_animation(driver: Driver, moving: Server) -> None:
    open_page(driver, moving)
    assert find(driver, "animation-part").is_displayed()
    find(driver, "stage").send_keys(" ")
    wait(driver, "look.time > 0.3 && shown.parameters.time > 0.3")
    find(driver, "stage").send_keys(" ")
    assert find(driver, "play").text == "Play"
    assert float(option(command_of(driver), "time")) > 0.3


def test_is_readable_at_all_sizes(driver: Driver, quick: Server) -> None:
    # In a narrow window the longest words below the picture would need a second line, and so another picture's size.
    for name, width, height in (("phone", 390, 844), ("narrow", 702, 700), ("tablet", 800, 1100), ("wide", 1600, 900)):
        driver.set_window_size(width, height)
        open_page(driver, quick)
        screenshot(driver, name)
        assert driver.execute_script("return document.documentElement.scrollWidth <= window.innerWidth")
        assert driver.execute_script("return picture.width > 0 && stage.clientHeight > 200")
    find(driver, "stage").send_keys("?")
    assert find(driver, "help").is_displayed()
    screenshot(driver, "help")
    ActionChains(driver).send_keys(Keys.ESCAPE).perform()
    wait(driver, "!byId('help').open")
    driver.set_window_size(1000, 600)


def test_says_what_is_wrong(driver: Driver, tmp_path: Path) -> None:
    broken = tmp_path / "broken.gltf"
    broken.write_text("{}")
    server = Server(str(broken))
    driver.get(server.address)
    wait(driver, "byId('message').textContent.includes('broken.gltf')")
    server.stop()
    server = Server()
    open_page(driver, server)
    server.stop()
    find(driver, "stage").send_keys(Keys.ARROW_LEFT)
    wait(driver, "byId('message').textContent.includes('does not answer')")
    screenshot(driver, "lost")


def test_the_page_makes_no_errors(driver: Driver, sundial: Server) -> None:
    driver.get_log("browser")
    open_page(driver, sundial)
    drag(driver, 50, 20)
    settle(driver)
    said = [entry["message"] for entry in driver.get_log("browser") if entry["level"] == "SEVERE"]
    assert [message for message in said if " 409 " not in message] == []

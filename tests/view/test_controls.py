# SPDX-License-Identifier: MIT
"""Every way to work with the page of `gnomon view`: fingers, keys alone, a phone, a tunnel, another page's frame."""

import contextlib
import json
import math
import socket
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from browser import (
    ActionChains,
    By,
    Driver,
    choose,
    command_of,
    find,
    open_page,
    option,
    screenshot,
    settle,
    wait,
)
from conftest import SCENES, Server
from selenium.webdriver.common.keys import Keys


class Relay:
    """What stands between a browser and the server when ssh -L does: another port of this machine, whose bytes go to
    the server's and back."""

    def __init__(self, port: int, own_port: int = 0) -> None:
        self.to = port
        self.listener = socket.create_server(("127.0.0.1", own_port))
        self.port = self.listener.getsockname()[1]
        self.ends: list[socket.socket] = []
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self) -> None:
        while True:
            try:
                near, _ = self.listener.accept()
                far = socket.create_connection(("127.0.0.1", self.to))
            except OSError:
                return
            self.ends += [near, far]
            for pair in ((near, far), (far, near)):
                threading.Thread(target=self.copy, args=pair, daemon=True).start()

    @staticmethod
    def copy(source: socket.socket, target: socket.socket) -> None:
        with contextlib.suppress(OSError):
            while data := source.recv(65536):
                target.sendall(data)
        for end in (source, target):
            end.close()

    def cut(self) -> None:
        for end in (self.listener, *self.ends):
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)
            end.close()


def numbers(command: str, name: str) -> list[float]:
    return [float(c) for c in option(command, name).split(",")]


def touch(driver: Driver, *paths: list[tuple[float, float]]) -> None:
    """Fingers that go along these paths at once, in parts of the stage's width and height."""
    box = driver.execute_script("const b = stage.getBoundingClientRect(); return [b.x, b.y, b.width, b.height]")

    def send(kind: str, step: int) -> None:
        points = [] if kind == "touchEnd" else [
            {"x": box[0] + path[step][0] * box[2], "y": box[1] + path[step][1] * box[3], "id": i}
            for i, path in enumerate(paths)
        ]  # fmt: skip
        driver.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    send("touchStart", 0)
    for step in range(1, len(paths[0])):
        send("touchMove", step)
    send("touchEnd", 0)


@pytest.fixture
def phone(driver: Driver) -> Iterator[Driver]:
    screen = {"width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": True}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)
    driver.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": True, "maxTouchPoints": 2})
    yield driver
    driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    driver.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": False})


def test_a_right_drag_pans(driver: Driver, quick: Server) -> None:
    open_page(driver, quick)
    find(driver, "stage").send_keys(Keys.ARROW_LEFT)
    before = command_of(driver)
    actions = ActionChains(driver, duration=20).move_to_element(find(driver, "stage"))
    actions.w3c_actions.pointer_action.pointer_down(button=2)
    actions.move_by_offset(80, 30)
    actions.w3c_actions.pointer_action.pointer_up(button=2)
    actions.perform()
    after = command_of(driver)
    steps = [[b - a for a, b in zip(numbers(before, n), numbers(after, n), strict=True)] for n in ("eye", "target")]
    assert max(abs(c) for c in steps[0]) > 0.01  # both move, alike: the direction stays
    assert steps[0] == pytest.approx(steps[1], abs=1e-5)


def test_fingers_turn_pan_and_pinch(phone: Driver, quick: Server) -> None:
    open_page(phone, quick)
    screenshot(phone, "touch")
    touch(phone, [(0.3, 0.5), (0.4, 0.5), (0.6, 0.55)])
    turned = command_of(phone)
    assert option(turned, "eye") != ""

    def distance(command: str) -> float:
        return math.dist(numbers(command, "eye"), numbers(command, "target"))

    touch(phone, [(0.4, 0.5), (0.35, 0.5), (0.3, 0.5)], [(0.6, 0.5), (0.65, 0.5), (0.7, 0.5)])
    pinched = command_of(phone)
    assert distance(pinched) == pytest.approx(distance(turned) / 2, rel=0.02)  # fingers twice as far apart
    touch(phone, [(0.4, 0.5), (0.45, 0.6), (0.5, 0.7)], [(0.6, 0.5), (0.65, 0.6), (0.7, 0.7)])
    panned = command_of(phone)
    assert distance(panned) == pytest.approx(distance(pinched), rel=1e-3)
    assert option(panned, "target") != option(pinched, "target")


def test_a_phone_has_all(phone: Driver, quick: Server) -> None:
    open_page(phone, quick)
    assert phone.execute_script("return document.documentElement.scrollWidth <= window.innerWidth")
    touch(phone, [(0.5, 0.5)])  # a tap asks
    wait(phone, "asked.facts !== null && !byId('bubble').hidden")
    shown = "[...document.querySelectorAll('{}')].filter(e => e.offsetHeight > 0 && {}).map(e => e.id || e.textContent)"
    for kind, is_too_small in (
        ("#panel button, #panel select, #panel input:not([type=range])", "e.offsetHeight < 40"),
        ("body *", "parseFloat(getComputedStyle(e).fontSize) < 12"),
    ):
        assert phone.execute_script("return " + shown.format(kind, is_too_small)) == []
    tall = phone.execute_script("return stage.clientHeight")
    find(phone, "toggle").click()
    wait(phone, f"stage.clientHeight > 1.5 * {tall}")
    screenshot(phone, "phone-without-panel")
    find(phone, "toggle").click()


def test_cameras_lights_and_the_sky_are_chosen(driver: Driver) -> None:
    server = Server(str(SCENES / "pillars_point_light.glb"), "--samples", "1")
    open_page(driver, server)
    cameras, lights = (driver.execute_script(f"return look.scene.{n}") for n in ("cameras", "lights"))
    for name in cameras:
        choose(driver, "camera", name)
        assert option(command_of(driver), "camera") == name
    find(driver, "stage").send_keys(".")
    assert option(command_of(driver), "camera") == "" and find(driver, "camera").get_property("value") == ""
    find(driver, "stage").send_keys(",")
    assert option(command_of(driver), "camera") == cameras[-1]
    for light in lights:
        choose(driver, "light", "name:" + light["name"])
        command = command_of(driver)
        assert option(command, "light") == light["name"]
    choose(driver, "light", "sun")
    assert option(command_of(driver), "light-direction") != ""
    choose(driver, "ambient", "sky")
    assert "--ambient=sky" in command_of(driver)
    server.stop()


def test_the_hour_slider_moves_the_sun(driver: Driver, quick: Server) -> None:
    open_page(driver, quick)
    wait(driver, "suns.length > 0 || byId('hour-value').textContent !== ''")
    if "ERFA" in find(driver, "hour-value").text:
        pytest.skip("this build has no ERFA")
    hour = find(driver, "hour")
    for key in (Keys.ARROW_RIGHT, Keys.ARROW_RIGHT, Keys.HOME, Keys.END):
        hour.send_keys(key)
        sun = driver.execute_script("return suns[Number(byId('hour').value)]")
        assert option(command_of(driver), "light-direction") == sun["direction"]
        assert find(driver, "hour-value").text == sun["time"][11:16]
    last = int(hour.get_property("value"))
    assert last == driver.execute_script("return suns.length") - 1
    find(driver, "play-day").click()
    wait(driver, f"Number(byId('hour').value) !== {last}")
    find(driver, "play-day").click()
    assert find(driver, "play-day").text == "Play"


def test_all_is_reached_by_keys_alone(driver: Driver, moving: Server) -> None:
    open_page(driver, moving)
    active = "return document.activeElement.id || document.activeElement.tagName"
    wanted = set(driver.execute_script(
        "return [...document.querySelectorAll('#stage, summary, button, select, input, pre[tabindex]')]"
        ".filter(e => e.offsetHeight > 0 && !e.disabled).map(e => e.id || e.tagName)"
    ))  # fmt: skip
    reached = []
    for _ in range(80):
        ActionChains(driver).send_keys(Keys.TAB).perform()
        reached.append(driver.execute_script(active))
        outline = driver.execute_script("return getComputedStyle(document.activeElement).outlineStyle")
        assert reached[-1] == "BODY" or outline != "none", reached[-1]
    assert wanted <= set(reached) and len(wanted) > 20

    def go_to(name: str) -> None:
        for _ in range(80):
            if driver.execute_script(active) == name:
                return
            ActionChains(driver).send_keys(Keys.TAB).perform()
        raise AssertionError(name)

    def press(*keys: str) -> None:
        ActionChains(driver).send_keys(*keys).perform()

    go_to("stage")
    press(Keys.ARROW_LEFT, Keys.ARROW_UP, "+", "l")
    turned = command_of(driver)
    assert option(turned, "eye") and option(turned, "light-direction")
    ActionChains(driver).key_down(Keys.CONTROL).send_keys(Keys.ARROW_DOWN).key_up(Keys.CONTROL).perform()
    press(Keys.ENTER)
    wait(driver, "asked.facts !== null")
    go_to("rival")
    press("shadow-map")
    wait(driver, "shown.isComparison")
    go_to("divider")
    press(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
    assert driver.execute_script("return look.divider") == pytest.approx(0.54)
    go_to("rival")
    press("nothing")
    wait(driver, "!shown.isComparison")
    go_to("play")
    press(" ")
    wait(driver, "look.time > 0.1")
    press(" ")
    go_to("ask-for-help")
    press(Keys.ENTER)
    wait(driver, "byId('help').open")
    press(Keys.ESCAPE)
    wait(driver, "!byId('help').open")


def test_says_what_it_does_while_it_loads(driver: Driver, moving_scene: Path, tmp_path: Path,
                                          monkeypatch: pytest.MonkeyPatch) -> None:  # fmt: skip
    scene = json.loads(moving_scene.read_text())
    large = 24 << 20  # a buffer that takes a while to read
    uri = "data:application/octet-stream;base64," + "A" * (large // 3 * 4)
    scene["buffers"].append({"byteLength": large, "uri": uri})
    (tmp_path / "large.gltf").write_text(json.dumps(scene))
    for name in ("GNOMON_CACHE_DIR", "POCL_CACHE_DIR"):  # kernels are compiled, and not found
        (tmp_path / name).mkdir()
        monkeypatch.setenv(name, str(tmp_path / name))
    server = Server(str(tmp_path / "large.gltf"))
    driver.get(server.address)
    wait(driver, r"/^reading the scene \.\.\. \d+ s$/.test(byId('message').textContent)")
    screenshot(driver, "loading")
    wait(driver, "byId('message').textContent.startsWith('the first picture (compiles kernels the first time)')")
    server.process.kill()
    server.process.wait()


def test_works_through_a_tunnel(driver: Driver, quick: Server) -> None:
    relay = Relay(quick.port)
    address = f"http://{{}}:{relay.port}/?token={quick.token}"
    for host in ("127.0.0.1", "localhost"):
        driver.get(address.format(host))
        settle(driver)
        find(driver, "stage").send_keys(Keys.ARROW_LEFT)
        assert option(command_of(driver), "eye") != ""
    driver.get(f"http://127.0.0.1:{relay.port}/?token={'0' * 32}")
    assert "token" in driver.find_element(By.TAG_NAME, "body").text
    driver.get(address.format("127.0.0.1"))
    settle(driver)
    relay.cut()
    find(driver, "stage").send_keys(Keys.ARROW_LEFT)
    wait(driver, "byId('message').textContent.includes('does not answer')")
    relay = Relay(quick.port, relay.port)
    wait(driver, "byId('message').hidden")  # it goes on
    find(driver, "stage").send_keys(Keys.ARROW_LEFT)
    assert option(command_of(driver), "eye") != ""
    relay.cut()


def test_is_shown_in_a_frame_of_a_notebook(driver: Driver, quick: Server, tmp_path: Path) -> None:
    notebook = tmp_path / "notebook.html"
    notebook.write_text(f'<iframe src="{quick.address}" width="100%" height="400"></iframe>')
    driver.get(notebook.as_uri())
    driver.switch_to.frame(0)
    settle(driver)
    find(driver, "stage").send_keys(Keys.ARROW_LEFT)
    assert option(command_of(driver), "eye") != ""
    driver.switch_to.default_content()

#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures `gnomon view` as a client of its protocol sees it: the first picture, turning, explanations, memory. With
--browser also the rate of the page itself in headless Chromium, by the browser's clock: it needs selenium
(tools/test_view.sh installs it in build-view/venv) and Debian's chromium-driver.

    tools/measure_view.py scenes/sponza.glb --size 960x540 --seconds 10
    build-view/venv/bin/python tools/measure_view.py scenes/sponza.glb --browser
"""

import argparse
import http.client
import json
import math
import os
import re
import resource
import statistics
import subprocess
import tempfile
import threading
import time
import urllib.parse


class Client:
    """A connection that stays open."""

    def __init__(self, port: int, token: str) -> None:
        self.connection = http.client.HTTPConnection("127.0.0.1", port)
        self.headers = {"X-Gnomon-Token": token, "X-Gnomon-Client": "measure"}

    def get(self, path: str, **parameters: str) -> tuple[dict, bytes]:
        self.connection.request("GET", f"/{path}?{urllib.parse.urlencode(parameters)}", headers=self.headers)
        answer = self.connection.getresponse()
        body = answer.read()
        if answer.status != 200:
            raise RuntimeError(body.decode())
        return json.loads(answer.headers.get("X-Gnomon", "{}")), body


def around(camera: dict, angle: float) -> dict[str, str]:
    """The parameters of a camera that stands where this one does, turned about the vertical."""
    eye, (x, y, z) = camera["eye"], camera["forward"]
    ahead = (x * math.cos(angle) + z * math.sin(angle), y, z * math.cos(angle) - x * math.sin(angle))
    target = [e + a for e, a in zip(eye, ahead, strict=True)]
    texts = {"eye": eye, "target": target}
    return {name: ",".join(f"{c:.9g}" for c in v) for name, v in texts.items()} | {"fovy": f"{camera['fovy']:.9g}"}


def turn(port: int, token: str, camera: dict, size: str, seconds: float) -> dict[str, float]:
    """Turns with one request on the way, or two, by the page's rule (inFlightFor() in host/app/view/pictures.js)."""
    waits: list[float] = []
    times: dict[str, list[float]] = {}
    began = time.monotonic()
    alone = Client(port, token)
    takes_two = []
    for _ in range(8):
        sent = time.monotonic()
        facts, _ = alone.get("frame.jpg", size=size, draft="1", **around(camera, 0.3 * (sent - began)))
        device = sum(ms for name, ms in facts["ms"].items() if name != "jpeg")
        takes_two.append(1000 * (time.monotonic() - sent) > 1.5 * device)
    on_the_way = 1 + (statistics.median(takes_two) > 0.5)
    end = time.monotonic() + seconds

    def ask() -> None:
        client = Client(port, token)
        client.headers["X-Gnomon-Client"] = threading.current_thread().name
        while (sent := time.monotonic()) < end:
            facts, _ = client.get("frame.jpg", size=size, draft="1", **around(camera, 0.3 * (sent - began)))
            waits.append(1000 * (time.monotonic() - sent))
            for name, ms in facts["ms"].items():
                times.setdefault(name, []).append(ms)

    threads = [threading.Thread(target=ask, name=f"turn{i}") for i in range(on_the_way)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    waits.sort()
    return {
        "on_the_way": on_the_way,
        "frames_per_s": len(waits) / seconds,
        "median_ms": statistics.median(waits),
        "p95_ms": waits[int(0.95 * len(waits))],
    } | {f"{name}_ms": statistics.median(values) for name, values in times.items()}


# Turns the camera at every frame of the browser, and tells the rate of pictures, the median time from a request to its
# picture, and the mean share of the full side of those pictures.
TURN_IN_BROWSER = """
const [seconds, done] = arguments, began = performance.now(), waits = [], sides = [];
const seen = () => { waits.push(parseFloat(byId('facts').textContent.match(/([0-9]+) ms$/)[1])); sides.push(scale); };
document.addEventListener('shown', seen);
(function step() {
  const now = performance.now();
  if (now - began < 1000 * seconds) { moveCamera(orbit => orbit.turn(0.005, 0)); return requestAnimationFrame(step); }
  document.removeEventListener('shown', seen);
  waits.sort((a, b) => a - b);
  done([waits.length / seconds, waits[waits.length >> 1], sides.reduce((a, b) => a + b, 0) / sides.length]);
})();
"""


def turn_in_browser(address: str, size: str, seconds: float) -> dict[str, float]:
    """The page's own figures, its picture of about this size."""
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    window = f"--window-size={size.replace('x', ',')}"
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", window):
        options.add_argument(argument)
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService("/usr/bin/chromedriver"))
    try:
        driver.set_script_timeout(seconds + 60)
        driver.get(address)
        while not driver.execute_script("return document.body.dataset.last === 'true'"):
            time.sleep(0.1)
        rate, wait, side = driver.execute_async_script(TURN_IN_BROWSER, seconds)
    finally:
        driver.quit()
    return {"browser_frames_per_s": rate, "browser_median_ms": wait, "browser_share_of_side": side}


def peak_bytes(pid: int) -> int:
    with open(f"/proc/{pid}/status") as status:
        return 1024 * int(re.search(r"VmHWM:\s+(\d+)", status.read())[1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("--size", default="960x540")
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--binary", default=os.path.join(os.path.dirname(__file__), "..", "build", "gnomon"))
    parser.add_argument("--browser", action="store_true")
    options = parser.parse_args()

    with tempfile.TemporaryDirectory() as folder:
        picture = os.path.join(folder, "view.png")
        render = [options.binary, "render", options.scene, "--size", options.size, "-o", picture, "--quiet"]
        subprocess.run(render, check=True)
    render_bytes = 1024 * resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss

    load = os.getloadavg()[0]
    began = time.monotonic()
    server = subprocess.Popen([options.binary, "view", options.scene, "--no-open"], stdout=subprocess.PIPE, text=True)
    try:
        found = re.search(r"http://\S+:(\d+)/\?token=(\w+)", server.stdout.readline())
        port, token = int(found[1]), found[2]
        client = Client(port, token)
        facts, _ = client.get("frame.jpg", size=options.size)
        figures = {"load": load, "first_picture_s": time.monotonic() - began}
        figures["memory_first_mib"] = (peak_bytes(server.pid) - render_bytes) / 2**20
        figures |= turn(port, token, facts["camera"], options.size, options.seconds)
        figures["memory_turning_mib"] = (peak_bytes(server.pid) - render_bytes) / 2**20
        width, height = (int(side) for side in options.size.split("x"))
        client = Client(port, token)  # the server has closed the idle one
        asked = []
        for i in range(12):
            sent = time.monotonic()
            client.get("explain", size=options.size, pixel=f"{width * (i + 1) // 14},{height // 2}")
            asked.append(1000 * (time.monotonic() - sent))
        figures["explanation_median_ms"] = statistics.median(asked[1:])
        figures["memory_over_render_mib"] = (peak_bytes(server.pid) - render_bytes) / 2**20
        if options.browser:
            figures |= turn_in_browser(found[0], options.size, options.seconds)
    finally:
        server.kill()
        server.wait()
    for name, value in figures.items():
        print(f"{name:24} {value:10.2f}")


if __name__ == "__main__":
    main()

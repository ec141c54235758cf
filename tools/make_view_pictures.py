#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes docs/view_page.webp and docs/view_day.webp: the page of `gnomon view` in headless Chromium, of the built-in
sundial, explaining a shadow, and with the sun of a day. Runs in the environment of tools/test_view.sh:

    build-view/venv/bin/python tools/make_view_pictures.py docs
"""

import base64
import io
import sys
import time
from pathlib import Path

from PIL import Image
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "view"))
from conftest import Server  # noqa: E402

still = (
    "return shown.facts !== null && !isDirty && inFlight === 0 && document.body.dataset.last === 'true'"
    " && performance.now() - lastInput > 2 * stillAfterMs"
)


def main() -> None:
    folder = Path(sys.argv[1])
    options = webdriver.ChromeOptions()
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1200,760"):
        options.add_argument(argument)
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService("/usr/bin/chromedriver"))
    server = Server()
    try:
        driver.get(server.address)
        wait = WebDriverWait(driver, 120)
        wait.until(lambda d: d.execute_script(still))
        ActionChains(driver).move_to_element_with_offset(driver.find_element(By.ID, "stage"), 83, 48).click().perform()
        wait.until(lambda d: d.execute_script("return !byId('explanation').hidden"))
        shot = Image.open(io.BytesIO(driver.get_screenshot_as_png())).convert("RGB")
        shot.save(folder / "view_page.webp", quality=85)
        driver.set_window_size(880, 500)
        driver.execute_script("look.samples = 4; clearAnswer(); byId('day').value = '2026-06-21'; return loadSuns()")
        frames = []
        for hour in range(10, 86, 4):
            driver.execute_script(f"byId('hour').value = {hour}; showHour()")
            time.sleep(0.2)
            wait.until(lambda d: d.execute_script(still))
            data = driver.execute_script("return picture.toDataURL('image/png').split(',')[1]")
            frame = Image.open(io.BytesIO(base64.b64decode(data))).convert("RGB")
            frames.append(frame.resize((400, 400 * frame.height // frame.width), Image.Resampling.LANCZOS))
        day = {"save_all": True, "append_images": frames[1:], "duration": 90, "loop": 0, "quality": 75}
        frames[0].save(folder / "view_day.webp", **day)
    finally:
        driver.quit()
        server.stop()


if __name__ == "__main__":
    main()

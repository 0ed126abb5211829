# SPDX-License-Identifier: MIT
"""The live view in a real browser: picture, steering, replay, and who is not let in. Needs build/release/spume, Chromium and selenium."""
import http.server
import io
import json
import os
import signal
import subprocess
import tempfile
import threading
import time
import unittest
import urllib.error
import urllib.request
from pathlib import Path

import h5py
import paths
from PIL import Image

try:
    from selenium import webdriver
    from selenium.webdriver.common.by import By
    MISSING = "" if Path("/usr/bin/chromedriver").exists() and Path("/usr/bin/chromium").exists() else "Chromium"
except ImportError:
    MISSING = "selenium"

SPUME = paths.ROOT / "build" / "release" / "spume"
PATIENCE = 60  # seconds, for a machine with other work
CASE = ("breaking_wave", "--set", "resolution.spacing=0.03", "--set", "output.every=0.02")


class Run:
    """A run of the program with the view, in a folder of its own."""

    def __init__(self, folder, *arguments):
        self.folder = folder
        environment = os.environ | {"OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive"}
        self.process = subprocess.Popen([SPUME, "run", *arguments, "-q", "-o", folder], cwd=paths.ROOT, env=environment, text=True,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.address = ""
        if "--view" in arguments:
            line = self.process.stdout.readline()
            if not line.startswith("view at http://127.0.0.1:"):
                raise AssertionError(line + self.process.stderr.read())
            self.address = line.split()[-1]

    def finish(self):
        """Exit code and what was printed as errors."""
        errors = self.process.communicate(timeout=PATIENCE)[1]
        return self.process.returncode, errors

    def end(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()


class Page(http.server.BaseHTTPRequestHandler):
    """An empty page."""

    def do_GET(self):
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(b"<!doctype html><title>other</title>")

    def log_message(self, *_):
        pass


def wait_for(condition, what):
    """The first true value of the condition."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if value := condition():
            return value
        time.sleep(0.05)
    raise AssertionError(f"waited {PATIENCE} s for {what}")


def state_of(folder):
    """The arrays of the checkpoint, without the wall time; and the series."""
    arrays = {}

    def take(name, item):
        if isinstance(item, h5py.Dataset) and name.startswith("state/"):
            arrays[name] = item[()].tobytes() if not name.endswith("driver/clock") else item[:2].tobytes()

    with h5py.File(folder / "checkpoint.h5") as file:
        file.visititems(take)
    return arrays | {"series": (folder / "series.csv").read_text()}


@unittest.skipIf(MISSING, f"{MISSING} is not installed; tools/setup --browser installs what the live view is tested with")
class LiveView(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        options = webdriver.ChromeOptions()
        # Drawn by the processor; a container gives the browser neither a sandbox nor much shared memory.
        for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle", "--use-angle=swiftshader",
                         "--enable-unsafe-swiftshader", "--window-size=1400,900"):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        cls.browser = webdriver.Chrome(options=options, service=webdriver.chrome.service.Service("/usr/bin/chromedriver"))
        cls.addClassCleanup(cls.browser.quit)

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.scratch = Path(scratch.name)

    def start(self, name, *arguments):
        run = Run(self.scratch / name, *arguments)
        self.addCleanup(run.end)
        return run

    def open(self, run, words):
        self.browser.get(run.address)
        self.wait_words(words)

    def text(self, name):
        return self.browser.find_element(By.ID, name).text

    def wait_words(self, words):
        wait_for(lambda: self.text("words") == words, f"'{words}', the page says '{self.text('words')}'")

    def wait_step(self, least):
        wait_for(lambda: int(self.text("step")) >= least, f"step {least}")

    def click(self, name):
        self.browser.find_element(By.ID, name).click()

    def picture(self):
        return Image.open(io.BytesIO(self.browser.find_element(By.ID, "canvas").screenshot_as_png)).convert("RGB")

    def drawn(self):
        """Share of the picture's middle that is brightly coloured."""
        image = self.picture()
        middle = image.crop((image.width // 4, image.height // 4, 3 * image.width // 4, 3 * image.height // 4))
        pixels = list(middle.getdata())
        return sum(max(pixel) - min(pixel) > 40 for pixel in pixels) / len(pixels)

    def steer(self, key, value):
        field = self.browser.find_element(By.CSS_SELECTOR, f"#options input[data-key='{key}']")
        self.browser.execute_script("arguments[0].value = arguments[1]; arguments[0].form.requestSubmit()", field, value)

    def wait_answer(self, start):
        wait_for(lambda: self.text("answer").startswith(start), f"'{start}', the answer is '{self.text('answer')}'")

    def test_shows_pauses_steers_and_a_replay_has_the_same_bits(self):
        run = self.start("steered", *CASE, "--view", "--paused")
        self.open(run, "paused")
        wait_for(lambda: self.drawn() > 0.05, "a picture")
        before = self.picture()
        self.assertEqual(self.text("step"), "0")
        self.click("pause")
        self.wait_step(20)
        self.click("pause")
        self.wait_words("paused")
        step = self.text("step")
        time.sleep(1)
        self.assertEqual(self.text("step"), step)
        self.assertNotEqual(self.picture().tobytes(), before.tobytes())
        self.assertGreater(self.browser.execute_script("return document.querySelectorAll('#curves canvas').length"), 0)
        self.assertIn("fluid", self.text("legends"))
        self.assertIn("length/time", self.text("legends"))
        self.click("one")
        wait_for(lambda: int(self.text("step")) == int(step) + 1, "one step more")

        self.steer("fluid.reynolds", "-5")
        self.wait_answer("refused")
        self.assertIn("must be > 0", self.text("answer"))
        self.steer("fluid.reynolds", "20")
        self.wait_answer("steered")
        self.click("snapshot")
        self.wait_answer("snapshot")
        self.steer("time.end", str(float(self.text("time")) + 0.2))
        wait_for(lambda: "time.end" in self.text("answer"), "the new end")
        self.click("pause")
        self.wait_words("finished")
        self.assertEqual(run.finish(), (0, ""))
        self.assertEqual([entry for entry in self.browser.get_log("browser") if entry["level"] == "SEVERE"], [])

        steering = run.folder / "steering.csv"
        rows = [line.split(",") for line in steering.read_text().splitlines() if line[0].isdigit()]
        self.assertEqual([row[2] for row in rows], ["fluid.reynolds", "snapshot", "time.end"])
        self.assertEqual(int(rows[0][0]), int(step) + 1)
        self.assertEqual(self.start("replay", *CASE, "--replay", steering).finish(), (0, ""))
        self.assertEqual(state_of(self.scratch / "replay"), state_of(run.folder))
        self.assertEqual((self.scratch / "replay" / "steering.csv").read_text(), steering.read_text())
        # The changes did something.
        self.start("plain", *CASE, "--until", str(float(rows[0][1]) + 0.2)).finish()
        self.assertNotEqual(state_of(self.scratch / "plain")["series"], state_of(run.folder)["series"])

    def test_fits_a_phone_and_shows_a_plane_of_a_grid(self):
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": True})
        self.addCleanup(self.browser.execute_cdp_cmd, "Emulation.clearDeviceMetricsOverride", {})
        run = self.start("turbulence", "forced_turbulence", "--set", "resolution.grid=16", "--view", "--paused")
        self.open(run, "paused")
        wait_for(lambda: self.drawn() > 0.05, "a picture")
        widths = "return [document.documentElement.scrollWidth, window.innerWidth]"
        self.assertEqual(*self.browser.execute_script(widths))
        self.assertIn("across", self.text("legends"))
        run.process.send_signal(signal.SIGINT)
        self.assertEqual(run.finish()[0], 130)
        self.assertEqual(json.loads((run.folder / "summary.json").read_text())["state"], "interrupted")

    def test_two_viewers_look_and_the_run_goes_on_without_them(self):
        run = self.start("left", *CASE, "--until", "0.5", "--view", "--paused")
        self.open(run, "paused")
        first = self.browser.current_window_handle
        self.browser.switch_to.new_window("tab")
        self.open(run, "paused")
        wait_for(lambda: self.drawn() > 0.05, "a picture")
        self.click("pause")
        self.wait_step(5)
        self.browser.get("about:blank")
        self.browser.close()
        self.browser.switch_to.window(first)
        self.wait_step(10)
        self.browser.get("about:blank")
        self.assertEqual(run.finish(), (0, ""))
        # Looking changes nothing.
        self.assertEqual(self.start("plain", *CASE, "--until", "0.5").finish(), (0, ""))
        self.assertEqual(state_of(self.scratch / "plain"), state_of(run.folder))

    def test_lets_nobody_in_without_the_token(self):
        run = self.start("closed", *CASE, "--view", "--paused")
        address, token = run.address.split("?token=")
        for wrong in (address, f"{address}?token={'0' * len(token)}", f"{address}view.js?token={token[:-1]}"):
            with self.assertRaises(urllib.error.HTTPError) as refused:
                urllib.request.urlopen(wrong)
            refused.exception.close()
            self.assertEqual(refused.exception.code, 403)
        # Another page of this machine that knows port and token: its origin is not that of the view.
        other = http.server.HTTPServer(("127.0.0.1", 0), Page)
        self.addCleanup(other.server_close)
        self.addCleanup(other.shutdown)
        threading.Thread(target=other.serve_forever, daemon=True).start()
        self.browser.get(f"http://127.0.0.1:{other.server_port}/")
        opened = self.browser.execute_async_script(
            "const done = arguments[arguments.length - 1]; const socket = new WebSocket(arguments[0]);"
            "socket.onopen = () => done('open'); socket.onerror = () => done('refused');",
            run.address.replace("http:", "ws:").replace("/?", "/socket?"))
        self.assertEqual(opened, "refused")
        self.browser.get_log("browser")  # which tells of the refusal
        port = address.rstrip("/").split(":")[-1]
        second = subprocess.run([SPUME, "run", *CASE, "--view", "--port", port, "-o", self.scratch / "second"], cwd=paths.ROOT, text=True,
                                capture_output=True)
        self.assertEqual(second.returncode, 2)
        self.assertIn(f"port {port} of 127.0.0.1 is taken", second.stderr)
        self.assertFalse((self.scratch / "second").exists())


if __name__ == "__main__":
    unittest.main()

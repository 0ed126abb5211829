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
import numpy as np
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
ENDLESS = (*CASE, "--until", "1000")  # outlives a browser that takes its time to start


class Run:
    """The program with the view: a run in a folder of its own, or what runs have left."""

    def __init__(self, folder, *arguments):
        self.folder = folder
        environment = os.environ | {"OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive"}
        if folder is not None:
            arguments = ("run", *arguments, "-q", "-o", folder)
        self.process = subprocess.Popen([SPUME, *arguments], cwd=paths.ROOT, env=environment, text=True, stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE)
        self.address = self.looking_address = ""
        if "--view" in arguments or folder is None:
            line = self.process.stdout.readline()
            if not line.startswith("view at http://127.0.0.1:"):
                raise AssertionError(line + self.process.stderr.read())
            self.address = line.split()[-1]
        if "--view" in arguments:
            self.looking_address = self.process.stdout.readline().split()[-1]

    def threads(self):
        return len(os.listdir(f"/proc/{self.process.pid}/task"))

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
        cls.options = options
        cls.browser = webdriver.Chrome(options=options, service=webdriver.chrome.service.Service("/usr/bin/chromedriver"))
        cls.addClassCleanup(cls.browser.quit)

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.scratch = Path(scratch.name)
        # The page of the test before looks for its run, which has ended: its complaints are not this test's.
        self.browser.get("about:blank")
        self.browser.get_log("browser")

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

    def script(self, text, *arguments):
        return self.browser.execute_script(text, *arguments)

    def test_a_run_without_the_view_has_no_thread_of_it(self):
        plain, viewed = self.start("plain", *ENDLESS), self.start("viewed", *ENDLESS, "--view", "--paused")
        wait_for(lambda: (plain.folder / "series.csv").exists(), "the run")
        self.assertEqual(plain.threads(), 1)
        self.assertGreater(viewed.threads(), 1)

    def test_who_may_only_look_sees_no_controls_and_a_click_tells_values_and_history(self):
        run = self.start("looked_at", "breaking_wave_bubbles", "--set", "resolution.spacing=0.04", "--view", "--paused")
        self.browser.delete_all_cookies()
        self.browser.get(run.looking_address)
        self.wait_words("paused")
        self.assertTrue(self.browser.find_element(By.ID, "welcome").is_displayed())  # three gestures, until they are understood
        self.assertEqual(len(self.browser.find_elements(By.CSS_SELECTOR, "#welcome li")), 3)
        self.click("understood")
        self.assertFalse(self.browser.find_element(By.ID, "pause").is_displayed())
        self.assertFalse(self.browser.find_element(By.ID, "steering").is_displayed())
        wait_for(lambda: self.drawn() > 0.05, "a picture")
        # A message that steers is no use: the viewer is dropped and comes back.
        self.script("link.send({do: 'go'})")
        time.sleep(3)
        self.assertEqual(self.text("step"), "0")
        self.wait_words("paused")
        canvas = self.browser.find_element(By.ID, "canvas")
        webdriver.ActionChains(self.browser).move_to_element_with_offset(canvas, 0, 60).click().perform()
        wait_for(lambda: "velocity" in self.text("picked"), "the values of a particle")
        self.assertIn("length/time", self.text("picked"))
        # Rows are made anew with every frame: one script reads what two commands would find stale.
        self.assertEqual(self.script("return document.querySelector('#picked tr:nth-child(2)').title"),
                         "velocity: u = dx/dt\nunit: length/time")
        title = self.script("return document.querySelector('.legend').title")
        self.assertIn("u = dx/dt", title)
        self.assertIn("unit: length/time", title)
        wait_for(lambda: self.browser.find_elements(By.CSS_SELECTOR, "#history canvas"), "the history")
        # The surface of the liquid in place of its particles.
        before = self.picture().tobytes()
        self.script("const choice = document.getElementById('interface'); choice.value = 'alone'; choice.onchange()")
        wait_for(lambda: self.picture().tobytes() != before, "the surface")
        self.assertEqual(self.script("return document.cookie"), "spume_gestures=seen")
        self.assertEqual([entry for entry in self.browser.get_log("browser") if entry["level"] == "SEVERE" and "WebSocket" not in entry["message"]], [])

    def test_a_surface_of_equal_value_is_where_the_value_is(self):
        run = self.start("turbulence", "forced_turbulence", "--set", "resolution.grid=16", "--view", "--paused")
        self.open(run, "paused")
        wait_for(lambda: self.drawn() > 0.05, "a picture")
        before = self.picture().tobytes()
        self.script("const box = document.querySelector('.surface'); box.checked = true; box.onchange()")
        wait_for(lambda: self.picture().tobytes() != before, "the surface")
        # A ball of radius 0.6 in a cube of 2: x^2 + y^2 + z^2 on 33^3 points. A vertex is the mean of cuts of a cell, half a
        # diagonal away from any of them at most; second order in the spacing h: h^2/R = 0.0065 of the radius.
        far, area = self.script("""
            const n = 33, h = 2 / (n - 1), values = new Float32Array(n * n * n);
            for (let i = 0; i < n; ++i) for (let j = 0; j < n; ++j) for (let k = 0; k < n; ++k)
              values[(i * n + j) * n + k] = (i * h - 1) ** 2 + (j * h - 1) ** 2 + (k * h - 1) ** 2;
            const made = surface.in_space({values, points: [n, n, n], lower: [-1, -1, -1], spacing: [h, h, h]}, 0.36);
            const at = (v) => [0, 1, 2].map((axis) => made.places[3 * v + axis]);
            let far = 0, area = 0;
            for (let v = 0; v < made.places.length / 3; ++v) far = Math.max(far, Math.abs(Math.hypot(...at(v)) - 0.6));
            for (let t = 0; t < made.triangles.length; t += 3) {
              const [a, b, c] = [0, 1, 2].map((k) => at(made.triangles[t + k]));
              const u = b.map((x, k) => x - a[k]), w = c.map((x, k) => x - a[k]);
              area += Math.hypot(u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]) / 2;
            }
            return [far, area];""")
        self.assertLess(far, 0.0065)
        self.assertLess(abs(area / (4 * 3.14159265 * 0.36) - 1), 0.02)

    def test_results_of_two_runs_are_played_beside_each_other_and_saved(self):
        for name, spacing in (("coarse", "0.03"), ("fine", "0.025")):
            self.assertEqual(self.start(name, *CASE, "--set", f"resolution.spacing={spacing}", "--until", "0.1").finish(), (0, ""))
        run = Run(None, "view", self.scratch / "coarse", self.scratch / "fine")
        self.addCleanup(run.end)
        self.open(run, "results")
        wait_for(lambda: self.drawn() > 0.05, "a picture")
        last = self.script("return Number(document.getElementById('when').max)")
        self.assertEqual(last, 5)  # times 0, 0.02, ... 0.1
        image = self.picture()
        for side in (0, 1):  # each in its half
            half = image.crop((side * image.width // 2, 60, (side + 1) * image.width // 2, image.height - 60))
            self.assertGreater(sum(max(pixel) - min(pixel) > 40 for pixel in half.getdata()), 500)
        self.script("film.go_to(5)")
        wait_for(lambda: self.text("time") == "0.1", "the last state")
        self.click("play")
        wait_for(lambda: self.text("play") == "Halt" or self.text("time") != "0.1", "it plays")
        wait_for(lambda: self.text("play") == "Play" and self.text("time") == "0.1", "the end")
        # A place tells its whole history, and both runs are one curve each.
        self.script("look.at(300, 400)")
        wait_for(lambda: self.browser.find_elements(By.CSS_SELECTOR, "#history canvas"), "the history")
        self.assertEqual(self.text("left").split("/")[-1], "coarse")
        # The film of all states, and what the browser was given to save.
        self.script("window.saved = []; HTMLAnchorElement.prototype.click = function () { saved.push(this.download); }")
        self.click("photo")
        wait_for(lambda: self.script("return saved.length") == 1, "the picture")
        self.click("video")
        wait_for(lambda: self.script("return film.last && film.last.bytes || 0") > 1000, "the film")
        picture, film = self.script("return saved")
        self.assertTrue(picture.endswith(".png") and film.endswith((".webm", ".mp4")), (picture, film))
        run.process.send_signal(signal.SIGINT)
        self.assertEqual(run.finish(), (0, ""))

    def test_a_million_particles_are_thinned_to_what_is_drawn_in_time_and_the_page_says_so(self):
        numbers = np.random.default_rng(1).random((3, 1000000))
        with h5py.File(self.scratch / "cloud.h5part", "w") as file:
            group = file.create_group("Step#0")
            for name, values in zip("xyz", numbers):
                group[name] = values.astype("f4")
            group["id"] = np.arange(1000000)
        run = Run(None, "view", self.scratch / "cloud.h5part")
        self.addCleanup(run.end)
        self.open(run, "results")
        self.script("window.turning = setInterval(() => picture.turn(0.02), 20)")
        words = wait_for(lambda: "times a second" in self.text("shown") and self.text("shown"), "the words")
        self.assertIn("cloud: 1,000,000, ", words)
        self.assertIn("shown, as many as this browser draws 30 times a second", words)
        self.script("clearInterval(turning)")

    def test_ten_thousand_messages_a_second_end_a_viewer_and_not_the_run(self):
        run = self.start("flooded", *ENDLESS, "--view")
        self.open(run, "running")
        answer = self.browser.execute_async_script("""
            const done = arguments[arguments.length - 1], socket = new WebSocket(arguments[0]);
            socket.onopen = () => { for (let k = 0; k < 10000; ++k) socket.send('{"do":"ready","points":10,"bits":8}'); };
            socket.onclose = () => done('dropped');""", run.address.replace("http:", "ws:").replace("/?", "/socket?"))
        self.assertEqual(answer, "dropped")
        step = int(self.text("step"))
        self.wait_step(step + 3)  # the page beside it is not touched

    def test_a_viewer_killed_in_the_middle_is_not_missed(self):
        run = self.start("survivor", *ENDLESS, "--view")
        other = webdriver.Chrome(options=self.options, service=webdriver.chrome.service.Service("/usr/bin/chromedriver"))
        other.get(run.address)
        wait_for(lambda: int(other.find_element(By.ID, "step").text) > 2, "steps")
        # All of that browser at once, as when its machine goes.
        driver = other.service.process.pid
        for line in subprocess.run(["ps", "-e", "-o", "pid=,ppid="], capture_output=True, text=True, check=True).stdout.splitlines():
            pid, parent = map(int, line.split())
            if parent == driver:
                os.kill(pid, signal.SIGKILL)
        other.service.process.kill()
        other.service.process.wait()
        rows = len((run.folder / "series.csv").read_text().splitlines())
        wait_for(lambda: len((run.folder / "series.csv").read_text().splitlines()) > rows + 3, "more steps")

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

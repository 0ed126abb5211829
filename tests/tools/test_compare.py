# SPDX-License-Identifier: MIT
"""tools/bench-compare: its statistics on made-up noise, and the command with stand-ins for two benchmark programs."""
import stat
import subprocess
import sys
import tempfile
import textwrap
import unittest
from pathlib import Path

import paths
import numpy as np

from spume_tools.bench.ratios import judge, sign_interval, undecided


def noisy_pairs(rng, slow, rounds=12):
    """A machine that drifts by a factor of two, with 2 % of noise and every sixth time up to twice as long; the best of
    three repetitions."""
    drift = np.exp(np.cumsum(rng.normal(0, 0.2, rounds)))
    shape = (3, rounds)
    noise = lambda: np.min(np.exp(rng.normal(0, 0.02, shape)) * np.where(rng.random(shape) < 1 / 6, rng.uniform(1, 2, shape), 1), axis=0)
    return drift * noise(), slow * drift * noise()


class Statistics(unittest.TestCase):
    def test_interval_is_that_of_the_sign_test(self):
        low, high, coverage = sign_interval(np.arange(1, 13), 0.98)
        self.assertEqual((low, high), (2, 11))
        self.assertAlmostEqual(coverage, 1 - 2 * (1 + 12) / 4096)
        self.assertEqual(sign_interval([3, 1, 2, 4, 6, 5], 0.95)[:2], (1, 6))  # 1 - 2/64

    def test_interval_covers_the_median_as_often_as_it_says(self):
        rng = np.random.default_rng(1)
        covered = 0
        for _ in range(2000):
            low, high, coverage = sign_interval(rng.exponential(1, 12))
            covered += low <= np.log(2) <= high
        # Three standard deviations of a binomial share of 2000.
        self.assertGreater(covered / 2000, coverage - 3 * np.sqrt(coverage * (1 - coverage) / 2000))

    def test_the_same_program_is_hardly_ever_flagged(self):
        rng = np.random.default_rng(2)
        flags = sum(judge(*noisy_pairs(rng, 1.0)).word != "" for _ in range(500))
        self.assertLessEqual(flags, 15)  # 1 - coverage is 0.6 %, and the effect must be there too; tools ask twice

    def test_ten_per_cent_are_found_in_spite_of_the_noise(self):
        rng = np.random.default_rng(3)
        found = sum(judge(*noisy_pairs(rng, 1.1)).regression for _ in range(200))
        gain = sum(judge(*noisy_pairs(rng, 1 / 1.1)).word == "faster" for _ in range(200))
        self.assertGreater(found, 190)
        self.assertGreater(gain, 190)
        quiet = lambda rng: (np.exp(rng.normal(0, 0.02, 12)), 1.1 * np.exp(rng.normal(0, 0.02, 12)))
        self.assertEqual(sum(judge(*quiet(rng)).regression for _ in range(200)), 200)

    def test_a_difference_below_the_effect_is_none(self):
        self.assertEqual(judge([1.0] * 8, [1.03] * 8, effect=0.04).word, "")
        self.assertEqual(judge([1.0] * 8, [1.05] * 8, effect=0.04).word, "slower")

    def test_more_rounds_are_asked_for_where_noise_hides_a_difference(self):
        self.assertTrue(undecided([1.0] * 8, [1.1] * 6 + [0.9] * 2))
        self.assertFalse(undecided([1.0] * 8, [1.1] * 8))
        self.assertFalse(undecided([1.0] * 8, [1.01] * 6 + [0.9] * 2))

    def test_an_odd_number_of_rounds_is_refused(self):
        self.assertRaises(ValueError, judge, [1] * 7, [1] * 7)


PROGRAM = """\
    #!{python}
    import json, random, sys
    rng = random.SystemRandom()
    entry = lambda name, time: {{"name": name, "run_name": name, "run_type": "iteration", "time_unit": "us",
                                 "real_time": time, "cpu_time": time}}
    one = [entry("steady/10", 100 * rng.uniform(1, 1.02)) for _ in range(3)]
    two = [entry("other/10", {time} * rng.uniform(1, 1.02)) for _ in range(3)]
    print(json.dumps({{"benchmarks": one + two}}))
"""


class Command(unittest.TestCase):
    def compare(self, *times):
        with tempfile.TemporaryDirectory() as scratch:
            programs = []
            for number, time in enumerate(times):
                path = Path(scratch) / f"program-{number}"
                path.write_text(textwrap.dedent(PROGRAM).format(python=sys.executable, time=time))
                path.chmod(path.stat().st_mode | stat.S_IXUSR)
                programs.append(path)
            return subprocess.run([paths.ROOT / "tools" / "bench-compare", "--programs", *programs, "--rounds",
                                   "6", "--filter", "."], capture_output=True, text=True)

    def test_a_slower_program_is_exit_code_1_and_named(self):
        done = self.compare(50, 60)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stdout, r"other/10 .* 1\.\d+ to 1\.\d+  slower")
        self.assertRegex(done.stdout, r"steady/10 .* to 1\.\d+  \n")

    def test_equal_and_faster_programs_pass(self):
        for times in ((50, 50), (60, 50)):
            self.assertEqual(self.compare(*times).returncode, 0)

    def test_bad_requests_are_exit_code_2(self):
        tool = paths.ROOT / "tools" / "bench-compare"
        for arguments in (["no-such-commit"], [], ["HEAD", "--rounds", "7"]):
            self.assertEqual(subprocess.run([tool, *arguments], capture_output=True).returncode, 2)


if __name__ == "__main__":
    unittest.main()

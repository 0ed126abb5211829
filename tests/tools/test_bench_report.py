# SPDX-License-Identifier: MIT
"""tools/bench report: the table of speeds, with a stand-in for the benchmark program and for whole runs."""
import contextlib
import io
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import paths  # noqa: F401
from spume_tools.bench import program, report, roofline, stages

MACHINE = {"memory_bytes_per_second": 74e9, "cache_bytes_per_second": 357e9, "flops_per_second": 489e9, "gathers_per_second": 6.4e9}


def stand_in(folder, times):
    """A program that answers the filter of the table with one entry per routine; every call takes the next of `times`."""
    names = sorted({row.routine for row in report.ROWS if row.routine} | {report.LES_STEP})
    script = Path(folder) / "spume_bench"
    script.write_text(f"""#!/usr/bin/env python3
import json, pathlib, re, sys
pattern = [a.split("=", 1)[1] for a in sys.argv if a.startswith("--benchmark_filter=")][0]
calls = pathlib.Path({str(Path(folder) / 'calls')!r})
call = int(calls.read_text()) if calls.exists() else 0
calls.write_text(str(call + 1))
entries = [dict(run_name="machine/threads:2/iterations:1", **{MACHINE!r})]
for name in {names!r}:
    if re.search(pattern, name):
        t = {times!r}[call]
        entries.append(dict(run_name=name, time_per_particle=t, real_time=1e6 * t, time_unit="ms", of_limit=0.25))
print(json.dumps(dict(benchmarks=entries)))
""")
    script.chmod(0o755)
    return script


class Report(unittest.TestCase):
    def table(self, times, whole_run=lambda bench: 0.5):
        rows = [row for row in report.ROWS if row.routine] + [
            report.Row("a run", 0.6, "M/s", "tools/bench program step", whole_run=whole_run, more_is_better=True)]
        said = io.StringIO()
        with tempfile.TemporaryDirectory() as folder, mock.patch.object(report, "ROWS", rows), \
                mock.patch("sys.argv", ["report", "spume", str(stand_in(folder, times)), "--rounds", str(len(times)), "--only", "speeds"]), \
                contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            code = report.main()
        return code, said.getvalue()

    def test_every_line_gives_median_range_and_share_and_the_machine_is_named(self):
        code, said = self.table([60e-9, 40e-9, 50e-9])
        self.assertEqual(code, 0)
        self.assertIn("memory 74 GB/s, cache 357 GB/s, 489 GFLOP/s, 6.4 G records", said)
        self.assertIn("| neighbour lists, 1,000,000 particles | 75 ns per particle | 50 (40 to 60) | 25 % | `tools/bench routines` |", said)
        self.assertIn("| `spectral`: step, 128^3, double | 0.13 s | 5e-05 (4e-05 to 6e-05) |", said)
        # 1 / 50 ns are 20 M/s; a ratio is taken within a round.
        self.assertIn("| `wcsph`: one phase, 97,336 particles, 3-D | 4 M particle-steps/s | 20 (16.7 to 25) |", said)
        self.assertIn("27,000 particles | 0.8 times | 1 (1 to 1) |", said)

    def test_missed_targets_are_bold_whichever_way_they_are_missed(self):
        _, said = self.table([80e-9])
        self.assertIn("| 75 ns per particle | **80** |", said)
        self.assertIn("| a run | 0.6 M/s | **0.5** |", said)

    def test_a_busy_machine_is_said(self):
        self.assertIn("these are not its speeds", report.conditions(MACHINE, 1.5))
        self.assertNotIn("these are not its speeds", report.conditions(MACHINE, 0.1))

    def test_a_run_that_fails_ends_the_report_with_the_reason(self):
        def fails(bench):
            return program.Bench("/bin/false", tempfile.gettempdir()).run("a case")[1]
        code, said = self.table([1e-9], fails)
        self.assertEqual(code, 1)
        self.assertIn("exit code 1", said)

    def test_stages_of_a_method_are_counted_against_the_limit_that_binds(self):
        ledger = {"stages": [
            {"stage": "start", "calls": 1, "seconds": 5.0, "particles": 10, "pairs": 0, "bytes": 1e9},
            {"stage": "pressure", "calls": 20, "seconds": 3.0, "particles": 2e6, "pairs": 6.4e9, "bytes": 74e9},
            {"stage": "move", "calls": 20, "seconds": 0.5, "particles": 2e6, "pairs": 0, "bytes": 18.5e9},
            {"stage": "bodies", "calls": 20, "seconds": 0.5, "particles": 0, "pairs": 0, "bytes": 0}]}
        run = mock.Mock(ledger=ledger, summary={"particles": 100_000, "steps_this_process": 20})
        pressure, move, bodies = stages.entries(run, MACHINE, 2)  # the start is no part of a step
        # 74e9 bytes at 74e9 a second and 6.4e9 pairs at 6.4e9 a second are a second each of the three.
        self.assertAlmostEqual(pressure["of_limit"], 1 / 3)
        self.assertAlmostEqual(pressure["share"], 0.75)
        self.assertAlmostEqual(pressure["ns_per_particle"], 1500)
        self.assertEqual((move["bound_by"], move["of_limit"]), ("memory", 0.5))
        self.assertNotIn("of_limit", bodies)
        self.assertIn("| move | 250 | 12.5 % | 50 % | memory |", stages.table("gfd", run, MACHINE, 2))
        ledger["stages"][1]["seconds"] = 4.0
        self.assertIn("**25 %**", stages.table("gfd", run, MACHINE, 2))
        drawn = Path(tempfile.gettempdir()) / "roofline-of-stages.png"
        entries = [entry for threads in (1, 2) for entry in stages.entries(run, MACHINE, threads) if "of_limit" in entry]
        self.assertIn("pressure, 2 threads", roofline.table({1: MACHINE, 2: MACHINE}, entries))
        roofline.draw({1: MACHINE, 2: MACHINE}, entries, drawn)
        self.assertGreater(drawn.stat().st_size, 10_000)
        drawn.unlink()

    def test_a_run_of_every_method_ends_and_counts_its_stages(self):
        with tempfile.TemporaryDirectory() as folder:
            bench = program.Bench(paths.ROOT / "build" / "release" / "spume", folder)
            coarse = {"les-sph": "resolution.spacing=0.025", "gfd": "resolution.spacing=0.05",
                      "wcsph": "resolution.spacing=0.05", "spectral": "resolution.grid=16"}
            for method in stages.RUNS:
                run = stages.measure(bench, method, 1, ("--set", coarse[method]))
                self.assertEqual(run.summary["method"], method)
                found = stages.entries(run, MACHINE, 1)
                self.assertAlmostEqual(sum(entry["share"] for entry in found), 1)
                self.assertTrue(any("of_limit" in entry for entry in found), method)

    def test_memory_of_a_run_is_not_that_of_what_started_it(self):
        ballast = bytearray(300_000_000)
        ballast[::4096] = b"1" * len(ballast[::4096])  # each page, so that it is resident
        with tempfile.TemporaryDirectory() as folder:
            bench = program.Bench(paths.ROOT / "build" / "release" / "spume", folder)
            run, _ = bench.run(paths.ROOT / "cases" / "taylor_green_2d" / "case.toml", "--set", "resolution.spacing=0.05", "--until", "0.01")
            self.assertLess(run.summary["peak_resident_bytes"], len(ballast) / 2)

    def test_every_benchmark_of_the_table_exists(self):
        bench = paths.ROOT / "build" / "release" / "bench" / "spume_bench"
        if not bench.exists():
            self.skipTest("spume_bench is not built")
        listed = report.subprocess.run([bench, "--benchmark_list_tests"], capture_output=True, text=True, check=True).stdout
        for row in report.ROWS:
            if row.routine:
                self.assertIn(row.routine, listed.splitlines())


if __name__ == "__main__":
    unittest.main()

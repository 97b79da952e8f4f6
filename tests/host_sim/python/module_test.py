"""The notebook module against the program and against itself:   PYTHONPATH=build/host/python python3 tests/host_sim/python/module_test.py"""
import gc
import json
import os
import pathlib
import signal
import subprocess
import tempfile
import threading
import unittest

import numpy as np
import pandas as pd

import rigtwin

PROGRAM = str(pathlib.Path(rigtwin._core.__file__).parents[2] / "bin" / "rigtwin")
CAR = pathlib.Path("firmware/controller/rigs/example_quarter_car.toml")


class Module(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.file = cls.folder / "car.toml"
        subprocess.run([PROGRAM, "init", "--kind", "quarter_car", "--out", cls.file], check=True, capture_output=True)
        cls.rig = rigtwin.Rig.load(cls.file)

    def test_simulates_the_programs_bits(self):
        out = self.folder / "run.csv"
        subprocess.run([PROGRAM, "simulate", "--rig", self.file, "--duration", "3", "--seed", "7", "--out", out], check=True,
                       capture_output=True)
        here, there = rigtwin.simulate(self.rig, duration=3, seed=7), rigtwin.read(out)
        self.assertEqual(here.index.name, "t")
        self.assertEqual(here.attrs["units"]["z_r"], "m")
        for name in ("z_r", "zdd_b", "dz_b"):
            np.testing.assert_array_equal(here[name].to_numpy(), there[name].to_numpy())

    def test_columns_are_the_recordings_own_memory(self):
        recording = rigtwin._core.simulate(self.rig.text, self.rig.source, "iso8608:B", 27.78, 2.0, 1, None, None, True, False, None)
        frame = rigtwin._frame(recording)
        column = next(values for name, _, values in recording.columns() if name == "z_r")
        self.assertTrue(np.shares_memory(frame["z_r"].to_numpy(), column))
        last = frame["z_r"].iloc[-1]
        del recording, column
        gc.collect()
        self.assertEqual(frame["z_r"].iloc[-1], last)  # the frame keeps what it shows

    def test_frames_come_back_from_every_format(self):
        frame = rigtwin.simulate(self.rig, duration=1)
        for ending in (".csv", ".mat", ".mf4", ".mcap"):
            rigtwin.write(self.folder / f"frame{ending}", frame)
            back = rigtwin.read(self.folder / f"frame{ending}")
            np.testing.assert_allclose(back["dz_b"].to_numpy(), frame["dz_b"].to_numpy(), rtol=1e-12, atol=0)

    def test_foreign_text_says_what_it_was_taken_for(self):
        (self.folder / "foreign.csv").write_text("Zeit [s];Kraft [kN];Temp [degC]\n" +
                                                 "".join(f"{i / 100};{np.sin(i / 7):.5f};20\n" for i in range(500)))
        frame = rigtwin.read(self.folder / "foreign.csv", map=["F=Kraft [kN]"])
        self.assertAlmostEqual(frame["F"].iloc[11], 1000 * round(np.sin(11 / 7), 5), places=6)
        self.assertIsInstance(frame.attrs["left_out"], dict)

    def test_an_edited_rig_keeps_its_comments_and_says_what_is_wrong(self):
        softer = self.rig.edit({"suspension.stiffness": 25e3, "effects.coulomb_friction.force": 40.0})
        self.assertEqual(softer.suspension.stiffness, 25e3)
        self.assertEqual(softer.effects["coulomb_friction"]["force"], 40.0)
        comments = [line for line in self.rig.text.split("\n") if line.lstrip().startswith("#")]
        self.assertTrue(comments)
        for line in comments:
            self.assertIn(line, softer.text)
        self.assertEqual(softer.edit({"suspension.stiffness": self.rig.suspension.stiffness, "effects.coulomb_friction.force": None}), self.rig)
        softer.save(self.folder / "softer.toml")
        self.assertEqual(rigtwin.Rig.load(self.folder / "softer.toml"), softer)
        with self.assertRaises(rigtwin.InputError) as caught:
            self.rig.edit({"suspension.stifness": 1.0})
        self.assertIn("stifness", str(caught.exception))
        self.assertEqual(caught.exception.file, str(self.file))
        self.assertGreater(caught.exception.line, 1)

    def test_a_rig_is_copied_and_its_inner_tables_are_edited(self):
        import copy
        import pickle
        self.assertEqual(copy.deepcopy(self.rig), self.rig)
        self.assertEqual(pickle.loads(pickle.dumps(self.rig)), self.rig)
        with_law = self.rig.edit({"laws.knee.place": "suspension", "laws.knee.over": "velocity", "laws.knee.at": [-1.0, 0.0, 1.0],
                                  "laws.knee.value": np.array([-100.0, 0.0, 90.0])})
        self.assertEqual(with_law.edit({"laws.knee.at": [-2.0, 0.0, 2.0]}).keys["laws"]["knee"]["at"], [-2.0, 0.0, 2.0])

    def test_much_output_and_progress_do_not_hold_each_other_up(self):
        done = rigtwin._run(["effects", "--json", "-"], progress=lambda share, words: None)
        self.assertGreater(len(done), 10_000)

    def test_compare_sees_what_was_changed(self):
        frame = rigtwin.simulate(self.rig.edit({"suspension.stiffness": 1.2 * self.rig.suspension.stiffness}), duration=5)
        same, other = rigtwin.compare(self.rig, rigtwin.simulate(self.rig, duration=5)), rigtwin.compare(self.rig, frame)
        self.assertLess(same.channels["dz_b"]["nrmse"], 0.2 * other.channels["dz_b"]["nrmse"])
        self.assertIn("srcdoc", other._repr_html_())
        self.assertEqual(other["schema"], "rigtwin/compare/1")

    def test_diagnose_names_friction_and_shows_progress(self):
        truth = self.rig.edit({"effects.coulomb_friction.force": 60.0})
        shares = []
        verdict = rigtwin.diagnose(self.rig, rigtwin.simulate(truth, duration=10), progress=lambda share, words: shares.append(share))
        self.assertEqual(verdict.effects[0]["name"], "coulomb_friction")
        self.assertIn("coulomb_friction", verdict.rig.effects)
        self.assertIn("<html", verdict.report.lower())
        self.assertEqual(shares, sorted(shares))
        self.assertTrue(shares)

    def test_errors_of_the_program_are_exceptions(self):
        with self.assertRaises(rigtwin.UsageError):
            rigtwin.plan(self.rig, nonsense=1)
        with self.assertRaises(rigtwin.InputError):
            rigtwin.compare(self.rig, self.folder / "no_such.csv")
        with self.assertRaises(rigtwin.InputError):
            rigtwin.write(self.folder / "x.csv", pd.DataFrame({"z_r": [0.0]}, index=[0.0]))
        with self.assertRaises(rigtwin.OutputError):
            rigtwin.write(self.folder / "x.h5", rigtwin.simulate(self.rig, duration=1))

    def test_the_interpreter_runs_on_and_ctrl_c_gets_through(self):
        ticks, stop = [], threading.Event()
        threading.Thread(target=lambda: [ticks.append(1) for _ in iter(lambda: stop.wait(0.002), True)], daemon=True).start()
        interrupted = []

        def interrupt(share):
            if not interrupted:
                interrupted.append(share)
                os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            rigtwin.simulate(self.rig, duration=600, progress=interrupt)
        self.assertTrue(interrupted)
        before = len(ticks)
        rigtwin.simulate(self.rig, duration=60)
        self.assertGreater(len(ticks), before)
        stop.set()

    def test_live_takes_datagrams(self):
        import socket
        import time

        def send():
            time.sleep(0.2)
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
                for i in range(5):
                    sender.sendto(json.dumps({"timestamp": 0.1 * i, "F": 2.0 * i, "state": "running", "setup": {}}).encode(), ("127.0.0.1", 9873))
                sender.sendto(b"no json", ("127.0.0.1", 9873))

        threading.Thread(target=send).start()
        frame = rigtwin.live(1.0, port=9873)
        self.assertEqual(list(frame["F"]), [0.0, 2.0, 4.0, 6.0, 8.0])
        self.assertEqual(frame.index.name, "t")


if __name__ == "__main__":
    unittest.main()

"""The module on runs of shipped cases: `FREEPLAY=target/release/freeplay python -m unittest`.

Known in advance: what the file holds, a drive of 5000 revolutions a minute that turns by 2π in
12 ms, straight lines and cubics that come back as they were.
"""

import tempfile
import unittest
from decimal import Decimal
from pathlib import Path

import freeplay
import numpy
import xarray

CASES = Path(__file__).resolve().parents[2] / "cases"
REVOLUTION = 0.012  # s


class OnARun(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name) / "c.h5"
        settings = {"duration": 0.030, "sampling": "adaptive"}
        cls.run_c = freeplay.run(CASES / "four-bar-c.toml", cls.path, run=settings)

    @classmethod
    def tearDownClass(cls):
        cls.run_c.close()
        cls.folder.cleanup()

    def test_items_go_by_name(self):
        run = self.run_c
        self.assertEqual(list(run.clearance.values), ["A", "B", "B0"])
        self.assertEqual(list(run.body.values), ["crank", "coupler", "follower"])
        plain = xarray.open_dataset(self.path, engine="h5netcdf", decode_times=False)
        for k, name in enumerate(["A", "B", "B0"]):
            here = run.normal_force.sel(clearance=name)
            self.assertTrue((here.values == plain.normal_force.values[:, k]).all())
        plain.close()

    def test_the_line_in_the_readme_names_the_items_too(self):
        readme = (CASES.parent / "README.md").read_text(encoding="utf-8")
        line = next(line for line in readme.splitlines() if "flag_meanings" in line and "=" in line)
        scope = {"run": xarray.open_dataset(self.path, engine="h5netcdf")}
        exec(line, scope)
        self.assertTrue(scope["run"].body.equals(self.run_c.body.drop_attrs()))
        scope["run"].normal_force.sel(clearance="B0")
        scope["run"].close()

    def test_tables_have_words_for_indices_and_flags(self):
        contacts, events = freeplay.contacts(self.run_c), freeplay.events(self.run_c)
        self.assertEqual(len(contacts), self.run_c.sizes["contact"])
        self.assertEqual(set(contacts.clearance), {"A", "B", "B0"})
        self.assertEqual(contacts.attrs["units"]["peak_force"], "N")
        begins = events[events.kind == "contact_begins"]
        self.assertTrue((begins.time.to_numpy() == contacts.sort_values("begin").begin).all())
        k = self.run_c.contact_clearance.values[3]
        self.assertEqual(contacts.clearance[3], "A B B0".split()[k])
        closed = contacts[contacts.end.notna()]
        self.assertTrue((closed.end > closed.begin).all())

    def test_revolutions_are_those_of_the_crank(self):
        run = self.run_c
        angle = freeplay.drive_angle(run)
        self.assertTrue(numpy.allclose(angle, run.time / REVOLUTION * 2 * numpy.pi, atol=1e-12))
        number = freeplay.revolution(run)
        for time, expected in [(0.0, 1), (0.01199, 1), (0.012, 2), (0.024, 3), (0.030, 3)]:
            at = int(numpy.argmin(abs(run.time.values - time)))
            self.assertEqual(number.values[at], expected, time)
        largest = run.normal_force.groupby(number).max()
        self.assertEqual(list(largest.revolution.values), [1, 2, 3])

    def test_the_end_of_a_whole_revolution_belongs_to_it(self):
        number = freeplay.revolution(self.run_c.sel(time=slice(0.0, 0.012)))
        self.assertEqual(set(number.values), {1})

    def test_the_largest_forces_are_the_true_peaks(self):
        largest = freeplay.largest_forces(self.run_c)
        self.assertEqual(list(largest.columns), ["A", "B", "B0"])
        self.assertEqual(list(largest.index), [1, 2, 3])
        peaks = freeplay.peaks(self.run_c)
        first = peaks[(peaks.clearance == "B") & (peaks.time < REVOLUTION)]
        # a sample at the peak may have rounded the other way
        self.assertAlmostEqual(largest.loc[1, "B"] / first.force.max(), 1.0, delta=1e-12)
        samples = self.run_c.normal_force.groupby(freeplay.revolution(self.run_c)).max().values
        self.assertTrue((largest.values >= samples).all())

    def test_uniform_times_are_multiples_and_keep_what_was_sampled_there(self):
        uniform = freeplay.resample(self.run_c, interval=1e-5)
        times = uniform.time.values
        self.assertEqual(len(times), 3001)
        self.assertTrue(numpy.allclose(numpy.diff(times), 1e-5, rtol=1e-9))
        at = self.run_c.sel(time=times, method="nearest")
        for name, scale in [("angle", 1e-9), ("velocity_x", 1e-6), ("normal_force", 1e-3)]:
            self.assertLess(float(abs(uniform[name].values - at[name].values).max()), scale, name)
        self.assertTrue((uniform.in_contact.values == at.in_contact.values).mean() > 0.999)
        self.assertEqual(uniform.normal_force.attrs["units"], "N")
        self.assertEqual(list(uniform.clearance.values), ["A", "B", "B0"])

    def test_uniform_angles_are_those_of_the_crank(self):
        orders = freeplay.resample(self.run_c, per_revolution=360)
        self.assertEqual(orders.normal_force.dims, ("drive_angle", "clearance"))
        self.assertEqual(orders.sizes["drive_angle"], 901)
        crank = orders.angle.sel(body="crank").values
        self.assertTrue(numpy.allclose(crank, orders.drive_angle, atol=1e-12))
        self.assertTrue(numpy.allclose(orders.time, numpy.arange(901) * REVOLUTION / 360, atol=1e-15))

    def test_what_cannot_be_resampled_is_refused(self):
        for settings in [{}, {"interval": 1e-5, "per_revolution": 3}, {"interval": 0.0}]:
            with self.assertRaises(ValueError):
                freeplay.resample(self.run_c, **settings)
        with self.assertRaisesRegex(ValueError, "no drive 'motor'; there are crank"):
            freeplay.drive_angle(self.run_c, "motor")


class OnAFunction(unittest.TestCase):
    def test_cubics_come_back_as_they_were(self):
        known = numpy.array([0.0, 0.1, 0.15, 0.4, 1.0])
        cubic = numpy.polynomial.Polynomial([1.0, -2.0, 3.0, 4.0])
        time = xarray.Variable("time", known, {"units": "s"})
        shape = lambda values: (("time", "body"), values[:, None])
        run = xarray.Dataset(
            {"angle": shape(cubic(known)), "angular_velocity": shape(cubic.deriv()(known))},
            coords={"time": time, "body": ["rod"]},
        )
        taken = freeplay.resample(run, interval=0.05)
        self.assertEqual(taken.sizes["time"], 21)
        self.assertTrue(numpy.allclose(taken.angle[:, 0], cubic(taken.time), atol=1e-14))


class OnTheProgram(unittest.TestCase):
    def test_a_run_without_a_file_is_in_memory_and_changes_what_is_named(self):
        run = freeplay.run(
            CASES / "four-bar-a.toml",
            ideal=True,
            run={"duration": 0.001, "sample_interval": Decimal("1e-4")},
            changes={"drives.crank.speed_rpm": 2500, "title": 'half the "speed"'},
        )
        self.assertEqual(run.sizes["time"], 11)
        self.assertEqual(run.attrs["title"], 'half the "speed"')
        rate = run.angular_velocity.sel(body="crank").values
        self.assertTrue(numpy.allclose(rate, 2500 * 2 * numpy.pi / 60))
        self.assertEqual(run.sizes["clearance"], 0)
        self.assertEqual(freeplay.largest_forces(run).shape, (1, 0))

    def test_what_the_program_says_is_the_error(self):
        with self.assertRaisesRegex(freeplay.ProgramError, "did you mean") as caught:
            freeplay.run(CASES / "four-bar-a.toml", run={"duratoin": 1.0})
        self.assertEqual(caught.exception.code, 2)
        with self.assertRaises(TypeError):
            freeplay.run(CASES / "four-bar-a.toml", run={"duration": object()})

    def test_a_mechanism_without_drive_has_no_revolutions(self):
        run = freeplay.run(CASES / "pendulum.toml", run={"duration": 0.01})
        with self.assertRaisesRegex(ValueError, "no drive"):
            freeplay.revolution(run)


if __name__ == "__main__":
    unittest.main()

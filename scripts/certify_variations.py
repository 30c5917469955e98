"""Certifies variations of the shipped cases and holds each certificate against a run in 71 digits at
a tolerance of 1e-44 with steps of a 173rd of the time, and against the events of IDA at 1e-13.

Usage: certify_variations.py FREEPLAY FOLDER [NAME ...], from the project's root; the result files
go into FOLDER. A line a variation; `over` is by how many digits a claim exceeds the truth."""

import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np

OF_A = "joints.A.clearance."
OF_O = "joints.O.clearance."
HERTZ = 'stiffness = "hertz-printed", young = 207e9, poisson = 0.3'


def damped(restitution, stiffness=HERTZ):
    return f'normal={{ law = "lankarani-nikravesh", restitution = {restitution}, {stiffness} }}'


def friction(coefficient, v0, v1):
    return f'friction={{ law = "ambrosio", coefficient = {coefficient}, v0 = {v0}, v1 = {v1} }}'


def start(x, y, velocity_x, velocity_y, rate):
    return (
        f"start.journal={{ x = {x}, y = {y}, angle = 0.0, velocity_x = {velocity_x}, "
        f"velocity_y = {velocity_y}, angular_velocity = {rate}, fixed = true }}"
    )


GRAVITY = 'loads.gravity={ kind = "gravity", acceleration = [0.0, -9.81] }'
FRICTION = OF_O + friction(0.1, 1e-3, 1e-2)

VARIATIONS = {  # name: case, simulated time (s), keys changed
    "a": ("four-bar-a", 0.010, []),
    "b": ("four-bar-b", 0.008, []),
    "c": ("four-bar-c", 0.006, []),
    "friction": ("four-bar-a-friction", 0.010, []),
}
for radial in (0.00005, 0.00015, 0.0005, 0.002):
    VARIATIONS[f"clearance {radial}"] = ("four-bar-a", 0.008, [f"{OF_A}radial={radial:.5f}"])
for restitution in (0.1, 0.3, 0.5, 0.99):
    VARIATIONS[f"restitution {restitution}"] = ("four-bar-a", 0.008, [OF_A + damped(restitution)])
    cut = [OF_A + damped(restitution), OF_A + "tension=cut"]
    VARIATIONS[f"restitution {restitution}, cut"] = ("four-bar-a-friction", 0.006, cut)
for rpm in (500, 2000, 12000):
    VARIATIONS[f"{rpm} rpm"] = ("four-bar-a", 0.006, [f"drives.crank.speed_rpm={rpm}"])
for law in ((0.01, 1e-4, 1e-3), (0.3, 1e-3, 1e-2), (0.5, 0.1, 1.0), (0.1, 0.0, 0.01),
            (0.1, 0.5, 3.0), (0.05, 0.009, 0.01)):  # fmt: skip
    VARIATIONS[f"friction {law}"] = ("four-bar-a-friction", 0.006, [OF_A + friction(*law)])
for exponent, stiffness in (("1", 1e7), ("1.25", 1e9), ("1.3", 1e9), ("1.37", 1e9),
                            ("1.3333333333333333", 2e9), ("2", 1e12)):  # fmt: skip
    law = damped(0.9, f"stiffness = {stiffness}, exponent = {exponent}")
    VARIATIONS[f"exponent {exponent}"] = ("four-bar-a", 0.004, [OF_A + law])
VARIATIONS |= {
    "gravity": ("four-bar-a", 0.006, [GRAVITY]),
    "soft begins": ("four-bar-a", 0.008, [OF_A + "minimum_impact_rate=0.5"]),
    "circling": ("journal-in-bearing", 0.012, [GRAVITY]),
    "rest": ("journal-in-bearing", 0.02, [start(0, -0.001, 0, 0, 0), OF_O + damped(0.9), GRAVITY]),
    "glide": (
        "journal-in-bearing",
        0.02,
        [start(0.001, 0, 0, 0.2, 10), OF_O + damped(0.9), FRICTION, GRAVITY],
    ),
    "graze": ("journal-in-bearing", 0.01, [start(0, 0.00099999999, 0.3, 0, 0), OF_O + damped(0.9)]),
    "settle": ("journal-in-bearing", 0.05, [start(2e-4, 0, 0, 0, 30), OF_O + damped(0.5), FRICTION, GRAVITY]),
    "samples at events": ("journal-in-bearing", 0.01, [start(0, 0, 1, 0, 0), OF_O + damped(0.9)]),
}


def run(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(done.stderr)
    return done.stdout


def state(file, scales):
    columns = [file["angle"][:], file["angular_velocity"][:] / scales["scale_angular_velocity"]]
    columns += [file[name][:] / scales["scale_velocity"] for name in ("velocity_x", "velocity_y")]
    radial = [scales[f"scale_clearance_{k}"] for k in range(file["clearance_x"].shape[1])]
    columns += [file[name][:] / radial for name in ("clearance_x", "clearance_y")]
    return np.hstack(columns)


def judge(freeplay, folder, name):
    case, until, keys = VARIATIONS[name]
    certified, finer = (folder / f"{name}.{what}.h5" for what in ("certified", "finer"))
    keys = [*keys, f"run.duration={until}", f"run.sample_interval={until / 32}"]
    fine = ["solver.engine=explicit", "solver.precision=71", "solver.reference_tolerance=1e-44"]
    fine.append(f"solver.max_step={until / 173}")

    def words(command, output, more):
        sets = [word for key in keys + more for word in ("--set", key)]
        return [command, f"cases/{case}.toml", "--quiet", "--force", "--output", output, *sets]

    said = run(freeplay, *words("certify", certified, ["solver.relative_tolerance=1e-13"]))
    run(freeplay, *words("run", finer, fine))
    with h5py.File(certified) as ours, h5py.File(finer) as theirs:
        claimed = ours["reference_digits"][:]
        off = np.abs(state(ours, ours.attrs) - state(theirs, ours.attrs)[: len(claimed)]).max(axis=1)
        wrong = off > 10.0**-claimed + 2.3e-16  # and what the doubles of the finer run lose
        over = (claimed + np.log10(off, where=wrong, out=-claimed))[wrong].max(initial=0.0)
        kinds = [list(zip(f["event_kind"], f["event_clearance"])) for f in (ours, theirs)]
        events = "same events" if kinds[0] == kinds[1] else "OTHER EVENTS"
    ida = "and in IDA" if "parting      none" in said else "PARTS FROM IDA"
    print(f"{name:28} {claimed.min():5.1f} {over:5.1f} over, {len(kinds[0])} {events} {ida}", flush=True)


if __name__ == "__main__":
    for chosen in sys.argv[3:] or VARIATIONS:
        judge(Path(sys.argv[1]).resolve(), Path(sys.argv[2]), chosen)

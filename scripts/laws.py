"""Compares laws of contact and friction, one changed at a time, on case a and on a slider-crank.

Usage: laws.py FREEPLAY FOLDER [NAME ...], from the project's root. Names are of laws as `freeplay laws`
has them; none: all. Result files go into FOLDER, and `laws.md` with a table for each mechanism."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

# case, joint with clearance, drive, simulated time (s)
MECHANISMS = {
    "four-bar-a": ("cases/four-bar-a.toml", "A", "crank", 0.060),
    "slider-crank": ("tests/kinds/slider-crank-wrist-pin.toml", "B", "crank", 0.060),
}
RESTITUTION = 0.7
HEADS = [
    "law",
    "contacts",
    "in contact, last revolution",
    "largest force (N)",
    "over the ideal one",
    "torque over the ideal one",
    "dissipated (J)",
    "true until (ms)",
]


def toml(value):
    """A value as TOML has it."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(entry)}" for key, entry in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value) if isinstance(value, str) else repr(value)


def example(law, key):
    """The table that the example of a law has for a key of a clearance."""
    return tomllib.loads(law["example"])["joints"]["A"]["clearance"][key]


def laws(freeplay):
    """Every law: its name, and the keys of a clearance that it changes."""
    menu = json.loads(subprocess.check_output([freeplay, "laws", "--json"]))
    power = next(law for law in menu["elastic"] if law["law"] == "power")
    for law in menu["normal"]:
        table = example(power, "normal") | {"law": law["law"], "restitution": RESTITUTION}
        if not law["takes_restitution"]:
            del table["restitution"]
        yield law["law"], {"normal": table}
    exact = {"law": "exact", "restitution": RESTITUTION}
    for law in menu["elastic"]:
        yield f"exact, {law['law']}", {"normal": example(law, "normal") | exact}
    for law in menu["own_damping"]:
        yield law["law"], {"normal": example(law, "normal")}
    normal = example(power, "normal") | exact
    for law in menu["friction"]:
        yield f"exact, {law['law']}", {"normal": normal, "friction": example(law, "friction")}


def run(freeplay, case, output, settings):
    """Runs a case, unless its result is there."""
    if output.exists():
        return
    command = [freeplay, "run", case, "--quiet", "-o", str(output)]
    for key, value in settings.items():
        command += ["--set", f"{key}={value}"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def largest(column):
    """The largest magnitude that a summary has of a column."""
    return max(abs(column[side]["value"]) for side in ("largest", "smallest") if side in column)


def row(freeplay, name, output, ideal, joint, drive):
    """A line of the table."""
    command = [freeplay, "summary", str(output), "--against", str(ideal), "--json"]
    told = json.loads(subprocess.check_output(command))
    force = told["columns"][f"joint_force.{joint}"]
    torque = told["columns"][f"drive_torque.{drive}"]
    clearance = told["clearances"][joint]
    share = clearance["revolutions"][-1]["share_in_contact"]["value"]
    horizon = told["horizon"]["state"]
    return [
        name,
        clearance["contacts"],
        f"{share:.3f}",
        f"{largest(force):.0f}",
        f"{largest(force) / largest(force['reference']):.2f}",
        f"{largest(torque) / largest(torque['reference']):.2f}",
        f"{clearance['dissipated']['value']:.4f}",
        "–" if horizon is None else f"{1e3 * horizon:.1f}",
    ]


def main():
    freeplay, folder, *names = sys.argv[1:]
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    chosen = [(name, keys) for name, keys in laws(freeplay) if not names or name in names]
    text = f"# Laws, one changed at a time\n\nNominal restitution {RESTITUTION} where a law takes one.\n"
    for mechanism, (case, joint, drive, duration) in MECHANISMS.items():
        ideal = folder / f"{mechanism}-ideal.h5"
        if not ideal.exists():
            command = [freeplay, "run", case, "--ideal", "--quiet", "-o", str(ideal)]
            subprocess.run(command + ["--set", f"run.duration={duration}"], check=True, stdout=subprocess.DEVNULL)
        text += f"\n## {mechanism}\n\n| {' | '.join(HEADS)} |\n|{'---|' * len(HEADS)}\n"
        for name, keys in chosen:
            output = folder / f"{mechanism}-{name.replace(', ', '-')}.h5"
            settings = {f"joints.{joint}.clearance.{key}": toml(table) for key, table in keys.items()}
            run(freeplay, case, output, settings | {"run.duration": duration})
            cells = map(str, row(freeplay, name, output, ideal, joint, drive))
            text += f"| {' | '.join(cells)} |\n"
    (folder / "laws.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()

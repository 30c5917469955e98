"""Largest force in joint A of the paper's four cases, beside the paper's claim.

Usage: paper_table.py FOLDER, which holds the result files."""

import sys
from pathlib import Path

import h5py
import numpy as np

CLAIMED = {"four-bar-ideal": 1.0, "four-bar-a": 1.4, "four-bar-b": 3.7, "four-bar-c": 5.2}


def largest_force_in_a(run):
    """N; of a joint with clearance the true peak of a contact, else the largest sample."""
    if "A" in names(run, "clearance"):
        in_a = run["contact_clearance"][:] == names(run, "clearance").index("A")
        return run["contact_peak_force"][:][in_a].max()
    a = names(run, "joint").index("A")
    return np.hypot(run["joint_force_x"][:, a], run["joint_force_y"][:, a]).max()


def names(run, dimension):
    meanings = run[dimension].attrs.get("flag_meanings", b"")
    return (meanings.decode() if isinstance(meanings, bytes) else str(meanings)).split()


folder = Path(sys.argv[1])
print(f"{'case':<16}{'contacts':>10}{'largest force in A (N)':>25}{'over ideal':>12}{'paper claims':>14}")
for case, claimed in CLAIMED.items():
    with h5py.File(folder / f"{case}.h5") as run:
        force = largest_force_in_a(run)
        if case == "four-bar-ideal":
            ideal = force
        contacts = len(run["contact"])
    print(f"{case:<16}{contacts:>10}{force:>25.2f}{force / ideal:>12.2f}{claimed:>14}")
print("""
The model as printed in the paper does not give the ratios that the paper prints. In exact
arithmetic its largest ratios in these five revolutions are 15.2, 12.8 and 12.4, and every
revolution of case a has impacts, where the paper shows a smooth motion. A radial clearance of
0.15 mm in place of 1 mm gives case a its 1.40, once the contact has settled.

The motion is chaotic: runs in double precision, as these, follow the exact one until about 60,
36 and 18 ms in cases a, b and c.""")

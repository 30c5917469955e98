"""Result files of freeplay in xarray and pandas, and runs of the program.

    import freeplay
    run = freeplay.open("four-bar-c.h5")
    run.normal_force.sel(clearance="A").plot()
"""

from freeplay.program import ProgramError, run
from freeplay.result import contacts, events, open, peaks
from freeplay.revolutions import drive_angle, largest_forces, revolution
from freeplay.sampling import resample

__all__ = [
    "ProgramError",
    "contacts",
    "drive_angle",
    "events",
    "largest_forces",
    "open",
    "peaks",
    "resample",
    "revolution",
    "run",
]

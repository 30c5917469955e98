"""Draws the clearance vector of a joint with xarray: RESULT.h5 JOINT PICTURE."""

import sys

import matplotlib.pyplot as plt
import xarray

path, joint, picture = sys.argv[1:4]
run = xarray.open_dataset(path, engine="h5netcdf")
run = run.assign_coords(clearance=run.clearance.flag_meanings.split())
here = run.sel(clearance=joint)

plt.plot(here.clearance_x * 1e3, here.clearance_y * 1e3, linewidth=0.5)
plt.axis("equal")
plt.xlabel("x (mm)")
plt.ylabel("y (mm)")
plt.title(f"Journal centre in joint {joint}")
plt.savefig(picture)
print(f"{joint}: largest eccentricity {float(here.eccentricity.max())!r} m")

"""Draws the clearance vector of a joint with h5py: RESULT.h5 JOINT PICTURE."""

import sys

import h5py
import matplotlib.pyplot as plt

path, joint, picture = sys.argv[1:4]
with h5py.File(path) as run:
    k = run["clearance"].attrs["flag_meanings"].decode().split().index(joint)
    x, y = run["clearance_x"][:, k], run["clearance_y"][:, k]
    largest = run["eccentricity"][:, k].max()

plt.plot(x * 1e3, y * 1e3, linewidth=0.5)
plt.axis("equal")
plt.xlabel("x (mm)")
plt.ylabel("y (mm)")
plt.title(f"Journal centre in joint {joint}")
plt.savefig(picture)
print(f"{joint}: largest eccentricity {float(largest)!r} m")

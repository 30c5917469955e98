"""Draws the clearance vector of a joint with pandas: RESULT.h5 JOINT PICTURE.

The same table comes from `freeplay export RESULT.h5 --to parquet -o RESULT.parquet` by
`pandas.read_parquet("RESULT.parquet").set_index("time")`, or from `--to csv` by `read_csv`.
"""

import sys

import h5py
import matplotlib.pyplot as plt
import pandas

path, joint, picture = sys.argv[1:4]


def load(path: str) -> pandas.DataFrame:
    """Everything over time: a row a sample, columns named `dataset.item`."""
    columns = {}
    with h5py.File(path) as run:
        for name, data in run.items():
            if data.is_scale or data.dims[0].keys() != ["time"]:
                continue
            if data.ndim == 1:
                columns[name] = data[()]
            elif data.shape[1] > 0:
                items = data.dims[1][0].attrs["flag_meanings"].decode().split()
                columns |= {f"{name}.{item}": data[:, k] for k, item in enumerate(items)}
        return pandas.DataFrame(columns, index=pandas.Index(run["time"], name="time"))


run = load(path)
x, y = run[f"clearance_x.{joint}"], run[f"clearance_y.{joint}"]
plt.plot(x * 1e3, y * 1e3, linewidth=0.5)
plt.axis("equal")
plt.xlabel("x (mm)")
plt.ylabel("y (mm)")
plt.title(f"Journal centre in joint {joint}")
plt.savefig(picture)
print(f"{joint}: largest eccentricity {float(run[f'eccentricity.{joint}'].max())!r} m")

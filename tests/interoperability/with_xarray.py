"""Opens a result file with xarray, by the engine named last on the command line."""

import sys

import xarray
from expected import arguments, check

path, datasets, case = arguments()
with xarray.open_dataset(path, engine=sys.argv[4]) as file:
    check("/", "case_toml", file.attrs["case_toml"], case)
    check("/", "title", file.attrs["title"], "Four-bar linkage, δ ≤ c")
    check("/", "run_status", file.attrs["run_status"], "complete")
    check("body", "flag_meanings", file["body"].attrs["flag_meanings"], "crank coupler follower")
    meanings = file["event_kind"].attrs["flag_meanings"].split()
    check("event_kind", "meaning of 2", meanings[2], "friction_kink")
    for dataset in datasets:
        found = file[dataset.name]
        check(dataset.name, "dimensions", found.dims, dataset.dimensions)
        check(dataset.name, "shape", found.shape, dataset.shape)
        check(dataset.name, "units", found.attrs["units"], dataset.unit)
        dataset.check_values(found.values.reshape(-1))
    coordinates = {"time", "body", "joint", "clearance", "drive", "event", "contact", "peak", "revolution"}
    check("/", "set of coordinates", set(file.coords), coordinates)
    check("/", "set of dimensions", set(file.sizes), coordinates)

"""Has xarray save a result file again: FILE OUTPUT ENGINE."""

import sys

import xarray as xr

file, output, engine = sys.argv[1:]
xr.open_dataset(file, engine=engine).to_netcdf(output, engine=engine)

"""A result file as an xarray.Dataset, and its tables as DataFrames."""

import os

import pandas
import xarray

NAMED = ("body", "joint", "clearance", "drive")
"""Dimensions whose items have names."""


def open(file: str | os.PathLike) -> xarray.Dataset:
    """Opens a result file; bodies, joints, clearances and drives have names as coordinates.

    Values are read when they are asked for: the file must stay where it is, and the Dataset be
    closed, or used in a `with`, before the file is replaced.
    """
    run = xarray.open_dataset(file, engine="h5netcdf", decode_times=False)
    return run.assign_coords({kind: names(run, kind) for kind in NAMED if kind in run.sizes})


def names(run: xarray.Dataset, kind: str) -> list[str]:
    """Names of the items along a dimension."""
    return run[kind].attrs.get("flag_meanings", "").split()


def contacts(run: xarray.Dataset) -> pandas.DataFrame:
    """A row a contact: clearance, begin, end, impact_rate, peak_force, …; `end` is NaN while open."""
    return table(run, "contact")


def events(run: xarray.Dataset) -> pandas.DataFrame:
    """A row an event: time, clearance, kind, rate."""
    return table(run, "event")


def peaks(run: xarray.Dataset) -> pandas.DataFrame:
    """A row a local maximum of a normal force: time, clearance, force."""
    return table(run, "peak")


def table(run: xarray.Dataset, kind: str) -> pandas.DataFrame:
    """Everything along the dimension `kind`, without `kind_` before the names of the columns.

    Indices of clearances and numbers of flags become words; `attrs["units"]` tells the units.
    """
    columns, units = {}, {}
    for name, values in run.data_vars.items():
        if values.dims == (kind,):
            column = name.removeprefix(f"{kind}_")
            columns[column] = in_words(run, column, values)
            units[column] = values.attrs.get("units", "1")
    frame = pandas.DataFrame(columns, index=pandas.RangeIndex(run.sizes[kind], name=kind))
    frame.attrs["units"] = units
    return frame


def in_words(run: xarray.Dataset, column: str, values: xarray.DataArray):
    """The values of a column; names and meanings where they are indices and flags."""
    if column in NAMED:
        words = run[column].values
    elif "flag_meanings" in values.attrs:
        words = values.attrs["flag_meanings"].split()
    else:
        return values.values
    return [words[int(k)] for k in values.values]

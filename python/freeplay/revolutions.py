"""Angle and revolutions of a drive."""

import tomllib

import numpy
import pandas
import xarray

from freeplay.result import peaks

ROUNDING = 1e-9
"""What of a revolution counts as nothing."""


def drive_angle(run: xarray.Dataset, drive: str | None = None) -> xarray.DataArray:
    """Angle (rad) of the second body of a drive's joint relative to the first, at each sample.

    It is not wrapped. Without a name it is that of the first drive.
    """
    return relative(run, "angle", drive).rename("drive_angle").assign_attrs(
        units="rad", long_name=f"angle of drive {chosen(run, drive)}"
    )


def drive_rate(run: xarray.Dataset, drive: str | None = None) -> xarray.DataArray:
    """Rate (rad/s) of `drive_angle`."""
    return relative(run, "angular_velocity", drive)


def relative(run: xarray.Dataset, dataset: str, drive: str | None) -> xarray.DataArray:
    """A quantity of the second body of a drive's joint minus that of the first."""
    drive = chosen(run, drive)
    case = tomllib.loads(run.attrs["case_toml"])
    joint = case["joints"][case["drives"][drive]["joint"]]
    first, second = (point.split(".")[0] for point in joint["between"])
    of = {body: run[dataset].sel(body=body, drop=True) for body in run.body.values}
    of["ground"] = 0.0
    return of[second] - of[first]


def chosen(run: xarray.Dataset, drive: str | None) -> str:
    """The drive of that name, or the first."""
    known = [str(name) for name in run.drive.values]
    if not known:
        raise ValueError("the mechanism has no drive, and so no revolutions")
    if drive is not None and drive not in known:
        raise ValueError(f"there is no drive {drive!r}; there are {', '.join(known)}")
    return known[0] if drive is None else drive


def revolution(run: xarray.Dataset, drive: str | None = None) -> xarray.DataArray:
    """Number of the revolution of a drive at each sample, from 1; a sample on a boundary begins one.

    The last sample belongs to the revolution that it ends.
    """
    number = numbers(run, run.time.values, drive)
    return xarray.DataArray(
        number, dims="time", coords={"time": run.time}, name="revolution", attrs={"units": "1"}
    )


def numbers(run: xarray.Dataset, times: numpy.ndarray, drive: str | None) -> numpy.ndarray:
    """Numbers of the revolutions that times lie in."""
    if run.sizes["time"] == 0:
        return numpy.zeros(len(times), dtype=int)
    angle = drive_angle(run, drive).values
    turned = numpy.abs(angle - angle[0]) / (2 * numpy.pi)
    last = max(1, int(numpy.ceil(turned.max() - ROUNDING)))
    at = numpy.interp(times, run.time.values, turned)
    return numpy.clip(numpy.floor(at + ROUNDING).astype(int) + 1, 1, last)


def largest_forces(run: xarray.Dataset, drive: str | None = None) -> pandas.DataFrame:
    """Largest normal force (N) of each revolution and clearance; the last may be cut short.

    Peaks are the true ones that the run found between its samples. A contact that is pressed
    through a boundary may be larger there than at any peak: the samples are looked at, too.
    """
    clearances = [str(name) for name in run.clearance.values]
    samples = run.normal_force.to_pandas().groupby(revolution(run, drive).values).max()
    found = peaks(run)
    found["revolution"] = numbers(run, found["time"].to_numpy(), drive)
    true = found.pivot_table(index="revolution", columns="clearance", values="force", aggfunc="max")
    true = true.reindex(index=samples.index, columns=clearances)
    largest = samples[clearances].where(~(true > samples[clearances]), true)
    return largest.rename_axis(index="revolution", columns="clearance")

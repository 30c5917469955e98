"""Samples at uniform times, or at uniform angles of a drive."""

import numpy
import xarray

from freeplay.revolutions import drive_angle, drive_rate

RATES = {
    "position_x": "velocity_x",
    "position_y": "velocity_y",
    "angle": "angular_velocity",
    "velocity_x": "acceleration_x",
    "velocity_y": "acceleration_y",
    "angular_velocity": "angular_acceleration",
    "penetration": "penetration_rate",
}
"""What is interpolated by cubic polynomials through its values and these rates."""


def resample(
    run: xarray.Dataset,
    *,
    interval: float | None = None,
    per_revolution: int | None = None,
    drive: str | None = None,
) -> xarray.Dataset:
    """The samples of a run at uniform times, or at uniform angles of a drive.

    With `interval` (s) times are its multiples from the first sample to the last. With
    `per_revolution` the dimension is `drive_angle` (rad): that many samples in each revolution, from
    the drive's angle at the first sample on, and `time` is a coordinate along it. The drive must
    turn one way all the time.

    Coordinates and velocities are interpolated by cubic polynomials through values and rates,
    `in_contact` is that of the sample before, all else lies on straight lines. Events, contacts and
    peaks are left out.
    """
    if (interval is None) == (per_revolution is None):
        raise ValueError("give either interval (s) or per_revolution")
    if run.sizes["time"] < 2:
        raise ValueError("there is nothing between fewer than two samples")
    if interval is not None:
        return at_times(run, uniform_times(run.time.values, interval))
    times, angles = uniform_angles(run, per_revolution, drive)
    taken = at_times(run, times)
    attrs = {"units": "rad", "long_name": "angle of the drive"}
    return taken.assign_coords(drive_angle=("time", angles, attrs)).swap_dims(time="drive_angle")


def uniform_times(times: numpy.ndarray, interval: float) -> numpy.ndarray:
    """Multiples of the interval from the first time to the last."""
    if not interval > 0:
        raise ValueError(f"interval must be positive (s), is {interval}")
    steps = int(numpy.floor((times[-1] - times[0]) / interval * (1 + 1e-12)))
    return numpy.minimum(times[0] + interval * numpy.arange(steps + 1), times[-1])


def uniform_angles(
    run: xarray.Dataset, per_revolution: int, drive: str | None
) -> tuple[numpy.ndarray, numpy.ndarray]:
    """Times (s) at which a drive has turned by multiples of an angle, and its angles (rad) there."""
    if not per_revolution >= 1:
        raise ValueError(f"per_revolution must be at least 1, is {per_revolution}")
    angle, rate = drive_angle(run, drive).values, drive_rate(run, drive).values
    way = numpy.sign(angle[-1] - angle[0])
    if not (numpy.diff(way * angle) > 0).all():
        raise ValueError("the drive does not turn one way all the time")
    step = 2 * numpy.pi / per_revolution
    steps = int(numpy.floor(abs(angle[-1] - angle[0]) / step * (1 + 1e-12)))
    wanted = angle[0] + way * step * numpy.arange(steps + 1)
    times = numpy.interp(way * wanted, way * angle, run.time.values)
    for _ in range(4):  # Newton: straight lines are right already where the speed is constant
        off = hermite(times, run.time.values, angle, rate) - wanted
        times = times - off / numpy.interp(times, run.time.values, rate)
        times = numpy.clip(times, run.time.values[0], run.time.values[-1])
    return times, wanted


def at_times(run: xarray.Dataset, times: numpy.ndarray) -> xarray.Dataset:
    """Everything over time, at other times."""
    known = run.time.values
    taken = {}
    for name, values in run.data_vars.items():
        if not values.dims or values.dims[0] != "time":
            continue
        if "flag_meanings" in values.attrs:
            before = numpy.searchsorted(known, times, side="right") - 1
            new = values.values[before]
        elif RATES.get(name) in run:
            new = hermite(times, known, values.values, run[RATES[name]].values)
        else:
            new = lines(times, known, values.values)
        taken[name] = (values.dims, new, values.attrs)
    coordinates = {
        kind: run[kind] for kind in ("body", "joint", "clearance", "drive") if kind in run.coords
    }
    coordinates["time"] = ("time", times, run.time.attrs)
    return xarray.Dataset(taken, coords=coordinates, attrs=run.attrs)


def places(times: numpy.ndarray, known: numpy.ndarray) -> numpy.ndarray:
    """Index of the interval of known times that each time lies in."""
    return numpy.clip(numpy.searchsorted(known, times, side="right") - 1, 0, len(known) - 2)


def lines(times: numpy.ndarray, known: numpy.ndarray, values: numpy.ndarray) -> numpy.ndarray:
    """Values on the straight lines between those known."""
    k = places(times, known)
    share = (times - known[k]) / (known[k + 1] - known[k])
    share = share.reshape(share.shape + (1,) * (values.ndim - 1))
    return values[k] * (1 - share) + values[k + 1] * share


def hermite(
    times: numpy.ndarray, known: numpy.ndarray, values: numpy.ndarray, rates: numpy.ndarray
) -> numpy.ndarray:
    """Values on the cubic polynomials through values and rates at known times."""
    k = places(times, known)
    shape = (-1,) + (1,) * (values.ndim - 1)
    step = (known[k + 1] - known[k]).reshape(shape)
    s = ((times - known[k]).reshape(shape)) / step
    rise = values[k + 1] - values[k]
    return values[k] + s * (
        step * rates[k]
        + s * ((3 - 2 * s) * rise - step * ((2 - s) * rates[k] + (1 - s) * rates[k + 1]))
    )

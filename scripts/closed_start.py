"""Start of the paper's four-bar with its journals on the loaded side of their bearings.

Usage: closed_start.py IDEAL-RUN CASE touching|pressed. Prints keys and values for `--set`.

A journal that carries its load lies against its bearing opposite to the force on it,
    e = -(c + depth) F/|F|
with F the force of the ideal mechanism at t = 0. "touching" has depth 0; "pressed" has the depth at
which the contact carries |F|, (|F|/K)^(2/3). The other joints stay as they are. With its journals
there the mechanism is again a four-bar, with moved pivots: coupler and follower close at the
intersection of two circles. Nothing is said of velocities, so freeplay starts the journals at
rest in their bearings."""

import cmath
import sys
import tomllib

import h5py


def of(run, dataset, dimension, name):
    """First sample of a column."""
    meanings = run[dimension].attrs["flag_meanings"]
    names = (meanings.decode() if isinstance(meanings, bytes) else str(meanings)).split()
    return run[dataset][0, names.index(name)]


def force(run, joint):
    """Force on the second body of a joint (N), as a complex number."""
    return complex(*(of(run, f"joint_force_{axis}", "joint", joint) for axis in "xy"))


def stiffness(clearance):
    """K as printed, eq. 5 and 6 (N/m^1.5)."""
    normal = clearance["normal"]
    bearing = clearance["bearing_radius"]
    journal = bearing - clearance["radial"]
    sigma = (1 - normal["poisson"] ** 2) / normal["young"]
    return 4 / (3 * 2 * sigma) * (bearing * journal / (bearing + journal)) ** 0.5


def offset(case, run, joint, pressed):
    """Journal centre minus bearing centre (m); zero where the joint is ideal."""
    clearance = case["joints"][joint].get("clearance")
    if clearance is None:
        return 0
    load = force(run, joint)
    depth = (abs(load) / stiffness(clearance)) ** (2 / 3) if pressed else 0
    return -(clearance["radial"] + depth) * load / abs(load)


def length(case, body, joints):
    first, second = (complex(*case["bodies"][body]["points"][joint]) for joint in joints)
    return abs(second - first)


def poses(case, run, pressed):
    """Ends of coupler and follower (m): those on A and B, those on B0 and B."""
    in_a, in_b, in_b0 = (offset(case, run, joint, pressed) for joint in ("A", "B", "B0"))
    crank = complex(*(of(run, f"position_{axis}", "body", "crank") for axis in "xy"))
    a = 2 * crank + in_a  # A0 is the origin, the mass centre mid-link
    b0 = complex(*case["ground"]["points"]["B0"]) + in_b0
    coupler, follower = length(case, "coupler", "AB"), length(case, "follower", ("B0", "B"))
    across = b0 - in_b - a
    along = (coupler**2 - follower**2 + abs(across) ** 2) / (2 * abs(across))
    b = a + across / abs(across) * complex(along, (coupler**2 - along**2) ** 0.5)
    return (a, b), (b0, b + in_b)


ideal, case_file, how = sys.argv[1:]
with open(case_file, "rb") as file, h5py.File(ideal) as run:
    links = poses(tomllib.load(file), run, {"touching": False, "pressed": True}[how])
for body, (first, second) in zip(("coupler", "follower"), links):
    centre, angle = (first + second) / 2, cmath.phase(second - first)
    print(f"start.{body}={{ x = {centre.real}, y = {centre.imag}, angle = {angle}, fixed = true }}")

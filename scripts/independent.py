"""Integrates a case by a road of its own: neither freeplay's equations nor its engines.

Usage: independent.py CASE [--set KEY=VALUE ...] [--until T] [--start FILE.h5] [--against FILE.h5]
                      [--tolerance R] [--every T]

Every body, driven ones too, has three coordinates; joints and drives are constraints on
accelerations, solved as one saddle-point system; the integration is scipy's DOP853. Each step is short
(a body turns by a twentieth of a radian at most), is searched for zeros of gap, slip edges and factor
of the law on 33 points and between them by parabolas, and is made again up to the first zero.
Contact force, friction and modes are written from the paper's equations 1 to 13.

The case must leave no choice of its start, or --start names a result file whose first sample is taken. --against
holds the claims of a certified file, `reference_digits`, against what this integration finds. Contacts are printed, a line each.
"""

import argparse
import copy
import math
import sys
import tomllib

import numpy as np
from scipy.integrate import DOP853

FLIGHT, CONTACT = 0, 1
TURN = 0.05  # rad that a body may turn in a step


def set_key(case, change):
    key, value = change.split("=", 1)
    try:
        value = tomllib.loads(f"x = {value}")["x"]
    except tomllib.TOMLDecodeError:
        value = value.strip()
    *path, last = key.split(".")
    for part in path:
        case = case.setdefault(part, {})
    case[last] = value


class Clearance:
    """A joint with clearance: its geometry and its law."""

    def __init__(self, name, ends, keys):
        self.name, self.ends = name, ends
        self.c, self.bearing = keys["radial"], keys["bearing_radius"]
        self.journal = self.bearing - self.c
        law = keys["normal"]
        self.n = law.get("exponent", 1.5)
        self.a = 0.0
        if law["law"] == "lankarani-nikravesh":
            self.a = 0.75 * (1.0 - law["restitution"] ** 2)
        self.k = law["stiffness"]
        if isinstance(self.k, str):
            sigma = (1.0 - law["poisson"] ** 2) / law["young"]
            sign = {"hertz-printed": 1.0, "hertz-internal": -1.0}[self.k]
            r = self.bearing * self.journal / (self.bearing + sign * self.journal)
            self.k = 4.0 / (3.0 * 2.0 * sigma) * math.sqrt(r)
        self.least = keys.get("minimum_impact_rate", 1e-3)
        self.cut = keys.get("tension", "keep") == "cut"
        friction = keys.get("friction")
        assert friction is None or friction["law"] == "ambrosio", "no other friction is known here"
        self.mu = friction["coefficient"] if friction else 0.0
        self.v0, self.v1 = (friction["v0"], friction["v1"]) if friction else (0.0, 1.0)
        self.mode, self.impact = FLIGHT, 1.0

    def begin(self, rate):
        self.mode, self.impact, self.began_at = CONTACT, max(rate, self.least), rate

    def factor(self, rate):
        return 1.0 + self.a * rate / self.impact

    def force(self, depth, rate, slip):
        """Normal and tangential force on the journal, along −n and t."""
        if self.mode == FLIGHT:
            return 0.0, 0.0
        normal = self.k * max(depth, 0.0) ** self.n * self.factor(rate)
        if normal < 0.0 and self.cut:
            return 0.0, 0.0
        if normal <= 0.0 or self.mu == 0.0 or slip == 0.0:
            return normal, 0.0
        share = min(max((abs(slip) - self.v0) / (self.v1 - self.v0), 0.0), 1.0)
        return normal, -self.mu * share * normal * math.copysign(1.0, slip)


class Mechanism:
    """Bodies, joints, drives, gravity of a case; the accelerations at (t, q, v)."""

    def __init__(self, case):
        self.names = list(case["bodies"])
        bodies = [case["bodies"][name] for name in self.names]
        self.mass = np.array([m for b in bodies for m in (b["mass"], b["mass"], b["inertia"])])
        self.size = len(self.mass)
        loads = case.get("loads", {}).values()
        gravity = sum((np.array(load["acceleration"]) for load in loads), np.zeros(2))
        self.weight = self.mass * np.tile([*gravity, 0.0], len(bodies))
        self.joints, self.clearances, of_joint = [], [], {}
        for name, joint in case["joints"].items():
            ends = [self.end(case, place) for place in joint["between"]]
            of_joint[name] = ends
            if "clearance" in joint:
                self.clearances.append(Clearance(name, ends, joint["clearance"]))
            else:
                self.joints.append(ends)
        self.drives = []
        for drive in case.get("drives", {}).values():
            (i, _), (j, _) = of_joint[drive["joint"]]
            rate = drive["speed_rpm"] * 2.0 * math.pi / 60.0
            self.drives.append((i, j, drive.get("angle", 0.0), rate))
        self.rows = 2 * len(self.joints) + len(self.drives)

    def end(self, case, place):
        body, point = place.split(".")
        if body == "ground":
            return None, complex(*case["ground"]["points"][point])
        return self.names.index(body), complex(*case["bodies"][body]["points"][point])

    def point(self, q, v, end):
        """Arm, place and velocity of a joint's end, as complex numbers, and the body's rate."""
        body, s = end
        if body is None:
            return s, s, 0.0, 0.0
        x, y, angle = q[3 * body : 3 * body + 3]
        vx, vy, rate = v[3 * body : 3 * body + 3]
        arm = complex(math.cos(angle), math.sin(angle)) * s
        return arm, complex(x, y) + arm, complex(vx, vy) + 1j * rate * arm, rate

    def gap(self, clearance, q, v):
        """(depth, rate, slip, n, arms) of a clearance, of lists of coordinates and rates."""
        arm_i, at_i, v_i, w_i = self.point(q, v, clearance.ends[0])
        arm_j, at_j, v_j, w_j = self.point(q, v, clearance.ends[1])
        offset = at_j - at_i
        e = abs(offset)
        n = offset / e if e > 0.0 else 1.0 + 0.0j
        # along n and across it
        along = (v_j - v_i) * n.conjugate()
        slip = along.imag + clearance.journal * w_j - clearance.bearing * w_i
        return e - clearance.c, along.real, slip, n, (arm_i, arm_j)

    def loads(self, q, v):
        force = self.weight.copy()
        for clearance in self.clearances:
            if clearance.mode == FLIGHT:
                continue
            depth, rate, slip, n, arms = self.gap(clearance, q, v)
            normal, tangential = clearance.force(depth, rate, slip)
            on_journal = (-normal + 1j * tangential) * n
            sides = zip(clearance.ends, arms, (-1.0, 1.0), (clearance.bearing, clearance.journal))
            for (body, _), arm, sign, radius in sides:
                if body is not None:
                    moment = (arm.conjugate() * on_journal).imag
                    force[3 * body] += sign * on_journal.real
                    force[3 * body + 1] += sign * on_journal.imag
                    force[3 * body + 2] += sign * (moment + radius * tangential)
        return force

    def constraints(self, q, v):
        """Φ_q and what Φ_q v̇ is to be."""
        matrix, right = np.zeros((self.rows, self.size)), np.zeros(self.rows)
        for row, ends in enumerate(self.joints):
            for end, sign in zip(ends, (-1.0, 1.0)):
                arm, _, _, rate = self.point(q, v, end)
                body = end[0]
                if body is None:
                    continue
                matrix[2 * row, 3 * body] += sign
                matrix[2 * row + 1, 3 * body + 1] += sign
                matrix[2 * row, 3 * body + 2] -= sign * arm.imag
                matrix[2 * row + 1, 3 * body + 2] += sign * arm.real
                right[2 * row] += sign * rate * rate * arm.real
                right[2 * row + 1] += sign * rate * rate * arm.imag
        for row, (i, j, _, _) in enumerate(self.drives, 2 * len(self.joints)):
            for body, sign in ((i, -1.0), (j, 1.0)):
                if body is not None:
                    matrix[row, 3 * body + 2] += sign
        return matrix, right

    def accelerations(self, q, v):
        q, v = q.tolist(), v.tolist()
        force = self.loads(q, v)
        if not self.rows:
            return force / self.mass
        matrix, right = self.constraints(q, v)
        weighed = matrix / self.mass
        multipliers = np.linalg.solve(weighed @ matrix.T, right - matrix @ (force / self.mass))
        return (force + matrix.T @ multipliers) / self.mass

    def rates(self, _t, y):
        q, v = y[: self.size], y[self.size : 2 * self.size]
        return np.concatenate([v, self.accelerations(q, v)])

    def placement(self, t, q):
        """How far the constraints are off, in place."""
        off, v = [], [0.0] * self.size
        for ends in self.joints:
            apart = self.point(q, v, ends[1])[1] - self.point(q, v, ends[0])[1]
            off += [apart.real, apart.imag]
        for i, j, angle, rate in self.drives:
            turned = (q[3 * j + 2] if j is not None else 0.0) - (q[3 * i + 2] if i is not None else 0.0)
            off.append(turned - angle - rate * t)
        return np.array(off)

    def motion(self, q, v):
        """How far they are off in rate."""
        off = self.constraints(q, v)[0] @ v
        for row, (_, _, _, rate) in enumerate(self.drives, 2 * len(self.joints)):
            off[row] -= rate
        return off

    def closed(self, t, y, held=None):
        """A state moved onto the constraints, by the smallest change over the masses; what is held
        does not move."""
        q, v = y[: self.size].copy(), y[self.size :].copy()
        loose = np.ones(2 * self.size) if held is None else 1.0 - held
        if self.rows:
            for _ in range(50):
                if np.abs(self.placement(t, q)).max() < 1e-17:
                    break
                q -= self.smallest(self.placement(t, q), q, loose[: self.size])
            v -= self.smallest(self.motion(q, v), q, loose[self.size :])
        return np.concatenate([q, v])

    def smallest(self, off, q, loose):
        matrix = self.constraints(q, np.zeros(self.size))[0]
        weighed = matrix * (loose / self.mass)
        return weighed.T @ np.linalg.lstsq(weighed @ matrix.T, off, rcond=1e-13)[0]

    def watched(self, y):
        """Functions that are above zero while the modes hold, by (clearance, what)."""
        q, v = y[: self.size].tolist(), y[self.size :].tolist()
        values = {}
        for k, clearance in enumerate(self.clearances):
            depth, rate, slip, *_ = self.gap(clearance, q, v)
            sign = -1.0 if clearance.mode == FLIGHT else 1.0
            values[k, "gap"] = sign * depth / clearance.c
            if clearance.mode == CONTACT and clearance.mu > 0.0:
                for edge in (-clearance.v1, -clearance.v0, clearance.v0, clearance.v1):
                    values[k, edge] = (slip - edge) / clearance.v1
            if clearance.mode == CONTACT and clearance.a > 0.0 and (clearance.mu or clearance.cut):
                values[k, "factor"] = clearance.factor(rate)
        return values


class Integration:
    """A run from a start, event by event."""

    def __init__(self, mechanism, y, tolerance, share=1.0):
        self.mechanism, self.tolerance, self.share = mechanism, tolerance, share
        self.t, self.y = 0.0, mechanism.closed(0.0, y)
        self.contacts = []  # [clearance, begin, end, impact rate]
        for k, clearance in enumerate(mechanism.clearances):
            if self.presses(clearance, at_start=True):
                self.begin(k)

    def presses(self, clearance, at_start):
        n = self.mechanism.size
        depth, rate, *_ = self.mechanism.gap(clearance, self.y[:n], self.y[n:])
        if at_start and abs(depth) <= 1e-15 and abs(rate) <= 1e-15:
            return self.falls_outward(clearance)
        return depth > 0.0 or (depth == 0.0 and rate > 0.0)

    def falls_outward(self, clearance):
        """Whether a journal that touches at rest is on its way out a tenth of a millisecond later."""
        n, h = self.mechanism.size, 1e-4
        q, v = self.y[:n], self.y[n:]
        a = self.mechanism.accelerations(q, v)
        depth = self.mechanism.gap(clearance, q + 0.5 * h * h * a, v + h * a)[0]
        return depth > 1e-18

    def begin(self, k):
        n, clearance = self.mechanism.size, self.mechanism.clearances[k]
        rate = self.mechanism.gap(clearance, self.y[:n], self.y[n:])[1]
        clearance.begin(rate)
        self.contacts.append([k, self.t, math.nan, rate])

    def end(self, k):
        self.mechanism.clearances[k].mode = FLIGHT
        next(c for c in reversed(self.contacts) if c[0] == k)[2] = self.t

    def longest(self):
        """A step within which nothing turns far, and no contact swings far."""
        n = self.mechanism.size
        q, v = self.y[:n], self.y[n:]
        rate = max(np.abs(v[2::3]).max(), 1e-9)
        step = TURN / rate
        for clearance in self.mechanism.clearances:
            offset_rate = self.mechanism.gap(clearance, q, v)[1:3]
            speed = max(abs(offset_rate[0]), 1e-9)
            step = min(step, 0.1 * clearance.c / speed)
        return self.share * step

    def stepper(self, until, first=None):
        return DOP853(
            self.mechanism.rates, self.t, self.y, until, rtol=self.tolerance, atol=self.floor(),
            first_step=first,
        )  # fmt: skip

    def floor(self):
        """Absolute tolerances: of lengths that a hundredth of the clearance is made of, of rates."""
        n = self.mechanism.size
        least = min((c.c for c in self.mechanism.clearances), default=1e-3)
        fastest = max(np.abs(self.y[n:]).max(), 1e-3)
        of_q = np.tile([0.01 * least, 0.01 * least, 0.1], n // 3)
        return self.tolerance * np.concatenate([of_q, np.full(n, 0.01 * fastest)])

    def carry(self, until, seen, stops=()):
        """Goes to `until`; `seen(t, y)` is told of the states as it goes on. Steps end at each of
        some times: between its ends a step is known to fewer digits."""
        guess, stops = self.share * 1e-9, [*stops]
        while self.t < until:
            while stops and stops[0] <= self.t:
                stops.pop(0)
            limit = min(until, self.t + self.longest(), *stops[:1])
            solver = self.stepper(limit, min(guess, limit - self.t))
            before = (self.t, self.y, self.mechanism.watched(self.y))
            message = solver.step()
            if solver.status == "failed":
                raise SystemExit(f"the independent integration stopped at {self.t:e} s: {message}")
            guess = 2.0 * solver.step_size
            dense = solver.dense_output()
            found = self.first_zero(before, solver.t, dense)
            if found is None:
                seen(solver.t, dense)
                self.t, self.y = solver.t, solver.y
                if self.mechanism.rows:
                    self.y = self.mechanism.closed(self.t, self.y)
                continue
            time, key = found
            time = self.land(time, key)
            seen(time, dense)
            self.switch(key)
            guess = min(guess, self.share * 1e-8)

    def first_zero(self, before, end, dense):
        """Time and key of the first function to fall through zero in a step."""
        begin, _, at_begin = before
        times = np.linspace(begin, end, 33)
        values = [at_begin] + [self.mechanism.watched(dense(t)) for t in times[1:]]
        found = None
        for key, first in at_begin.items():
            # a slip edge counts in either way; after an event its own function is about zero
            sign = 1.0
            if key[1] not in ("gap",):
                sign = math.copysign(1.0, values[1][key]) if abs(first) < 1e-9 else math.copysign(1.0, first)
            line = np.array([sign * value[key] for value in values])
            time = self.bracketed(key, sign, line, times, dense)
            if time is not None and (found is None or time < found[0]):
                found = time, key
        return found

    def bracketed(self, key, sign, line, times, dense):
        of = lambda t: sign * self.mechanism.watched(dense(t))[key]
        for k in range(1, len(times)):
            if line[k] < 0.0:
                if line[k - 1] <= 0.0 and k == 1:
                    if line[k] > -1e-13 * 1e3:
                        continue
                return self.bisected(of, times[k - 1], times[k])
            if k + 1 < len(times) and line[k] <= line[k - 1] and line[k] <= line[k + 1]:
                a, b = times[k - 1], times[k + 1]
                lowest = self.lowest(of, a, b) if line[k] < 0.1 * abs(line).max() + 1e-3 else None
                if lowest is not None and of(lowest) < 0.0 and k > 1:
                    return self.bisected(of, a, lowest)
        return None

    @staticmethod
    def lowest(of, a, b):
        ratio = (math.sqrt(5.0) - 1.0) / 2.0
        for _ in range(40):
            c, d = b - ratio * (b - a), a + ratio * (b - a)
            if of(c) < of(d):
                b = d
            else:
                a = c
        return 0.5 * (a + b)

    @staticmethod
    def bisected(of, a, b):
        for _ in range(80):
            middle = 0.5 * (a + b)
            if middle in (a, b):
                break
            if of(middle) < 0.0:
                b = middle
            else:
                a = middle
        return b

    def land(self, time, key):
        """Makes the step anew, ended at an event, and once more where that corrects its time."""
        start = self.t, self.y
        for correction in range(3):
            self.t, self.y = start
            solver = self.stepper(time)
            while solver.status == "running":
                solver.step()
            y = solver.y
            value = self.mechanism.watched(y)[key]
            h = max(1e-9 * (time - start[0]), 1e-15)
            slope = (self.mechanism.watched(y + h * self.mechanism.rates(time, y))[key] - value) / h
            better = time - value / slope if slope else time
            if correction == 2 or abs(better - time) < 1e-18 or not start[0] < better < time + 1e-7:
                break
            time = better
        self.t, self.y = time, self.mechanism.closed(time, y)
        return time

    def switch(self, key):
        k, what = key
        if what != "gap":
            return
        if self.mechanism.clearances[k].mode == FLIGHT:
            self.begin(k)
        else:
            self.end(k)


def centred_start(case, mechanism):
    """The start of a case that names all that its joints leave free: journals centred, unless the
    case fixes them elsewhere."""
    y, held = np.zeros(2 * mechanism.size), np.zeros(2 * mechanism.size)
    keys = ["x", "y", "angle"], ["velocity_x", "velocity_y", "angular_velocity"]
    for body, name in enumerate(mechanism.names):
        start = case.get("start", {}).get(name, {})
        for half, names in enumerate(keys):
            for c, key in enumerate(names):
                at = half * mechanism.size + 3 * body + c
                y[at] = start.get(key, 0.0)
                held[at] = start.get("fixed", False) and key in start
    y = mechanism.closed(0.0, y, held)
    if held.sum() < 2 * mechanism.size - 2 * mechanism.rows:
        ideal = copy.deepcopy(case)
        for joint in ideal["joints"].values():
            joint.pop("clearance", None)
        y = Mechanism(ideal).closed(0.0, y, held)
    return y


def stored_start(path, mechanism):
    import h5py

    with h5py.File(path) as file:
        names = names_of(file, "body")
        y = np.zeros(2 * mechanism.size)
        columns = ["position_x", "position_y", "angle", "velocity_x", "velocity_y", "angular_velocity"]
        for body, name in enumerate(mechanism.names):
            at = names.index(name)
            for c, column in enumerate(columns):
                y[c // 3 * mechanism.size + 3 * body + c % 3] = file[column][0, at]
    return y


def follow(case, y, until, tolerance, times, share=1.0):
    """Integrates a case from a state; the integration, and the states at some times. Steps are at most
    a share of what they may be."""
    mechanism = Mechanism(case)
    integration = Integration(mechanism, y, tolerance, share)
    states = []

    def seen(t, dense):
        while len(states) < len(times) and times[len(states)] <= t:
            at = times[len(states)]
            states.append(integration.y.copy() if at == 0.0 else dense(at))

    integration.carry(until, seen, times)
    return integration, states


def scaled(mechanism, y, scale):
    """A state in the scales of a certificate: angles, rates, velocities, clearance vectors."""
    n = mechanism.size
    q, v = y[:n], y[n:]
    parts = [q[2::3], v[2::3] / scale["scale_angular_velocity"]]
    parts += [v[c::3] / scale["scale_velocity"] for c in range(2)]
    for clearance in mechanism.clearances:
        ends = [mechanism.point(q, v, end)[1] for end in clearance.ends]
        offset = (ends[1] - ends[0]) / clearance.c
        parts.append(np.array([offset.real, offset.imag]))
    return np.concatenate(parts)


def stored(file, mechanism, row):
    """The same of a row of a certified file."""
    order = [names_of(file, "body").index(name) for name in mechanism.names]
    scale = file.attrs
    parts = [file["angle"][row][order]]
    parts.append(file["angular_velocity"][row][order] / scale["scale_angular_velocity"])
    parts += [file[name][row][order] / scale["scale_velocity"] for name in ("velocity_x", "velocity_y")]
    of = names_of(file, "clearance")
    for clearance in mechanism.clearances:
        k = of.index(clearance.name)
        parts.append(np.array([file["clearance_x"][row][k], file["clearance_y"][row][k]]) / clearance.c)
    return np.concatenate(parts)


def names_of(file, dimension):
    names = file[dimension].attrs["flag_meanings"]
    return (names.decode() if isinstance(names, bytes) else str(names)).split()


def judge(path, case, tolerance=1e-13):
    """Claims of a certified file held against an integration: by how many digits a claim exceeds the
    truth at most, the row, and how many digits could be judged at the end. What it differs by,
    tenfold, from one with a hundredfold tolerance and other steps and one from a start that is off by
    the rounding of doubles, is not judged: its own start is that of the file, in doubles, and a clearance vector
    a difference of its positions."""
    import h5py

    with h5py.File(path) as file:
        times, claims = file["time"][:], file["reference_digits"][:]
        mechanism = Mechanism(case)
        y = stored_start(path, mechanism)
        until = times[-1]
        tight = follow(case, y, until, tolerance, times)[1]
        loose = follow(case, y, until, 100.0 * tolerance, times, 0.7)[1]
        signs = np.where(np.arange(len(y)) % 2, -1.0, 1.0)
        at = y[: mechanism.size].reshape(-1, 3)[:, :2]
        narrow = min((clearance.c for clearance in mechanism.clearances), default=1.0)
        vague = np.finfo(float).eps * np.abs(at).max() / narrow
        beside = follow(case, y * (1.0 + np.finfo(float).eps * signs), until, tolerance, times)[1]
        over, where, judged, unsure = 0.0, None, 16.0, 0.0
        for row, claim in enumerate(claims):
            theirs = stored(file, mechanism, row)
            ours, *others = (scaled(mechanism, state[row], file.attrs) for state in (tight, loose, beside))
            apart = max(np.abs(ours - other).max() for other in others)
            # two that are off may agree at a moment; a trajectory is off by some tens of tolerances
            unsure = max(unsure, 10.0 * (apart + vague) + 100.0 * tolerance)
            off = np.abs(theirs - ours).max()
            judged = min(judged, -math.log10(unsure))
            if off > unsure + 10.0**-claim and claim + math.log10(off) > over:
                over, where = claim + math.log10(off), times[row]
    return over, where, judged


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--until", type=float)
    parser.add_argument("--start", metavar="FILE")
    parser.add_argument("--against", metavar="FILE")
    parser.add_argument("--tolerance", type=float, default=1e-13)
    parser.add_argument("--every", type=float, help="print the state every so many seconds")
    arguments = parser.parse_args()
    with open(arguments.case, "rb") as file:
        case = tomllib.load(file)
    for change in arguments.set:
        set_key(case, change)
    mechanism = Mechanism(case)
    start = arguments.start or arguments.against
    y = stored_start(start, mechanism) if start else centred_start(case, mechanism)
    until = arguments.until or case["run"]["duration"]
    if arguments.against:
        over, where, judged = judge(arguments.against, case, arguments.tolerance)
        print(f"claims exceed the truth by {over:.1f} digits (at {where} s); {judged:.1f} were judged")
        return 1 if over else 0
    times = list(np.arange(0.0, until, arguments.every)) if arguments.every else []
    integration, states = follow(case, y, until, arguments.tolerance, times)
    for k, begin, end, rate in integration.contacts:
        print(f"{mechanism.clearances[k].name} {begin:.12e} {end:.12e} {rate:.9e}")
    for time, state in zip(times, states):
        print(f"{time:.6e}", *(f"{x:.12e}" for x in state))
    return 0


if __name__ == "__main__":
    sys.exit(main())

# SPDX-License-Identifier: BSD-3-Clause
"""The simulated device once more, written from docs/back_ends.md, "sim", alone.

    python3 tests/drivers/sim_oracle.py BUILD [SETTINGS]        compares it with the library, in so many random settings
    python3 tests/drivers/sim_oracle.py trace WHERE [TICKS]     prints x, y, z of each tick, as in trace 'hand=press'

Where the library has matrix exponentials, there are power series of the motion here, in steps so short that 24 terms
leave nothing. Where the library reasons about zeros, the velocity's sign is looked up at many moments of a step, and
then halved down to double. It cannot judge the quaternion, faults, or a live device.
"""
import os
import random
import sys
import tempfile
from ctypes import CDLL, Structure, byref, c_char_p, c_double, c_uint32, c_uint64, c_void_p, sizeof
from math import ceil, floor, sqrt

DEFAULTS = {"mass": 0.1, "damping": 0.5, "friction": 0.0, "stiction": None, "inertia": 1e-4, "turn_damping": 1e-3,
            "turn_friction": 0.0, "turn_stiction": None, "gravity": 0.0, "grip": 200.0, "turn_grip": 0.2,
            "hand_mass": 0.0, "hand_damping": 0.0, "hand_inertia": 0.0, "hand_turn_damping": 0.0, "step": 0.0,
            "turn_step": 0.0, "rate": 1000.0, "dofs": 3, "force": 8.0, "torque": 0.2, "watchdog": 0.01, "delay": 0.0,
            "lag": 0.0, "jitter": 0.0, "loss": 0.0, "double": 0.0, "seed": 0, "hand": "", "reach": 0.03, "cycle": 4.0}
TERMS, LOOKS = 24, 40


def chance(seed, period, draw):
    mask = 2**64 - 1
    z = (seed + (4 * period + draw + 1) * 0x9E3779B97F4A7C15) & mask
    z = ((z ^ z >> 30) * 0xBF58476D1CE4E5B9) & mask
    z = ((z ^ z >> 27) * 0x94D049BB133111EB) & mask
    return ((z ^ z >> 31) >> 11) / 2.0**53


def value(series, t):
    total = 0.0
    for term in reversed(series):
        total = total * t + term
    return total


def halve(is_past, low, high):
    for _ in range(200):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        low, high = (low, middle) if is_past(middle) else (middle, high)
    return high


class Axis:
    def __init__(self, mass, damping, spring, lag, friction, stiction):
        self.mass, self.damping, self.spring, self.lag = mass, damping, spring, lag
        self.friction, self.stiction = friction, stiction
        self.x = self.v = self.f = 0.0
        fastest = max(damping / mass, sqrt(spring / mass), 1.0 / lag if lag else 0.0, 1e-9)
        self.step = 0.7 / fastest

    def series(self, force, command):
        """x, v, f as polynomials of time; `force` is what acts beside the motor, damper and spring."""
        x, v, f = [self.x], [self.v], [self.f if self.lag else command]
        for n in range(TERMS):
            x.append(v[n] / (n + 1))
            v.append(((force if n == 0 else 0.0) + f[n] - self.damping * v[n] - self.spring * x[n])
                     / self.mass / (n + 1))
            f.append(((command if n == 0 else 0.0) - f[n]) / self.lag / (n + 1) if self.lag else 0.0)
        return x, v, f

    def move(self, time, command, force):
        x, v, f = self.series(force, command)
        self.x, self.v, self.f = value(x, time), value(v, time), value(f, time)

    def advance(self, time, command, push, centre):
        push += self.spring * centre
        nothing = 1e-15 * time
        while time > nothing:
            step = time / ceil(time / self.step)
            if self.stiction == 0.0:
                self.move(step, command, push)
            elif self.v == 0.0:
                step = self.rest(step, command, push)
            else:
                step = self.slide(step, command, push, 1.0 if self.v > 0.0 else -1.0)
            time -= step

    def rest(self, step, command, push):
        """Stays until the force is above stiction; then slides."""
        _, _, f = self.series(0.0, command)
        beside = push - self.spring * self.x
        is_above = lambda t: abs(value(f, t) + beside) > self.stiction
        if is_above(0.0):
            return self.slide(step, command, push, 1.0 if value(f, 0.0) + beside > 0.0 else -1.0)
        if not is_above(step):
            self.f = value(f, step)
            return step
        moment = halve(is_above, 0.0, step)
        self.f = value(f, moment)
        return moment

    def slide(self, step, command, push, direction):
        force = push - direction * self.friction
        _, v, _ = self.series(force, command)
        has_moved = self.v != 0.0
        before = 0.0
        for look in range(1, LOOKS + 1):
            moment = step * look / LOOKS
            if direction * value(v, moment) > 0.0:
                has_moved = True
            elif has_moved or look == LOOKS:
                moment = halve(lambda t: direction * value(v, t) <= 0.0, before, moment)
                self.move(moment, command, force)
                self.v = 0.0
                return moment
            before = moment
        self.move(step, command, force)
        return step


class Hand:
    def __init__(self, settings):
        self.kind, self.reach, self.cycle = settings["hand"], settings["reach"], settings["cycle"]
        self.rows, self.is_position = None, self.kind != ""
        if self.kind not in ("", "hold", "press", "wipe"):
            lines = open(self.kind).read().split()
            self.is_position = lines[0].startswith("t,x")
            self.rows = [[float(cell) for cell in line.split(",")] for line in lines[1:]]

    @staticmethod
    def to_and_fro(t):
        s = 1.0 - abs(2.0 * (t - floor(t)) - 1.0)
        return s * s * (3.0 - 2.0 * s)

    def at(self, time):
        at = [0.0] * 6
        if self.kind == "press":
            at[1] = -self.reach * self.to_and_fro(time / self.cycle)
        if self.kind == "wipe":
            at[1] = -self.reach * self.to_and_fro(min(0.5 * time / self.cycle, 0.5))
            at[0] = self.reach * (2.0 * self.to_and_fro(0.5 * time / self.cycle + 0.25) - 1.0)
        if self.rows:
            last = max([n for n, row in enumerate(self.rows) if row[0] <= time] or [0])
            row, part = self.rows[last], 0.0
            after = self.rows[min(last + 1, len(self.rows) - 1)]
            if after is not row and time > row[0]:
                part = (time - row[0]) / (after[0] - row[0])
            for i in range(len(row) - 1):
                at[i] = row[1 + i] + part * (after[1 + i] - row[1 + i])
        return at


class Device:
    """read() gives fresh, sequence, positions and velocities; write() takes force and torque in one list of six."""

    def __init__(self, given):
        s = self.s = dict(DEFAULTS, **given)
        self.hand = Hand(s)
        held = 1.0 if s["hand"] else 0.0
        self.axes = []
        for kind in range(int(s["dofs"]) // 3):
            mass, damping, grip, hand_mass, hand_damping, friction, stiction = (
                ("mass", "damping", "grip", "hand_mass", "hand_damping", "friction", "stiction"),
                ("inertia", "turn_damping", "turn_grip", "hand_inertia", "hand_turn_damping", "turn_friction",
                 "turn_stiction"))[kind]
            for _ in range(3):
                self.axes.append(Axis(s[mass] + held * s[hand_mass], s[damping] + held * s[hand_damping],
                                      s[grip] if self.hand.is_position else 0.0, s["lag"], s[friction],
                                      s[friction] if s[stiction] is None else s[stiction]))
        self.weight = s["gravity"] * self.axes[0].mass
        if self.hand.is_position:
            for axis, x in zip(self.axes, self.hand.at(0.0)):
                axis.x = x
        self.period, self.has_begun, self.is_armed, self.got_command, self.without = 0, False, False, False, 0
        self.commands = {0: [0.0] * 6}  # by period
        self.acting = [0.0] * 6
        self.counts = {"lost": 0, "missed": 0}
        self.encoders = self.before = self.round()
        self.last_read, self.again = None, False
        self.sample, self.is_new = self.look(), True
        self.arrive(True)

    def round(self):
        steps = (self.s["step"], self.s["turn_step"])
        return [steps[i // 3] * floor(a.x / steps[i // 3] + 0.5) if steps[i // 3] else a.x
                for i, a in enumerate(self.axes)]

    def look(self):
        steps = (self.s["step"], self.s["turn_step"])
        return (self.period, self.encoders,
                [(self.encoders[i] - self.before[i]) * self.s["rate"] if steps[i // 3] else a.v
                 for i, a in enumerate(self.axes)])

    def arrive(self, is_first=False):
        if chance(self.s["seed"], self.period, 2) < self.s["loss"]:
            self.counts["lost"] += 1
            self.is_new = self.is_new and not is_first
            return
        self.again = (not is_first and self.has_arrived()) and chance(self.s["seed"], self.period, 3) < self.s["double"]
        if not self.again:
            self.sample, self.is_new = self.look(), True

    def has_arrived(self):
        return self.last_read is not None or self.is_new

    def step_period(self):
        s, p, seconds = self.s, self.period, 1.0 / self.s["rate"]
        target = self.hand.at(p / s["rate"])
        if self.got_command or not self.is_armed:
            self.without = 0
        else:
            self.counts["missed"] += 1
            self.without += 1
        self.got_command = False
        if s["watchdog"] and self.without / s["rate"] >= s["watchdog"]:
            for period in self.commands:
                self.commands[period] = [0.0] * 6
            self.acting = [0.0] * 6
        # All moments at which a command of any period begins to act within this one.
        changes = []
        for period in range(max(0, p - 20), p + 1):
            begins = s["delay"] * seconds + s["jitter"] * chance(s["seed"], period, 0) - (p - period) * seconds
            if -1e-13 * seconds <= begins < seconds * (1.0 - 1e-13):
                changes.append((max(begins, 0.0), period))
        now = 0.0
        for moment, period in sorted(changes):
            self.move(moment - now, target)
            now, self.acting = moment, self.commands[period]
        self.move(seconds - now, target)
        self.before, self.encoders = self.encoders, self.round()
        self.commands[p + 1] = self.commands[p]
        self.period += 1
        self.arrive()

    def move(self, time, target):
        for i, axis in enumerate(self.axes):
            is_position = self.hand.is_position
            axis.advance(time, self.acting[i], (0.0 if is_position else target[i]) - (self.weight if i == 1 else 0.0),
                         target[i] if is_position else 0.0)

    def read(self):
        if self.has_begun:
            self.step_period()
        self.has_begun = True
        fresh = 0
        if self.is_new:
            fresh = 1 if self.last_read is None else self.sample[0] - self.last_read
            self.last_read, self.is_new = self.sample[0], False
        elif self.again:
            fresh = 1
        self.again = False
        return fresh, *self.sample

    def write(self, wrench):
        if chance(self.s["seed"], self.period, 1) < self.s["loss"]:
            return
        command = []
        for part, limit in ((wrench[:3], self.s["force"]), (wrench[3:], self.s["torque"])):
            length = sqrt(sum(c * c for c in part))
            command += [c * limit / length for c in part] if length > limit else part
        self.commands[self.period] = command
        self.got_command = self.is_armed = True


def law(tick, read, stiffness, damping, is_idle):
    """A wall below, a corner at the side, a push that changes; None where nothing is written."""
    if is_idle:
        return None
    _, _, x, v = read
    wrench = [0.0] * 6
    wrench[1] = -stiffness * min(x[1] + 0.004, 0.0) - (damping * v[1] if x[1] < -0.004 else 0.0)
    wrench[0] = -0.2 * stiffness * max(x[0] - 0.003, 0.0) + (0.9 if tick // 97 % 3 == 1 else -0.7)
    wrench[2] = (0.8, -0.15, 0.0, 1.7)[tick // 61 % 4]
    if len(x) == 6:
        for i in range(3):
            wrench[3 + i] = -0.05 * x[3 + i] + (0.01, -0.02, 0.004)[(tick // 83 + i) % 3]
    return wrench


# ---- the library ----

def listed(kinds):
    return [(name, kind) for kind, names in kinds for name in names.split()]


class State(Structure):
    _fields_ = listed([(c_uint32, "size status reasons code buttons fresh"), (c_uint64, "sequence time_ns"),
                       (c_double * 7, "pose"), (c_double * 3, "velocity spin"), (c_double, "temperature"),
                       (c_double * 6, "reserved"), (c_double * 8, "joint")])


class Counts(Structure):
    _fields_ = listed([(c_uint32, "size reserved"),
                       (c_uint64, "samples lost reordered damaged commands refused missed resets")])


class Library:
    def __init__(self, build, given):
        self.core, self.calls = CDLL(build + "/libdynpoint.so"), CDLL(build + "/libdynpoint_drivers.so")
        self.device = c_void_p()
        where = "sim:?" + "&".join("%s=%s" % (name, repr(v) if isinstance(v, float) else v)
                                   for name, v in given.items())
        self.must(self.calls.dpt_device_open(c_char_p(where.encode()), byref(self.device), None))
        self.dofs = int(given.get("dofs", 3))

    @staticmethod
    def must(result):
        if result != 0:
            raise RuntimeError("the library returned %d" % result)

    def read(self):
        state = State(size=sizeof(State))
        self.must(self.calls.dpt_device_read(self.device, byref(state)))
        return (state.fresh, state.sequence, list(state.joint[:self.dofs]),
                (list(state.velocity) + list(state.spin))[:self.dofs])

    def write(self, wrench):
        self.must(self.calls.dpt_device_write(self.device, (c_double * 6)(*wrench)))

    def get_counts(self):
        counts = Counts(size=sizeof(Counts))
        self.must(self.calls.dpt_device_get_counts(self.device, byref(counts)))
        return {"lost": counts.lost, "missed": counts.missed}

    def close(self):
        self.calls.dpt_device_close(self.device)


# ---- random settings ----

def table(rng, folder, dofs):
    is_force = rng.random() < 0.5
    columns = ("fx,fy,fz,tx,ty,tz" if is_force else "x,y,z,rx,ry,rz") if dofs == 6 else "fx,fy,fz" if is_force else "x,y,z"
    largest = (1.5, 0.02) if is_force else (0.02, 0.5)
    path = os.path.join(folder, "hand-%d.csv" % rng.randrange(10**9))
    time = rng.choice((0.0, 0.05))
    with open(path, "w") as file:
        file.write("t," + columns + "\n")
        for _ in range(40):
            row = [rng.uniform(-1, 1) * largest[i // 3] for i in range(dofs)]
            file.write(",".join(repr(number) for number in [time] + row) + "\n")
            time += rng.uniform(0.02, 0.3)
    return path


def settings(rng, folder):
    def maybe(name, draw, probability=0.5):
        if rng.random() < probability:
            given[name] = draw()

    def log(low, high):
        return low * (high / low) ** rng.random()

    given = {"seed": rng.randrange(2**53), "dofs": rng.choice((3, 3, 3, 6))}
    rate = given["rate"] = rng.choice((1000.0, 1000.0, 4000.0, 500.0))
    maybe("mass", lambda: log(0.03, 1.0))
    maybe("damping", lambda: rng.choice((0.0, log(0.05, 5.0))))
    maybe("inertia", lambda: log(3e-5, 1e-3))
    maybe("turn_damping", lambda: rng.choice((0.0, log(1e-4, 1e-2))))
    maybe("gravity", lambda: log(0.5, 9.81), 0.3)
    maybe("delay", lambda: rng.choice((1, 3, 0.5, rng.uniform(0.0, 3.0), rng.uniform(0.0, 15.0))))
    maybe("lag", lambda: log(2e-4, 2e-2), 0.4)
    maybe("jitter", lambda: rng.uniform(0.05, 0.999) / rate, 0.4)
    maybe("loss", lambda: rng.choice((0.01, 0.1, 0.4)), 0.3)
    maybe("double", lambda: rng.choice((0.01, 0.1, 0.4)), 0.3)
    maybe("watchdog", lambda: rng.choice((0.0, 0.003, 0.005)), 0.3)
    maybe("step", lambda: log(1e-6, 1e-4), 0.2)
    maybe("turn_step", lambda: log(1e-5, 1e-3), 0.2)
    if rng.random() < 0.6:
        maybe("friction", lambda: log(0.02, 1.0), 0.8)
        maybe("stiction", lambda: given.get("friction", 0.0) + log(0.01, 0.5), 0.6)
        maybe("turn_friction", lambda: log(1e-4, 1e-2), 0.7)
        maybe("turn_stiction", lambda: given.get("turn_friction", 0.0) + log(1e-4, 1e-2), 0.6)
    hand = rng.choice(("", "hold", "press", "wipe", "table", "table"))
    if hand:
        given["hand"] = table(rng, folder, given["dofs"]) if hand == "table" else hand
        maybe("grip", lambda: log(20.0, 2e4))
        maybe("turn_grip", lambda: log(0.02, 5.0))
        maybe("hand_mass", lambda: log(0.01, 0.5))
        maybe("hand_damping", lambda: log(0.1, 20.0))
        maybe("hand_inertia", lambda: log(1e-5, 1e-3))
        maybe("hand_turn_damping", lambda: log(1e-4, 1e-2))
        maybe("reach", lambda: log(0.005, 0.05), 0.3)
        maybe("cycle", lambda: log(0.3, 4.0), 0.5)
    return given


def compare(build, given, rng):
    """The first tick that differs, and by how much; the largest relative difference and where the axes rested."""
    has_friction = any(given.get(name) for name in ("friction", "stiction", "turn_friction", "turn_stiction"))
    ticks, tolerance = (1000, 1e-6) if has_friction else (2000, 1e-9)
    stiffness, damping = rng.choice((50.0, 400.0)), rng.choice((0.0, 1.0))
    idle = {tick + k for tick in rng.sample(range(ticks), 12) for k in range(rng.choice((1, 2, 6, 15)))}
    ours, oracle = Library(build, given), Device(given)
    largest = [1e-6, 1e-4]
    worst, rested = 0.0, 0
    for tick in range(ticks):
        a, b = ours.read(), oracle.read()
        if a[:2] != b[:2]:
            return "tick %d: fresh, number %s, not %s" % (tick, a[:2], b[:2]), worst, rested
        for i, x in enumerate(b[2]):
            largest[i // 3] = max(largest[i // 3], abs(x))
            off = abs(a[2][i] - x) / largest[i // 3]
            worst = max(worst, off)
            if not off <= tolerance:
                return "tick %d, axis %d: %.17g, not %.17g" % (tick, i, a[2][i], x), worst, rested
        rested += sum(axis.v == 0.0 for axis in oracle.axes)
        # Each is led by what it measured itself.
        for device, read in ((ours, a), (oracle, b)):
            wrench = law(tick, read, stiffness, damping, tick in idle)
            if wrench:
                device.write(wrench)
    counts = ours.get_counts()
    ours.close()
    if counts != oracle.counts:
        return "it counts %s, not %s" % (counts, oracle.counts), worst, rested
    return None, worst, rested


def main():
    if sys.argv[1] == "trace":
        given = dict(part.split("=") for part in sys.argv[2].split("&") if part)
        device = Device({name: v if name == "hand" else int(v) if name in ("seed", "dofs") else float(v)
                         for name, v in given.items()})
        for tick in range(int(sys.argv[3]) if len(sys.argv) > 3 else 1000):
            read = device.read()
            print("%d,%.17g,%.17g,%.17g" % (read[1], *read[2][:3]))
            device.write([0.0, -1000.0 * min(read[2][1], 0.0), 0.0, 0.0, 0.0, 0.0])
        return 0
    passed = failed = 0
    with tempfile.TemporaryDirectory() as folder:
        for number in range(int(sys.argv[2]) if len(sys.argv) > 2 else 48):
            rng = random.Random(number)
            given = settings(rng, folder)
            wrong, worst, rested = compare(sys.argv[1], given, rng)
            what = "&".join("%s=%s" % (name, "%.3g" % v if isinstance(v, float) else os.path.basename(str(v)))
                            for name, v in given.items())
            passed += not wrong
            failed += bool(wrong)
            print("  %s %d: %s: within %.1g, at rest %d times%s" % ("FAIL" if wrong else "ok  ", number, what, worst, rested,
                                                               "; " + wrong if wrong else ""), flush=True)
    print("%d passed, %d failed, 0 skipped" % (passed, failed))
    return failed > 0


sys.exit(main())

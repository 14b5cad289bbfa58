# SPDX-License-Identifier: BSD-3-Clause
"""Kinematics of robots' descriptions by another way: python3 tests/oracle/urdf_kinematics.py BUILD

Reads the URDF with Python's own XML parser and moves 4 x 4 matrices along the tree; derivatives by a complex step
(exact to rounding), torques from power and from potential energy. Nothing is shared with the library, which answers
through BUILD/tests/urdf/answers. The robots: our sample, random trees, and those of DPT_DATA. Where this interpreter has
pinocchio (PyPI: pin), it is asked too. The last line is "N passed, M failed, K skipped".
"""
import cmath
import json
import math
import os
import random
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

MOVES = ("revolute", "continuous", "prismatic")
POSITION, TORQUE = 1e-9, 1e-9
STEP = 1e-30


def matmul(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def apply(a, p):
    return [sum(a[i][k] * p[k] for k in range(3)) + a[i][3] for i in range(3)]


def turn(axis, angle):
    """Rodrigues; the angle may be complex."""
    c, s = cmath.cos(angle), cmath.sin(angle)
    x, y, z = axis
    cross = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    return [[c * (i == j) + s * cross[i][j] + (1 - c) * axis[i] * axis[j] for j in range(3)] + [0] for i in range(3)] \
        + [[0, 0, 0, 1]]


def shift(offset):
    return [[float(i == j) for j in range(3)] + [offset[i]] for i in range(3)] + [[0, 0, 0, 1]]


def numbers(element, name, default):
    return [float(x) for x in element.get(name, default).split()] if element is not None else \
        [float(x) for x in default.split()]


def origin(element):
    at = element.find("origin")
    roll, pitch, yaw = numbers(at, "rpy", "0 0 0")
    rotation = matmul(turn((0, 0, 1), yaw), matmul(turn((0, 1, 0), pitch), turn((1, 0, 0), roll)))
    return matmul(shift(numbers(at, "xyz", "0 0 0")), rotation)


class Joint:
    def __init__(self, element):
        self.name, self.type = element.get("name"), element.get("type")
        self.parent, self.child = element.find("parent").get("link"), element.find("child").get("link")
        self.origin = origin(element)
        axis = numbers(element.find("axis"), "xyz", "1 0 0")
        length = math.sqrt(sum(x * x for x in axis))
        self.axis = [x / length for x in axis] if length else axis
        limit, mimic = element.find("limit"), element.find("mimic")
        self.lower, self.upper = -math.inf, math.inf
        if limit is not None and self.type != "continuous":
            self.lower, self.upper = float(limit.get("lower", 0)), float(limit.get("upper", 0))
        self.mimic = None if mimic is None else \
            (mimic.get("joint"), float(mimic.get("multiplier", 1)), float(mimic.get("offset", 0)))

    def move(self, value):
        if self.type == "prismatic":
            return matmul(self.origin, shift([value * x for x in self.axis]))
        if self.type in MOVES:
            return matmul(self.origin, turn(self.axis, value))
        return self.origin


class Robot:
    def __init__(self, path, tool):
        root = ElementTree.parse(path).getroot()
        self.joints = {j.get("name"): Joint(j) for j in root.findall("joint")}
        self.above = {j.child: j for j in self.joints.values()}
        links = [link.get("name") for link in root.findall("link")]
        parents = {j.parent for j in self.joints.values()}
        self.tool = tool or [link for link in links if link not in parents][0]
        self.links = links
        self.masses = {}
        for link in root.findall("link"):
            inertial = link.find("inertial")
            if inertial is not None:
                centre = [row[3] for row in origin(inertial)[:3]]
                self.masses[link.get("name")] = (float(inertial.find("mass").get("value")), centre)
        self.path, at = [], self.tool
        while at in self.above:
            self.path.insert(0, self.above[at])
            at = self.above[at].parent
        self.names = []
        for joint in self.path:
            base, factor, _ = self.follow(joint)
            if joint.type in MOVES and factor and base.name not in self.names:
                self.names.append(base.name)

    def follow(self, joint):
        factor, offset = 1.0, 0.0
        while joint.mimic:
            name, f, o = joint.mimic
            factor, offset, joint = factor * f, offset + factor * o, self.joints[name]
        return joint, factor, offset

    def value(self, joint, q):
        if joint.type not in MOVES:
            return 0.0
        base, factor, offset = self.follow(joint)
        at = q[self.names.index(base.name)] if base.name in self.names else max(base.lower, min(base.upper, 0.0))
        return factor * at + offset

    def frame(self, link, q, known):
        if link not in known:
            joint = self.above.get(link)
            known[link] = matmul(self.frame(joint.parent, q, known), joint.move(self.value(joint, q))) if joint else \
                shift((0, 0, 0))
        return known[link]

    def pose(self, q):
        return self.frame(self.tool, q, {})

    def moves(self, link):
        while link in self.above:
            joint = self.above[link]
            base, factor, _ = self.follow(joint)
            if joint.type in MOVES and factor and base.name in self.names:
                return True
            link = joint.parent
        return False

    def energy(self, q, gravity):
        known, sum_ = {}, 0.0
        for link, (mass, centre) in self.masses.items():
            if self.moves(link):
                at = apply(self.frame(link, q, known), centre)
                sum_ -= mass * sum(g * x for g, x in zip(gravity, at))
        return sum_

    def step(self, q, i, function):
        moved = [complex(x, STEP * (k == i)) for k, x in enumerate(q)]
        return function(moved)

    def jacobian(self, q):
        """Columns: velocity above spin."""
        rotation = [[x.real if isinstance(x, complex) else x for x in row] for row in self.pose(q)]
        columns = []
        for i in range(len(q)):
            d = self.step(q, i, self.pose)
            rate = [[complex(x).imag / STEP for x in row] for row in d]
            w = [[sum(rate[a][k] * rotation[b][k] for k in range(3)) for b in range(3)] for a in range(3)]
            columns.append([rate[k][3] for k in range(3)] + [w[2][1], w[0][2], w[1][0]])
        return columns

    def weight(self, q, gravity):
        return [complex(self.step(q, i, lambda x: self.energy(x, gravity))).imag / STEP for i in range(len(q))]


def rotation_of(quaternion):
    w, x, y, z = quaternion
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


class Tally:
    def __init__(self):
        self.passed = self.failed = self.skipped = 0

    def check(self, holds, what):
        if holds:
            self.passed += 1
        else:
            self.failed += 1
        print("  %s %s" % ("ok  " if holds else "FAIL", what))

    def skip(self, what, why):
        self.skipped += 1
        print("  skip %s: %s" % (what, why))


def split(line, joints):
    values = [float(x) for x in line.split()]
    at, parts = 0, []
    for count in (3, 4, 3, 3, 6 * joints, joints, joints):
        parts.append(values[at:at + count])
        at += count
    if at != len(values):
        raise ValueError("an answer of %d numbers" % len(values))
    return parts


class Library:
    """The arm that the program makes of a URDF."""

    def __init__(self, build, path, tool, scratch, more=()):
        self.answers = os.path.join(build, "tests/urdf/answers")
        self.arm = os.path.join(scratch, "arm.dpa")
        program = os.path.join(build, "dynpoint")
        command = [program, "compile", path, "-o", self.arm] + (["--tool", tool] if tool else []) + list(more)
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.error = done.stderr if done.returncode else None
        if not self.error:
            self.info = json.loads(subprocess.check_output([program, "info", self.arm, "--json"], text=True))
            self.names = [joint["name"] for joint in self.info["joints"]]

    def ask(self, questions):
        lines = "\n".join(" ".join("%.17g" % x for part in q for x in part) for q in questions)
        out = subprocess.run([self.answers, self.arm], input=lines, stdout=subprocess.PIPE, text=True, check=True)
        return [split(line, len(self.names)) for line in out.stdout.splitlines()]


def questions_for(info, rng, count):
    """Within the limits mostly, now and then far beyond; a wrench, rates and a gravity."""
    result = []
    for i in range(count):
        joints = []
        for joint in info["joints"]:
            low, high = (joint["lower"], joint["upper"]) if joint["kind"] != "continuous" else (-math.pi, math.pi)
            joints.append(rng.uniform(low, high) if i % 4 else rng.uniform(-10, 10))
        result.append((joints, [rng.uniform(-3, 3) for _ in joints], [rng.uniform(-5, 5) for _ in range(6)],
                       [rng.uniform(-10, 10) for _ in range(3)]))
    return result


def scale_of(*numbers_):
    return max([1.0] + [abs(x) for x in numbers_])


def worst_of(robot, questions, answers):
    """Largest errors: position and turn, velocity, Jacobian, torque of a wrench, of the weight."""
    worst = [0.0] * 5
    for (q, rates, wrench, gravity), (position, quaternion, velocity, spin, jacobian, efforts, weight) in \
            zip(questions, answers):
        pose = [[complex(x).real for x in row] for row in robot.pose(q)]
        turned = rotation_of(quaternion)
        reach = scale_of(*[row[3] for row in pose])
        worst[0] = max([worst[0]] + [abs(pose[i][3] - position[i]) for i in range(3)] +
                       [abs(pose[i][j] - turned[i][j]) for i in range(3) for j in range(3)])
        columns = robot.jacobian(q)
        n = len(q)
        twist = [sum(columns[i][k] * rates[i] for i in range(n)) for k in range(6)]
        worst[1] = max([worst[1]] + [abs(a - b) / reach for a, b in zip(twist, velocity + spin)])
        worst[2] = max([worst[2]] + [abs(columns[i][k] - jacobian[k * n + i]) / reach for i in range(n)
                                     for k in range(6)])
        # Virtual work: the power of the motors is that of the wrench.
        power = sum(a * b for a, b in zip(twist, wrench))
        worst[3] = max([worst[3], abs(sum(a * b for a, b in zip(efforts, rates)) - power) / reach] +
                       [abs(sum(columns[i][k] * wrench[k] for k in range(6)) - efforts[i]) / reach for i in range(n)])
        held = robot.weight(q, gravity)
        heavy = scale_of(*held)
        worst[4] = max([worst[4]] + [abs(a - b) / heavy for a, b in zip(held, weight)])
    return worst


def check_robot(tally, build, scratch, path, tool, rng, count=200, what=None, pinocchio=None):
    what = what or os.path.basename(path)
    library = Library(build, path, tool, scratch)
    if library.error:
        tally.check(False, "%s: %s" % (what, library.error.strip()))
        return
    robot = Robot(path, tool)
    questions = questions_for(library.info, rng, count)
    answers = library.ask(questions)
    worst = worst_of(robot, questions, answers)
    mass = sum(m for link, (m, _) in robot.masses.items() if robot.moves(link))
    holds = library.names == robot.names and len(answers) == count and worst[0] <= POSITION and \
        max(worst[1:]) <= TORQUE and abs(library.info["mass"] - mass) <= 1e-12 * scale_of(mass)
    tally.check(holds, "%s: %d joints, %d links, %.3g kg: pose %.1e, velocity %.1e, Jacobian %.1e, torque %.1e, weight "
                "%.1e" % ((what, len(robot.names), len(library.info["links"]), mass) + tuple(worst)))
    if pinocchio:
        check_pinocchio(tally, pinocchio, path, robot, questions, answers, what)


def check_pinocchio(tally, pin, path, robot, questions, answers, what):
    model = pin.buildModelFromUrdf(path)
    data = model.createData()
    frame = model.getFrameId(robot.tool)
    worst = [0.0, 0.0, 0.0]
    for (q, _, wrench, gravity), (position, quaternion, _, _, _, efforts, weight) in zip(questions, answers):
        configuration = pin.neutral(model)
        follows = []
        for number, name in enumerate(model.names):
            joint = robot.joints.get(name)
            if number == 0 or joint is None or joint.type not in MOVES:
                continue
            value, at = robot.value(joint, q), model.joints[number].idx_q
            if model.joints[number].nq == 2:
                configuration[at], configuration[at + 1] = math.cos(value), math.sin(value)
            else:
                configuration[at] = value
            base, factor, _ = robot.follow(joint)
            if base.name in robot.names:
                follows.append((model.joints[number].idx_v, robot.names.index(base.name), factor))
        pin.framesForwardKinematics(model, data, configuration)
        place = data.oMf[frame]
        turned = rotation_of(quaternion)
        worst[0] = max([worst[0]] + [abs(place.translation[i] - position[i]) for i in range(3)] +
                       [abs(place.rotation[i, j] - turned[i][j]) for i in range(3) for j in range(3)])
        jacobian = pin.computeFrameJacobian(model, data, configuration, frame, pin.LOCAL_WORLD_ALIGNED)
        jacobian = jacobian.reshape(6, model.nv)
        for i in range(3):
            model.gravity.linear[i] = gravity[i]
        held = pin.computeGeneralizedGravity(model, data, configuration)
        reach, torque, lift = scale_of(*position), [0.0] * len(q), [0.0] * len(q)
        for column, i, factor in follows:
            torque[i] += factor * sum(jacobian[k, column] * wrench[k] for k in range(6))
            lift[i] += factor * held[column]
        worst[1] = max([worst[1]] + [abs(a - b) / reach for a, b in zip(torque, efforts)])
        worst[2] = max([worst[2]] + [abs(a - b) / scale_of(*lift) for a, b in zip(lift, weight)])
    tally.check(worst[0] <= POSITION and max(worst[1:]) <= TORQUE,
                "%s, pinocchio: pose %.1e, torque %.1e, weight %.1e" % ((what,) + tuple(worst)))


def random_urdf(rng, path):
    """A tree: a way of joints of all kinds to the tool, branches, mimics within and beside it, masses."""
    count = rng.randint(3, 16)
    out, movable = ['<robot name="tree">'], []
    vector = lambda size: " ".join("%.6f" % rng.uniform(-size, size) for _ in range(3))
    for i in range(count + 1):
        mass = '<inertial><origin xyz="%s" rpy="%s"/><mass value="%.4f"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" ' \
            'iyz="0" izz="1"/></inertial>' % (vector(0.3), vector(3), rng.uniform(0, 3)) if rng.random() < 0.7 else ""
        out.append('<link name="l%d">%s</link>' % (i, mass))
    spine, ways = [0], 0
    for i in range(1, count + 1):
        on_way = rng.random() < 0.65 or i == 1
        kind = rng.choice(MOVES + ("fixed",)) if ways < 9 or not on_way else "fixed"
        if i == 1:
            kind = "revolute"
        parent = spine[-1] if on_way else rng.randrange(i)
        mimic = ""
        if kind in MOVES and movable and rng.random() < 0.35:
            mimic = '<mimic joint="%s" multiplier="%.4f" offset="%.4f"/>' % (
                rng.choice(movable), rng.uniform(-2, 2), rng.uniform(-1, 1))
        elif kind in MOVES and on_way:
            ways += 1
        if on_way:
            spine.append(i)
        low = rng.uniform(-2, 1)
        limit = '<limit lower="%.5f" upper="%.5f" effort="1" velocity="1"/>' % (low, low + rng.uniform(0, 2))
        name = "j%d" % rng.randrange(1000000) + "_%d" % i
        if kind in MOVES:
            movable.append(name)
        out.insert(rng.randint(1, len(out)), '<joint name="%s" type="%s"><origin xyz="%s" rpy="%s"/><parent link="l%d"/>'
                   '<child link="l%d"/><axis xyz="%s"/>%s%s</joint>' % (
                       name, kind, vector(0.5), vector(3.2), parent, i, vector(1), limit, mimic))
    with open(path, "w") as file:
        file.write("\n".join(out + ["</robot>\n"]))
    return "l%d" % spine[-1]


def check_random(tally, build, scratch, rng, pinocchio, count=150):
    before, silent = (tally.passed, tally.failed), open(os.devnull, "w")
    path, shown, nine = os.path.join(scratch, "random.urdf"), sys.stdout, 0
    for i in range(count):
        tool = random_urdf(rng, path)
        sys.stdout = silent
        failed = tally.failed
        if len(Robot(path, tool).names) > 8:
            library = Library(build, path, tool, scratch)
            tally.check(bool(library.error) and "is the ninth" in library.error, "nine joints")
            nine += 1
        else:
            check_robot(tally, build, scratch, path, tool, rng, 10, pinocchio=pinocchio)
        sys.stdout = shown
        if tally.failed > failed:
            print("    tree %d is in %s" % (i, path + ".%d" % i))
            os.rename(path, path + ".%d" % i)
    bad = tally.failed - before[1]
    tally.passed, tally.failed = before
    tally.check(bad == 0 and 0 < nine < count // 4, "%d random trees, %d of them refused for more than eight joints: %d "
                "wrong" % (count, nine, bad))


def main(build):
    tally, rng = Tally(), random.Random(20)
    scratch = os.path.join(build, "tests/urdf_kinematics.%d" % os.getpid())
    os.makedirs(scratch, exist_ok=True)
    try:
        import pinocchio
    except ImportError:
        pinocchio = None
        tally.skip("pinocchio", "not here (PyPI: pin, into build/venv-urdf)")
    check_robot(tally, build, scratch, "docs/samples/arm.urdf", None, rng, pinocchio=pinocchio)
    check_random(tally, build, scratch, rng, pinocchio)
    data = os.path.join(os.environ.get("DPT_DATA", ""), "urdf")
    robots = [("phantom_omni/omni.urdf", "end_effector"), ("phantom_omni/omni.urdf", "stylus"),
              ("dvrk_psm_surrol/psm.urdf", "psm_tool_tip_link"),
              ("dvrk_psm_surrol/psm.urdf", "psm_tool_gripper2_link"), ("kuka_iiwa/model.urdf", None),
              ("force_dimension/fd_3dof.urdf", None), ("force_dimension/fd_6dof_clutch.urdf", None),
              ("kdl_tests/testInertiaRPYmodel1.urdf", None), ("kdl_tests/testInertiaRPYmodel2.urdf", None),
              ("ros_urdf_tests/test_robot.urdf", "right_front_wheel")]
    for name, tool in robots:
        path = os.path.join(data, name)
        if not os.path.exists(path):
            tally.skip(name, "no DPT_DATA")
            continue
        check_robot(tally, build, scratch, path, tool, rng, pinocchio=pinocchio)
    if not tally.failed:
        for name in os.listdir(scratch):
            os.remove(os.path.join(scratch, name))
        os.rmdir(scratch)
    print("%d passed, %d failed, %d skipped" % (tally.passed, tally.failed, tally.skipped))
    return 1 if tally.failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))

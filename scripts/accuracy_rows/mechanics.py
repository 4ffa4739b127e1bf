"""The mechanics of an MJCF file in high precision: its matrices about rest, and the map of
a control tick (docs/theory.md, The machine)."""

import xml.etree.ElementTree

import mpmath

from .common import mpf, still

matrix = mpmath.matrix
STEP = mpf(10) ** -15  # of difference quotients, exact to its square


def numbers(text):
    return [mpf(x) for x in text.split()]


def vector(text):
    return matrix(numbers(text))


def cross(a, b):
    return matrix([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                   a[0] * b[1] - a[1] * b[0]])


def dot(a, b):
    return mpmath.fdot(list(a), list(b))


def rotation(axis, angle):
    c, s = mpmath.cos(angle), mpmath.sin(angle)
    x, y, z = axis
    return c * mpmath.eye(3) + s * matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]]) \
        + (1 - c) * (axis * axis.T)


class Mechanics:
    """Bodies with an inertial frame of their own axes, slides, hinges and sites."""

    def __init__(self, file):
        self.root = xml.etree.ElementTree.parse(file).getroot()
        self.joints, self.bodies, self.sites = [], [], {}
        for body in self.root.find("worldbody").findall("body"):
            self._read(body, None)
        self.gravity = vector(self.root.find("option").get("gravity"))

    def _read(self, element, parent):
        own = len(self.bodies)
        inertial = element.find("inertial")
        self.bodies.append({
            "parent": parent, "pos": vector(element.get("pos", "0 0 0")), "joints": [],
            "mass": mpf(inertial.get("mass")), "centre": vector(inertial.get("pos")),
            "inertia": numbers(inertial.get("diaginertia"))})
        for joint in element.findall("joint"):
            self.bodies[own]["joints"].append(len(self.joints))
            self.joints.append({
                "name": joint.get("name"), "hinge": joint.get("type") == "hinge",
                "axis": vector(joint.get("axis")),
                **{key: mpf(joint.get(key, "0"))
                   for key in ("stiffness", "damping", "springref")}})
        for site in element.findall("site"):
            self.sites[site.get("name")] = (own, vector(site.get("pos")))
        for child in element.findall("body"):
            self._read(child, own)

    def place(self, q):
        """Position, orientation and moving joints of every body."""
        placed = []
        for body in self.bodies:
            if body["parent"] is None:
                at, turned, path = matrix(3, 1), mpmath.eye(3), []
            else:
                at, turned, path = placed[body["parent"]]
            at, path = at + turned * body["pos"], list(path)
            for j in body["joints"]:
                joint = self.joints[j]
                axis = turned * joint["axis"]
                if joint["hinge"]:
                    path.append((j, axis, at))
                    turned = turned * rotation(joint["axis"], q[j])
                else:
                    path.append((j, axis, None))
                    at = at + axis * q[j]
            placed.append((at, turned, path))
        return placed

    @staticmethod
    def velocity(step, point):
        """Of a point, per speed of a joint."""
        _, axis, anchor = step
        return axis if anchor is None else cross(axis, point - anchor)

    def carried(self, joint):
        """Mass of what a joint moves."""
        q = matrix(len(self.joints), 1)
        return sum(body["mass"] for body, (_, _, path) in zip(self.bodies, self.place(q))
                   if joint in [step[0] for step in path])

    def mass(self, q):
        n = len(self.joints)
        M = matrix(n, n)
        for body, (at, turned, path) in zip(self.bodies, self.place(q)):
            centre = at + turned * body["centre"]
            inertia = turned * mpmath.diag(body["inertia"]) * turned.T
            for a in path:
                for b in path:
                    M[a[0], b[0]] += body["mass"] * dot(self.velocity(a, centre),
                                                        self.velocity(b, centre))
                    if a[2] is not None and b[2] is not None:
                        M[a[0], b[0]] += dot(a[1], inertia * b[1])
        return M

    def weight(self, q):
        """Generalised forces of gravity."""
        force = matrix(len(self.joints), 1)
        for body, (at, turned, path) in zip(self.bodies, self.place(q)):
            for step in path:
                force[step[0]] += body["mass"] * dot(
                    self.gravity, self.velocity(step, at + turned * body["centre"]))
        return force

    def derivative(self, function, q):
        """Column by column."""
        columns = []
        for j in range(len(q)):
            step = matrix(len(q), 1)
            step[j] = STEP
            columns.append((function(q + step) - function(q - step)) / (2 * STEP))
        return matrix([[column[i] for column in columns]
                       for i in range(len(columns[0]))])

    def springs(self):
        return mpmath.diag([joint["stiffness"] for joint in self.joints])

    def dampers(self):
        return mpmath.diag([joint["damping"] for joint in self.joints])

    def weight_stiffness(self, q):
        return -self.derivative(self.weight, q)

    def rest(self):
        """Where springs hold the weight; what nothing holds stays."""
        q = matrix(len(self.joints), 1)
        held = [j for j, joint in enumerate(self.joints) if joint["stiffness"]]
        for _ in range(8):
            force = self.weight(q)
            K = self.springs() + self.weight_stiffness(q)
            step = mpmath.lu_solve(
                matrix([[K[i, j] for j in held] for i in held]),
                matrix([force[i] - self.joints[i]["stiffness"]
                        * (q[i] - self.joints[i]["springref"]) for i in held]))
            for i, j in enumerate(held):
                q[j] += step[i]
        return q

    def force_pair(self, site, reference, gear, q):
        """Generalised forces of a unit between two sites, along axes of the second."""
        placed = self.place(q)
        (body, at), (base, base_at) = self.sites[site], self.sites[reference]
        axis = placed[base][1] * matrix(gear[:3])
        force = matrix(len(self.joints), 1)
        for sign, at, (origin, turned, path), other in (
                (1, at, placed[body], placed[base]),
                (-1, base_at, placed[base], placed[body])):
            shared = {step[0] for step in other[2]}
            for step in path:
                if step[0] not in shared:
                    force[step[0]] += sign * dot(
                        axis, self.velocity(step, origin + turned * at))
        return force

    def inputs(self, q):
        columns = []
        for actuator in self.root.find("actuator"):
            gear = numbers(actuator.get("gear"))
            if actuator.get("joint"):
                names = [joint["name"] for joint in self.joints]
                column = matrix(len(names), 1)
                column[names.index(actuator.get("joint"))] = gear[0]
            else:
                column = self.force_pair(actuator.get("site"), actuator.get("refsite"),
                                         gear, q)
            columns.append(column)
        return columns_of(columns)

    def outputs(self, q, components):
        """Derivatives of the readings: `components` by name for those of several."""
        def reading(sensor, q):
            placed = self.place(q)
            body, at = self.sites[sensor.get("objname")]
            base, base_at = self.sites[sensor.get("refname")]
            apart = placed[body][0] + placed[body][1] * at \
                - placed[base][0] - placed[base][1] * base_at
            return matrix([(placed[base][1].T * apart)[components[sensor.get("name")]]])

        names = [joint["name"] for joint in self.joints]
        columns = []
        for sensor in self.root.find("sensor"):
            if sensor.tag == "jointpos":
                column = matrix(len(names), 1)
                column[names.index(sensor.get("joint"))] = 1
            else:
                column = self.derivative(lambda x, s=sensor: reading(s, x), q).T
            columns.append(column)
        return columns_of(columns)


def columns_of(columns):
    return matrix([[column[i] for column in columns] for i in range(len(columns[0]))])


def blocks(rows):
    """A matrix of matrices."""
    return matrix([[part[i, j] for part in row for j in range(part.cols)]
                   for row in rows for i in range(row[0].rows)])


def tick_map(M, D, K, Gamma, step, substeps, shake=still):
    """A and B of a control tick: the Euler step, implicit in the dampers, so many times
    (docs/theory.md, One control tick)."""
    n = M.rows
    inverse = shake(mpmath.inverse(shake(M + step * D)))
    from_q = shake(-step * inverse * K)
    from_v = shake(mpmath.eye(n) - step * shake(inverse * D))
    from_u = shake(step * inverse * Gamma)
    A1 = shake(blocks([[mpmath.eye(n) + step * from_q, step * from_v], [from_q, from_v]]))
    B1 = shake(blocks([[step * from_u], [from_u]]))
    A, B = A1, B1
    for _ in range(substeps - 1):
        A, B = shake(A1 * A), shake(A1 * B + B1)
    return A, B

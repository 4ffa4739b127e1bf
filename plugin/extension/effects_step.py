

class _Joint:
    """A joint in a step."""

    def __init__(self, step, joint):
        model, data = step.model, step.data
        self.step, self.joint = step, joint
        self.dof, self.address = model.jnt_dofadr[joint], model.jnt_qposadr[joint]
        self.h, self.time = model.opt.timestep, data.time
        self.position = float(data.qpos[self.address])
        self.q = self.position - float(model.qpos0[self.address])
        self.v = float(data.qvel[self.dof])

    def motor(self):
        """Force of the motors on the joint."""
        arms = ((motor, self.step.arm(motor)[self.dof]) for motor in range(self.step.model.nu))
        return sum((a * self.step.motor_force(motor) for motor, a in arms if a != 0.0), 0.0)

    def rest(self):
        """What else acts on it, without dry friction."""
        data, dof = self.step.data, self.dof
        others = data.qfrc_applied[dof] + self.step.force[dof]
        return data.qfrc_passive[dof] + others - self.step.bias()[dof]

    def stiffest(self):
        """Stiffness of bristles that the time step allows; of their damping it is 1 / h."""
        mobility = self.step.model.dof_invweight0[self.dof]
        return 0.5 / (mobility * self.h * self.h) if mobility > 0.0 else math.inf


class _Motor:
    """An actuator in a step."""

    def __init__(self, step, motor):
        model = step.model
        self.step, self.motor, self.h = step, motor, model.opt.timestep
        gear = np.reshape(model.actuator_gear, (-1, 6))[motor]
        self.gear = max(math.sqrt(sum(g * g for g in gear)), 1e-15)
        self.rest = model.actuator_length0[motor]
        joint = np.reshape(model.actuator_trnid, (-1, 2))[motor][0]
        at_joint = model.actuator_trntype[motor] in AT_JOINT
        if at_joint and model.jnt_type[joint] in SLIDE_OR_HINGE:  # whose zero may be moved
            self.rest = gear[0] * model.qpos0[model.jnt_qposadr[joint]]


class _Step:
    """What is known in a step of the physics, and what the laws make of it."""

    def __init__(self, model, data):
        self.model, self.data = model, data
        self.ctrl = np.array(data.ctrl, dtype=float)
        self.force = np.zeros(model.nv)
        self._bias = None

    def arm(self, motor):
        """Of an actuator on all degrees of freedom; newer versions keep it sparse."""
        moment = np.ravel(self.data.actuator_moment)
        if not hasattr(self.data, "moment_rownnz"):
            return np.reshape(moment, (-1, self.model.nv))[motor]
        first = self.data.moment_rowadr[motor]
        row = slice(first, first + self.data.moment_rownnz[motor])
        arm = np.zeros(self.model.nv)
        arm[np.ravel(self.data.moment_colind)[row]] = moment[row]
        return arm

    def motor_force(self, motor, command=None):
        """Before the gear, of the command that its drive follows, or of another one."""
        model, data = self.model, self.data
        u = self.ctrl[motor] if command is None else command
        if model.actuator_ctrllimited[motor]:
            u = np.clip(u, *np.reshape(model.actuator_ctrlrange, (-1, 2))[motor])
        force = np.reshape(model.actuator_gainprm, (model.nu, -1))[motor][0] * u
        if model.actuator_biastype[motor] == 1:  # affine
            bias = np.reshape(model.actuator_biasprm, (model.nu, -1))[motor]
            length, velocity = data.actuator_length[motor], data.actuator_velocity[motor]
            force += bias[0] + bias[1] * length + bias[2] * velocity
        if model.actuator_forcelimited[motor]:
            force = np.clip(force, *np.reshape(model.actuator_forcerange, (-1, 2))[motor])
        return float(force)

    def bias(self):
        if self._bias is None:
            self._bias = bias_force(self.model, self.data)
        return self._bias


def bias_force(model, data):
    """Gravity and velocity products of this step: qfrc_bias is made behind mjcb_passive."""
    import mujoco

    bias = np.zeros(model.nv)
    mujoco.mj_rne(model, data, 0, bias)
    return bias


class _Placed:
    """A law at a site of a model."""

    def __init__(self, model, name, site, values):
        self.name, self.values = name, values
        self.kind, self.function, _ = LAWS[name]
        at = SITES.get(self.kind, "jnt")
        self.id = _names(model, at).index(site)
        if at == "jnt" and model.jnt_type[self.id] not in SLIDE_OR_HINGE:
            raise ValueError(f"effect.{name}.{site}: the joint is no slide or hinge")
        if self.kind == "command" and (
            model.actuator_dyntype[self.id] != 0
            or model.actuator_gaintype[self.id] != 0
            or model.actuator_biastype[self.id] > 1
        ):
            raise ValueError(f"effect.{name}.{site}: the actuator has dynamics of its own")
        if self.kind in ("memory", "command") and model.opt.integrator == RUNGE_KUTTA:
            raise ValueError(f"effect.{name}.{site}: has a memory, which needs an integrator "
                             "of one stage: Euler, implicit or implicitfast")


class _Memory:
    """Of the laws of a model in one MjData: before the step at `time`, and behind it."""

    def __init__(self, count):
        self.time, self.before, self.behind = -math.inf, [None] * count, [None] * count

    def begin(self, time):
        if time < self.time:
            self.__init__(len(self.before))
        if time > self.time:
            self.time, self.before = time, list(self.behind)


class _OfObjects:
    """Something of each of several objects, which need no hash, while they live."""

    def __init__(self):
        self._kept = {}

    def get(self, of):
        reference, kept = self._kept.get(id(of), (lambda: None, None))
        return kept if reference() is of else None

    def put(self, of, kept):
        key = id(of)
        self._kept[key] = weakref.ref(of, lambda _: self._kept.pop(key, None)), kept
        return kept


_laws = _OfObjects()  # of prepared models
_memories = _OfObjects()  # of data


def _text(model, address):
    return model.names[address : model.names.index(b"\0", address)].decode()


def _names(model, kind):
    return [_text(model, address) for address in getattr(model, f"name_{kind}adr")]


def laws_of(model):
    """The laws that the custom numerics of a model name, in their order."""
    placed = []
    for i, numeric in enumerate(_names(model, "numeric")):
        if not numeric.startswith("effect."):
            continue
        _, name, site = numeric.split(".", 2)
        if name not in LAWS:
            raise ValueError(f"{numeric}: no law of this file")
        count, first = LAWS[name][2], model.numeric_adr[i]
        values = [float(v) for v in model.numeric_data[first : first + model.numeric_size[i]]]
        if len(values) % count:
            raise ValueError(f"{numeric}: {len(values)} values, not {count} or times that")
        for k in range(0, len(values), count):
            placed.append(_Placed(model, name, site, values[k : k + count]))
    return placed


def prepare(model):
    """Puts into a model what its laws need of MuJoCo's own: friction constraints, and zeros
    of hinges. Once, right after it is loaded, and before its data are made."""
    if _laws.get(model) is not None:
        return
    placed = laws_of(model)
    for law in placed:
        if law.kind == "bound":
            constant = law.values[0] if law.name == "stribeck_friction" else 0.0
            dof = model.jnt_dofadr[law.id]
            model.dof_frictionloss[dof] += max(constant, LEAST_BOUND)
            # As stiff as the time step allows: the default ones creep.
            np.reshape(model.dof_solref, (model.nv, -1))[dof, :2] = 2.0 * model.opt.timestep, 1.0
            np.reshape(model.dof_solimp, (model.nv, -1))[dof, :3] = 0.99, 0.999, 1e-4
        if law.kind == "zero":
            model.qpos0[model.jnt_qposadr[law.id]] += law.values[0]
            model.qpos_spring[model.jnt_qposadr[law.id]] += law.values[0]
    _laws.put(model, placed)


def _prepared(model):
    placed = _laws.get(model)
    if placed is None:
        raise RuntimeError("effects.prepare(model) has to come before the first step")
    return placed


def passive(model, data):
    """For mujoco.set_mjcb_passive: adds the forces of all laws of the model."""
    placed = _prepared(model)
    memory = _memories.get(data) or _memories.put(data, _Memory(len(placed)))
    memory.begin(data.time)
    step = _Step(model, data)
    _drive(step, placed, memory)
    sited = [(i, law, _Joint(step, law.id)) for i, law in enumerate(placed)
             if law.kind in ("force", "memory", "damping", "bound")]
    _damp(step, sited)
    _push(step, sited, memory)
    _bind(step, sited)
    _wind(step, placed, memory)
    # What the drives give of other commands, beside what MuJoCo makes of those in ctrl.
    for motor in {law.id for law in placed if law.kind == "command"}:
        more = step.motor_force(motor) - step.motor_force(motor, data.ctrl[motor])
        step.force += step.arm(motor) * more
    data.qfrc_passive[:] += step.force


def _drive(step, placed, memory):
    for i, law in enumerate(placed):
        if law.kind == "command":
            at, u = _Motor(step, law.id), float(step.ctrl[law.id])
            u, memory.behind[i] = law.function(at, u, memory.before[i], *law.values)
            step.ctrl[law.id] = u


def _damp(step, sited):
    damping = {}
    for _, law, at in sited:
        if law.kind == "damping":
            damping[at.dof] = damping.get(at.dof, 0.0) + law.function(at, *law.values)
    for dof, added in damping.items():
        has = max(0.0, step.model.dof_damping[dof])
        step.force[dof] -= max(added, -has) * step.data.qvel[dof]


def _push(step, sited, memory):
    for i, law, at in sited:
        if law.kind == "force":
            step.force[at.dof] += law.function(at, *law.values)
        if law.kind == "memory":
            force, memory.behind[i] = law.function(at, memory.before[i], *law.values)
            step.force[at.dof] += force


def _bind(step, sited):
    bounds = {}
    for _, law, at in sited:
        if law.kind == "bound":
            bound = bounds.get(at.dof, step.model.dof_frictionloss[at.dof])
            bounds[at.dof] = max(bound + law.function(at, *law.values), LEAST_BOUND)
    data = step.data
    _set_bounds(data.efc_type, data.efc_id, data.efc_frictionloss, bounds)
    if bounds and getattr(data, "nisland", 0):  # newer versions solve these, by islands
        _set_bounds(data.iefc_type, data.iefc_id, data.iefc_frictionloss, bounds)


def _wind(step, placed, memory):
    for i, law in enumerate(placed):
        if law.kind == "wound reading":
            dof = step.model.jnt_dofadr[step.model.sensor_objid[law.id]]
            memory.behind[i] = sum(step.arm(motor)[dof] * step.motor_force(motor)
                                   for motor in range(step.model.nu))


def _set_bounds(kinds, ids, friction, bounds):
    for dof, bound in bounds.items():
        friction[(np.asarray(kinds) == FRICTION_OF_DOF) & (np.asarray(ids) == dof)] = bound


def _frame(model, data, kind, place):
    """Where a frame is, how it is turned, and how fast it turns and moves."""
    names = {BODY: "xi", XBODY: "x", GEOM: "geom_x", SITE: "site_x"}[kind]
    bodies = {GEOM: "geom_bodyid", SITE: "site_bodyid"}
    body = getattr(model, bodies[kind])[place] if kind in bodies else place
    position = np.reshape(getattr(data, names + "pos"), (-1, 3))[place]
    rotation = np.reshape(getattr(data, names + "mat"), (-1, 3, 3))[place]
    turning, moving = np.reshape(data.cvel, (-1, 2, 3))[body]
    centre = np.reshape(data.subtree_com, (-1, 3))[model.body_rootid[body]]
    return position, rotation, turning, moving + np.cross(turning, position - centre)


def _rates(model, data, sensor):
    """Of the joint, the tendon, the actuator or the frame whose position a sensor reads.
    Which numbers MuJoCo has for tendons and actuators changes with its version; what is read
    does not."""
    kind, place = model.sensor_objtype[sensor], model.sensor_objid[sensor]
    if kind == JOINT:
        return [data.qvel[model.jnt_dofadr[place]]]
    if kind in (BODY, XBODY, GEOM, SITE):
        position, _, _, velocity = _frame(model, data, kind, place)
        if model.sensor_refid[sensor] < 0:
            return velocity
        origin, rotation, turning, moving = _frame(
            model, data, model.sensor_reftype[sensor], model.sensor_refid[sensor])
        return rotation.T @ (velocity - moving - np.cross(turning, position - origin))
    read = data.sensordata[model.sensor_adr[sensor]]
    if place < model.ntendon and data.ten_length[place] == read:
        return [data.ten_velocity[place]]
    return [data.actuator_velocity[place]]


def _wound(data, law):
    """The force of the last step, of a law that needs it."""
    memory = _memories.get(data)
    if memory is None:
        return 0.0
    known = memory.behind if data.time > memory.time else memory.before
    return known[law] or 0.0


def distort(model, data):
    """The readings of all sensors, data.sensordata with the errors of encoders in it."""
    readings = np.array(data.sensordata, dtype=float)
    for i, law in enumerate(_prepared(model)):
        if law.kind not in ("reading", "late reading", "wound reading"):
            continue
        first, size = model.sensor_adr[law.id], model.sensor_dim[law.id]
        own = readings[first : first + size]
        if law.kind == "late reading":
            readings[first : first + size] = law.function(
                own, np.asarray(_rates(model, data, law.id)), *law.values)
            continue
        if law.kind == "wound reading":
            readings[first] = law.function(readings[first], _wound(data, i), *law.values)
            continue
        for k in range(size):
            own[k] = law.function(float(own[k]), data.time, *law.values)
    return readings


def reset(data):
    """Laws with a memory are at rest in these data, as in new ones."""
    _memories.put(data, None)

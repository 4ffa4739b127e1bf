"""Whether an answer (discovery.json) says what was hidden (truth.json of a case)."""

import dataclasses
import math

SURE = 0.5  # what is named with more than that is an answer
UNNAMED = "force without a name"


@dataclasses.dataclass
class Verdict:
    right: bool
    faults: list  # what is wrong with the answer, for people
    kind: bool = True  # laws of no list: a right kind at a right place
    false: bool = False  # something was named that is not there
    gain: float = None  # of the unseen mismatch


def healthy(name):
    """What a parameter is where nothing is hidden."""
    return 1.0 if name in ("factor", "value") else 0.0


def near(name, value, interval, truth, tolerance):
    if value is None:
        return False
    if name == "phase":
        turn = 2.0 * math.pi
        away = abs((value - truth + 0.5 * turn) % turn - 0.5 * turn)
        return away <= tolerance * turn
    low, high = interval or (None, None)
    if low is not None and high is not None and low <= truth <= high:
        return abs(value - truth) <= 3.0 * tolerance * abs(truth - healthy(name))
    return abs(value - truth) <= tolerance * abs(truth - healthy(name))


def values_near(parameters, truth, tolerance):
    """Of a cause and a form; a form of one number takes whatever its name is."""
    if len(truth) == 1 and len(parameters) == 1:
        found, = parameters.values()
        (name, value), = truth.items()
        return near(name, found["value"], found.get("ci95"), value, tolerance)
    return all(name in parameters and
               near(name, parameters[name]["value"], parameters[name].get("ci95"), value,
                    tolerance)
               for name, value in truth.items())


def says(cause, form):
    return cause["effect"] == form["name"] and form["site"] in ("", cause["site"])


def number_near(answer, name, truth, tolerance):
    """All numbers that share a motor have a scale that no motion tells: one of them may be
    measured by the gear of that motor."""
    numbers = {one["name"]: one for one in answer["calibration"]}
    one = numbers.get(name)
    if one is None or one["value"] is None:
        return False
    scales = [1.0] + [other["value"] for other in numbers.values()
                      if other["name"].startswith("gear@") and other["value"]]
    for scale in scales:
        interval = [edge / scale if edge is not None else None for edge in one["ci95"]]
        if near("factor", one["value"] / scale, interval, truth, tolerance):
            return True
    return False


def named(answer):
    return [cause for cause in answer["causes"] if (cause["probability"] or 0.0) > SURE]


def off_numbers(answer):
    return [number["name"] for number in answer["calibration"] if number.get("off")]


KIND_OF_NUMBER = {"mass": "inertia", "inertia": "inertia", "armature": "inertia",
                  "damping": "viscous friction", "stiffness": "compliance",
                  "friction": "dry friction", "gear": "drive gain"}


def false_kinds(answer, truth):
    """Kinds that are sure and are neither of a cause nor of a number that is off."""
    places = [(set(cause["kinds"]), cause["sites"]) for cause in truth["causes"]]
    places += [({KIND_OF_NUMBER[name.split("@")[0]]}, number["sites"])
               for name, number in truth["numbers"].items()]
    return [f"{kind['kind']}@{kind['site']}" for kind in answer["kinds"]
            if (kind["probability"] or 0.0) > SURE and
            not any(kind["kind"] in kinds and kind["site"] in sites
                    for kinds, sites in places)]


def judge_listed(answer, truth, tolerance):
    """Causes of the catalogue: each with its size, and nothing else."""
    faults = []
    left = named(answer)
    numbers = set(off_numbers(answer))
    for cause in truth["causes"]:
        by_cause = [(one, form) for one in answer["causes"] for form in cause["forms"]
                    if says(one, form)]
        by_number = [form for form in cause["forms"] if form["name"] == "number"
                     and form["site"] in numbers]
        if by_cause:
            one, form = by_cause[0]
            if one in left:
                left.remove(one)
            else:
                faults.append(f"unsure of {one['effect']}@{one['site']} "
                              f"({short(one['probability'])})")
            if not values_near(one["parameters"], form["values"], tolerance):
                faults.append(f"size of {one['effect']}@{one['site']}")
        elif by_number:
            form = by_number[0]
            numbers.discard(form["site"])
            if not number_near(answer, form["site"], form["values"]["factor"], tolerance):
                faults.append(f"size of {form['site']}")
        else:
            faults.append(f"no {cause['effect'].split(':')[0]}")
    for name, number in truth["numbers"].items():
        numbers.discard(name)
        by_fault = [(one, form) for one in left for form in number.get("forms", [])
                    if says(one, form)]
        if by_fault:
            one, form = by_fault[0]
            left.remove(one)
            is_near = values_near(one["parameters"], form["values"], tolerance)
        else:
            is_near = number_near(answer, name, number["factor"], tolerance)
        if not is_near:
            faults.append(f"size of {name}")
    extra = [f"{one['effect']}@{one['site']}" for one in left] + sorted(numbers)
    extra += false_kinds(answer, truth) if not extra else []
    faults += [f"false {one}" for one in extra]
    return Verdict(not faults, faults, false=bool(extra))


def judge_invented(answer, truth, least_gain):
    """Laws of no list: a right kind at a right place, nothing that is not there, and what
    was learned predicts the motion that no fit saw. A curve at the right place is not
    false, but no kind either."""
    kinds = [kind for kind in answer["kinds"] if (kind["probability"] or 0.0) > SURE]
    at_place = [kind for kind in kinds
                if any(kind["site"] in cause["sites"] for cause in truth["causes"])]
    right = [kind for kind in at_place
             if any(kind["kind"] in cause["kinds"] and kind["site"] in cause["sites"]
                    for cause in truth["causes"])]
    false = [kind for kind in kinds if kind not in right and
             not (kind in at_place and kind["kind"] == UNNAMED)]
    gain = answer["gain"]["validation"]
    faults = [f"false {kind['kind']}@{kind['site']}" for kind in false]
    if not right:
        faults.append("no kind at its place")
    if gain is None or gain < least_gain:
        faults.append(f"gain {gain if gain is None else round(gain, 2)}")
    return Verdict(not faults, faults, kind=bool(right), false=bool(false), gain=gain)


def is_listed(truth):
    return all(cause["forms"] for cause in truth["causes"])


def judge(answer, truth, tolerance=0.1, least_gain=0.8):
    if is_listed(truth):
        return judge_listed(answer, truth, tolerance)
    return judge_invented(answer, truth, least_gain)


def short(value):
    return "?" if value is None else f"{value:.4g}"


def answer_text(answer):
    parts = [f"{one['effect']}@{one['site']}" +
             "(" + ", ".join(short(p["value"]) for p in one["parameters"].values()) + ")"
             for one in named(answer)]
    values = {one["name"]: one["value"] for one in answer["calibration"]}
    parts += [f"{name} x {short(values[name])}" for name in off_numbers(answer)]
    if not parts:
        parts = [f"{kind['kind']}@{kind['site']}" for kind in answer["kinds"]
                 if (kind["probability"] or 0.0) > SURE]
    return " + ".join(parts) or "nothing"


def truth_text(truth):
    parts = [cause["effect"] or
             f"{' or '.join(cause['kinds'])}@{' or '.join(cause['sites'])}"
             for cause in truth["causes"]]
    parts += [f"{name} x {number['factor']:g}" for name, number in truth["numbers"].items()]
    return " + ".join(parts) or "nothing"

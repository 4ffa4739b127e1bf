"""effects.py for a program that has MuJoCo and no Python: a line of JSON in, one out.

{"folder", "model"} loads the file beside that plant and prepares the model: what changed of it.
Anything else is the data of a step, before it accelerates: the forces and bounds with those of
the effects."""

import json
import sys

import numpy as np

from effects_test import CHANGED, data_of, effects_of, model_of

# Lists of numbers that are whole; JSON of the others does not tell 0.0 from 0.
WHOLE = ("names", "adr", "size", "dim", "type", "id", "limited", "nnz", "colind")
GIVEN = ("qfrc_passive", "efc_frictionloss", "iefc_frictionloss")


def arrays(message):
    return {name: np.array(value, dtype=int if name.endswith(WHOLE) else float)
            if isinstance(value, list) else value for name, value in message.items()}


def main():
    effects, model, data = None, None, None
    for line in sys.stdin:
        message = json.loads(line)
        if "model" in message:
            effects, model = effects_of(message["folder"]), model_of(arrays(message["model"]))
            effects.prepare(model)
            data = data_of(model)
            reply = {name: np.ravel(getattr(model, name)).tolist() for name in CHANGED}
        else:
            for name, value in arrays(message).items():
                setattr(data, name, value)
            effects.passive(model, data)
            reply = {name: getattr(data, name).tolist() for name in GIVEN}
        print(json.dumps(reply), flush=True)


if __name__ == "__main__":
    main()

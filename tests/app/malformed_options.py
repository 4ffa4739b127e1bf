"""Command lines that mean nothing, and what has to be in the line about each. STAGE,
RECORD and NOWHERE stand for a setup, a record of it and a file that is not there."""

SIMULATE = ("simulate", "--setup", "STAGE")
EXCITE = ("excite", "--setup", "STAGE", "--budget", "0.1")
DISCOVER = ("discover", "--setup", "STAGE", "--budget", "1", "--record", "RECORD")
RENDER = ("render", "--setup", "STAGE", "--duration", "0.1")
WATCH = ("watch", "--setup", "STAGE", "--listen", "127.0.0.1:0", "--source")

OPTIONS = [
    # --fault
    ((*SIMULATE, "--fault", "zeta"), ["--fault", "zeta", "<name>=<value>"]),
    ((*SIMULATE, "--fault", "zeta="), ["zeta", "number"]),
    ((*SIMULATE, "--fault", "zeta=big"), ["zeta", "big", "number"]),
    ((*SIMULATE, "--fault", "zeta=1,2"), ["zeta", "1,2"]),
    ((*SIMULATE, "--fault", "zeta=1e999"), ["zeta", "1e999"]),
    ((*SIMULATE, "--fault", "zeta=nan"), ["--fault zeta", "finite"]),
    ((*SIMULATE, "--fault", "=2"), ["fault", "zeta, eta"]),
    ((*SIMULATE, "--fault", "zeta=2@soon"), ["zeta", "soon"]),
    ((*SIMULATE, "--fault", "zeta=2@-1"), ["zeta", "0 to 10000 s"]),
    # --effect
    ((*SIMULATE, "--effect", "coulomb_friction"), ["coulomb_friction", "@"]),
    ((*SIMULATE, "--effect", "coulomb_friction@"), ["coulomb_friction@"]),
    ((*SIMULATE, "--effect", "coulomb_friction@lode:force=1"), ["lode", "load"]),
    ((*SIMULATE, "--effect", "coulomb_friction@load:weight=1"), ["weight", "force"]),
    ((*SIMULATE, "--effect", "coulomb_friction@load:force=much"), ["force", "much"]),
    ((*SIMULATE, "--effect", "coulomb_friction@load:force=-1"), ["force", "-1"]),
    ((*SIMULATE, "--effect", "coulomb_friction@load:force=1,force=2"), ["force", "twice"]),
    # --set
    ((*SIMULATE, "--set", "rates.control"), ["override 'rates.control'", "expected"]),
    ((*SIMULATE, "--set", "rates.contol=5"), ["contol", "control"]),
    ((*SIMULATE, "--set", "rates.control=fast"), ["rates.control"]),
    ((*SIMULATE, "--set", "rates.control=[1"), ["rates.control"]),
    ((*SIMULATE, "--set", "rates.control=0"), ["rates.control", "0"]),
    ((*SIMULATE, "--set", "=1"), ["override '=1'", "expected"]),
    ((*SIMULATE, "--set", "name.first=1"), ["name"]),
    # numbers
    ((*SIMULATE, "--seed", "-1"), ["--seed", "-1"]),
    ((*SIMULATE, "--seed", "1.5"), ["--seed", "1.5"]),
    ((*SIMULATE, "--duration", "1s"), ["--duration", "1s"]),
    ((*SIMULATE, "--duration", "0,5"), ["--duration", "0,5"]),
    ((*SIMULATE, "--duration", "1e-9"), ["control tick"]),
    ((*SIMULATE, "--noise", "-1"), ["--noise", "-1"]),
    # --limit and --for
    ((*EXCITE, "--limit", "q"), ["--limit", "q"]),
    ((*EXCITE, "--limit", "p:velocity=1"), ["limits", "'p'", "expected an axis"]),
    ((*EXCITE, "--limit", "q:speed=1"), ["speed", "velocity"]),
    ((*EXCITE, "--limit", "q:velocity=-1"), ["limits of 'q'", "velocity", "> 0"]),
    ((*EXCITE, "--limit", "q:velocity=fast"), ["velocity", "fast"]),
    ((*EXCITE, "--limit", "q:lowest=1,highest=-1"), ["lowest", "highest"]),
    ((*EXCITE, "--limit", "q:velocity=1,velocity=2"), ["velocity", "twice"]),
    ((*EXCITE, "--for", "theta"), ["theta", "zeta"]),
    # discover
    ((*DISCOVER, "--record", "NOWHERE"), ["/nowhere"]),
    ((*DISCOVER, "--without", "magic"), ["magic", "friction"]),
    ((*DISCOVER, "--only", "coulomb_friction@lode"), ["lode", "load"]),
    ((*DISCOVER, "--known", "colour"), ["colour", "mass"]),
    ((*DISCOVER, "--causes", "0"), ["--causes", "0"]),
    ((*DISCOVER, "--budget", "forever"), ["--budget", "forever"]),
    # render
    ((*RENDER, "--width", "321"), ["width", "321", "even"]),
    ((*RENDER, "--from", "2", "--to", "1"), ["2.0", "1.0", "begin before end"]),
    ((*RENDER, "--amplify", "load=huge"), ["amplify", "huge"]),
    # watch
    ((*WATCH, "tcp:9870"), ["--source", "tcp:9870", "udp"]),
    ((*WATCH, "udp:99999"), ["--source", "99999"]),
    ((*WATCH, "mqtt:host"), ["--source", "mqtt:HOST[:PORT]/TOPIC"]),
    # init, and a plant in the place of a setup
    (("init", "--plant", "NOWHERE", "--out", "NOWHERE"), ["/nowhere"]),
    (("linearize", "--plant", "NOWHERE"), ["/nowhere"]),
    (("linearize", "--plant", "NOWHERE", "--setup", "STAGE"), ["--plant", "--setup"]),
    (("compare", "--record", "RECORD"), ["--setup", "--plant"]),
    # others
    ((*SIMULATE, "--filters", "NOWHERE", "--diagnose"), ["/nowhere"]),
    ((*SIMULATE, "--replay", "NOWHERE"), ["/nowhere"]),
    ((*SIMULATE, "--stream", "udp:127.0.0.1"), ["--stream", "port", "expected"]),
    (("simulate", "--setup", "STAGE", "--setup", "STAGE"), ["--setup"]),
    (("simulate", "--setup", "NOWHERE"), ["/nowhere", "setup"]),
    (("simulate", "--setup", ""), ["setup"]),
    (("study", "--preset", "table9", "--setup", "STAGE"), ["--preset", "table9", "table2"]),
    (("design", "--setup", "STAGE", "--method", "guess"), ["--method", "guess", "svd"]),
    (("calibrate", "--setup", "STAGE"), ["--record"]),
    (("report", "NOWHERE"), ["/nowhere"]),
]

"""kill -9: half of the moments anywhere in a run, half while its folder changes."""

import os
import shutil
import time

from computer_faults.bench import files_of, halves, leftovers

COMMANDS = ["simulate", "simulate to MAT 7.3", "linearize", "design", "diagnose",
            "calibrate", "compare", "discover", "render", "study --preset", "study --plan",
            "excite", "report", "watch"]
# What a folder is called after a kill; `mixture` is none of both.
STATES = ("old", "new", "mixture")
WRITING = 0.02  # s, that writing takes at most


def faults(kills, moments):
    share, rest = divmod(kills, len(COMMANDS))
    for number, name in enumerate(COMMANDS):
        count = share + (number < rest)
        if count:
            yield (f"kill -9 of {name}",
                   lambda bench, n=name, k=count: KilledCommand(bench, n, moments).kill(k))


class KilledCommand:
    def __init__(self, bench, name, moments):
        self.bench = bench
        self.name = name
        self.moments = moments
        self.out = bench.fresh("killed")
        self.old = self.made("old")
        self.new = self.made("new")
        begin = time.monotonic()
        shutil.copytree(self.old, self.out)
        bench.done(self.arguments())
        self.duration = time.monotonic() - begin
        self.olds = files_of(self.old)
        news = files_of(self.new)
        # Copies of the setup are the same in both and say nothing.
        self.telling = {file for file in {**self.olds, **news}
                        if self.olds.get(file) != news.get(file)}

    def arguments(self, variant="new", out=None):
        out = out or self.out
        if self.name == "report":
            return ["report", out]
        return self.bench.command(self.name, variant, out)

    def made(self, variant):
        out = self.bench.fresh(variant + " results")
        if self.name == "study --plan" and variant == "old":
            os.mkdir(out)
        elif self.name == "report":
            self.bench.done(self.bench.command("diagnose", variant, out))
            if variant == "new":
                self.bench.done(["report", out])
        else:
            self.bench.done(self.arguments(variant, out))
        return out

    def kill(self, count):
        seen = dict.fromkeys(STATES, 0)
        wrong = []
        for number in range(count):
            shutil.rmtree(self.out)
            if self.name == "report":
                # New pages, and the report of the old ones.
                shutil.copytree(self.new, self.out)
                os.remove(os.path.join(self.out, "report.html"))
            else:
                shutil.copytree(self.old, self.out)
            process = self.bench.start(self.arguments())
            where = self.wait(process, while_writing=number % 2 == 1)
            process.kill()
            process.communicate()
            state = self.state()
            seen[state] += 1
            if state == "mixture":
                wrong.append(f"killed {where}: {self.mixture()}")
            wrong += [f"killed {where}: {what}" for what in halves(self.out)]
            # Temporary files of a process that is gone are cleared after a minute.
            for file in leftovers(self.out):
                os.utime(file, (time.time() - 3600.0,) * 2)
            status, _, err = self.bench.run(self.arguments())
            if status not in (0, 1) or "damaged" in err:
                wrong.append(f"killed {where}: the next run ends with {status}: {err[:200]}")
            wrong += [f"killed {where}: the next run leaves {what}"
                      for what in halves(self.out)]
            if self.name == "study --plan":
                wrong += self.differences(where)
            wrong += [f"killed {where}: the next run leaves {os.path.basename(file)}"
                      for file in leftovers(self.out)]
        return (f"{count} kills, " + ", ".join(f"{seen[s]} {s}" for s in STATES), wrong)

    def wait(self, process, while_writing):
        begin = time.monotonic()
        if not while_writing:
            end = begin + self.moments.uniform(0.0, 1.05) * self.duration
            while time.monotonic() < end and process.poll() is None:
                time.sleep(0.001)
        else:
            before = self.look()
            while process.poll() is None and self.look() == before:
                pass
            time.sleep(WRITING * self.moments.random() ** 3)
        where = "while writing" if while_writing else "anywhere"
        return f"{where}, {time.monotonic() - begin:.4f} s after its begin"

    def look(self):
        """What changes when something is written; the probe at the beginning does not."""
        try:
            return sorted((entry.name, entry.stat().st_mtime_ns, entry.stat().st_size)
                          for entry in os.scandir(self.out) if "probe" not in entry.name)
        except OSError:
            return []  # gone between two looks

    def state(self):
        if self.name in ("study --plan", "watch"):
            return "new" if files_of(self.out) != self.olds else "old"  # goes on
        now = files_of(self.out)
        changed = {file for file in self.telling if now.get(file) != self.olds.get(file)}
        if self.name == "report":
            return "new" if "report.html" in now else "old"
        if not changed:
            return "old"
        return "new" if changed == self.telling else "mixture"

    def mixture(self):
        now = files_of(self.out)
        old = sorted(file for file in self.telling if now.get(file) == self.olds.get(file))
        return (f"{len(old)} of {len(self.telling)} files are still the old ones: "
                + ", ".join(old[:4]))

    def differences(self, where):
        """Whoever goes on with a study gets the same bits."""
        name = "dataset.h5"
        file = os.path.join(self.new, name)
        if not os.path.exists(file):
            return []  # built without HDF5
        same = files_of(self.new)[name] == files_of(self.out).get(name)
        return [] if same else [f"killed {where}: another {name}"]

"""What a process is given by the computer around it: memory, a locale, a clock."""

import os
import resource
import shutil
import subprocess

from computer_faults.bench import UNLIKE, Skipped, complaint, files_of, halves, leftovers

MEGABYTE = 1 << 20
STEP = 4  # MB
MORE = (0, 4, 8, 16, 32, 64, 128, 256, 512)  # MB than it takes to begin
CLOCK = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <sys/time.h>
#include <time.h>
/* From the hundredth look on the clock on the wall is an hour behind, from the two
   hundredth on it is right, and so on; clocks that only count are left alone. */
static long Shift(void) {
  static long looks;
  return ++looks / 100 % 2 ? 3600 : 0;
}
int clock_gettime(clockid_t clock, struct timespec* now) {
  static int (*original)(clockid_t, struct timespec*);
  if (!original) original = dlsym(RTLD_NEXT, "clock_gettime");
  int status = original(clock, now);
  if (status == 0 && clock == CLOCK_REALTIME) now->tv_sec -= Shift();
  return status;
}
time_t time(time_t* to) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (to) *to = now.tv_sec;
  return now.tv_sec;
}
int gettimeofday(struct timeval* restrict to, void* restrict zone) {
  struct timespec now;
  (void)zone;
  clock_gettime(CLOCK_REALTIME, &now);
  to->tv_sec = now.tv_sec;
  to->tv_usec = now.tv_nsec / 1000;
  return 0;
}
"""


def run_within(bench, arguments, megabytes):
    limit = megabytes * MEGABYTE
    return bench.run(arguments, preexec_fn=lambda: resource.setrlimit(
        resource.RLIMIT_AS, (limit, limit)))


def little_memory(bench):
    # With less, the libraries that it is linked to fail before it begins.
    least = next(limit for limit in range(100, 4000, STEP)
                 if run_within(bench, ["--version"], limit)[0] == 0)
    wrong, seen = [], {}
    for name in ("simulate", "design", "calibrate", "render", "study --plan", "discover"):
        for limit in (least + more for more in MORE):
            out = bench.fresh("little memory")
            status, _, err = run_within(bench, bench.command(name, "new", out), limit)
            seen[status] = seen.get(status, 0) + 1
            if status not in (0, 1):
                what = complaint(status, err, (2, 3))
                wrong += [f"{name}, {limit} MB: {what}"] if what else []
            wrong += [f"{name}, {limit} MB: {what}" for what in halves(out)]
            wrong += [f"{name}, {limit} MB: left {what}" for what in leftovers(out)]
    return (f"from {least} MB on, exit statuses "
            + ", ".join(f"{s}: {n} times" for s, n in sorted(seen.items())), wrong)


def decimal_commas(bench):
    place = bench.fresh("locales")
    os.mkdir(place)
    if not shutil.which("localedef"):
        raise Skipped("no localedef to make de_DE.UTF-8 with")
    made = subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8",
                           os.path.join(place, "de_DE.UTF-8")], stderr=subprocess.PIPE,
                          check=False)
    if not os.listdir(place):
        raise Skipped("de_DE.UTF-8 cannot be made: " + made.stderr.decode().strip()[:100])
    german = {**os.environ, "LOCPATH": place, "LC_ALL": "de_DE.UTF-8"}
    asked = subprocess.run(["locale", "-k", "decimal_point"], env=german,
                           stdout=subprocess.PIPE, check=False).stdout
    if b'","' not in asked:
        raise Skipped("the locale that was made has no decimal comma")
    wrong = []
    # HDF5 writes down when it made something: no MAT 7.3.
    names = ("simulate", "simulate to MAT 5", "linearize", "design", "diagnose",
             "calibrate", "compare", "study --preset", "study --plan", "render")
    for name in names:
        answers = []
        for environment in ({**os.environ, "LC_ALL": "C"}, german):
            out = bench.fresh("some locale")
            printed = UNLIKE.sub(b"", bench.done(bench.command(name, "new", out),
                                                 env=environment))
            files = files_of(out)
            files.pop("study.log", None)  # says how long it took
            if name == "study --plan":
                printed = files.pop("study.json", None) and files.pop("study.page.json", None)
            answers.append((printed, files))
        if answers[0] != answers[1]:
            wrong.append(f"{name}: another answer")
    return f"{len(names)} commands, the same bytes", wrong


def clock_jumps(bench):
    compiler = shutil.which("cc")
    if not compiler:
        raise Skipped("no cc to compile a clock with")
    source, library = bench.path("clock.c"), bench.path("clock.so")
    with open(source, "w", encoding="ascii") as stream:
        stream.write(CLOCK)
    subprocess.run([compiler, "-shared", "-fPIC", "-O", "-o", library, source, "-ldl"],
                   check=True)
    environment = {**os.environ, "LD_PRELOAD": library}
    wrong = []
    names = ("simulate", "discover", "excite", "study --plan", "watch")
    for name in names:
        files = []
        for variables in (os.environ, environment):
            out = bench.fresh("clock")
            status, _, err = bench.run(bench.command(name, "new", out), env=variables)
            if status not in (0, 1):
                wrong.append(f"{name}: status {status}: {err.strip()[:200]}")
            wrong += [f"{name}: {what}" for what in halves(out)]
            files.append(files_of(out))
        if name == "simulate" and files[0] != files[1]:
            wrong.append("simulate: another answer")
        if set(files[0]) != set(files[1]):
            wrong.append(f"{name}: other files")
    # The watch takes up its history, which may be from a time to come.
    status, _, err = bench.run(bench.command("watch", "new", out))
    if status != 0 or "damaged" in err:
        wrong.append(f"watch that goes on: status {status}: {err.strip()[:200]}")
    return f"{len(names)} commands, a clock that jumps by an hour", wrong


FAULTS = [("too little memory", little_memory), ("decimal commas", decimal_commas),
          ("a clock that jumps back", clock_jumps)]

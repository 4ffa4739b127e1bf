"""A study by the ranks of a job: the same bits as by one process, ranks that are killed,
jobs that are killed, and what is said once.

    ranks_test.py <mjdiag>       status 77 without MPI
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
PROGRAM = Path(sys.argv[1]).resolve()
RUNS = 600  # so many that no rank is done before the others have begun
PLAN = f"""schema = "mjdiag.plan/1"
name = "ranks"
setup = "{ROOT}/mjcf/ab383"
linear = true
trajectories = ["xyz"]
duration = 0.06
method = "random"
points = {RUNS}
[keep]
records = ["x", "u_x"]
features = ["x"]
segment = 256
[[axis]]
fault = "eta_x"
from = 0.99
to = 0.9
"""
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1",
               "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
LIMIT = 60  # s


def study(plan, out, *options, ranks=1, launcher=(), environment=None):
    command = [PROGRAM, "study", "--plan", plan, "--out", out, *options]
    if ranks > 1:
        command = ["mpirun", "--oversubscribe", *launcher, "-n", str(ranks), *command]
    return subprocess.Popen([str(word) for word in command], text=True,
                            env={**ENVIRONMENT, **(environment or {})},
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def rank_of(process):
    try:
        text = Path(f"/proc/{process}/environ").read_bytes()
    except OSError:
        return None
    found = re.search(rb"(?:^|\0)OMPI_COMM_WORLD_RANK=(\d+)\0", text)
    return int(found[1]) if found else None


def ranks_of(job):
    children = Path(f"/proc/{job.pid}/task/{job.pid}/children").read_text().split()
    return {rank_of(int(child)): int(child) for child in children}


class Ranks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        cls.plan = cls.folder / "plan.toml"
        cls.plan.write_text(PLAN)
        cls.finish(study(cls.plan, cls.folder / "alone"))
        cls.has_data = (cls.folder / "alone/dataset.h5").exists()

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @staticmethod
    def finish(job, status=0):
        out, err = job.communicate(timeout=LIMIT)
        if status is not None and job.returncode != status:
            raise AssertionError(f"status {job.returncode}\n{out}\n{err}")
        return out, err

    def same_as_alone(self, name):
        for file in ("runs.journal", "dataset.h5") if self.has_data else ("runs.journal",):
            self.assertEqual((self.folder / name / file).read_bytes(),
                             (self.folder / "alone" / file).read_bytes(), file)
        self.assertEqual(sorted((self.folder / name).glob("runs.*")),
                         [self.folder / name / "runs.journal"])

    def wait_for_runs(self, job, name, rank):
        """Till that rank has made some."""
        journal = self.folder / name / f"runs.{rank}.journal"
        until = time.monotonic() + LIMIT
        # The beginning of a journal, and results without their series, are less.
        enough = (self.folder / "alone/runs.journal").stat().st_size + 1000
        while not journal.exists() or journal.stat().st_size < enough:
            self.assertIsNone(job.poll(), "it had ended before")
            self.assertLess(time.monotonic(), until)
            time.sleep(0.005)

    def test_the_runs_of_a_killed_rank_are_repeated(self):
        job = study(self.plan, self.folder / "repeated", "--threads", "1", "--patience", "2",
                    ranks=2, launcher=["--enable-recovery"])
        self.wait_for_runs(job, "repeated", 1)
        os.kill(ranks_of(job)[1], signal.SIGKILL)
        _, err = self.finish(job)
        self.assertIn("rank 1 does not answer", err)
        self.same_as_alone("repeated")

    def test_a_job_that_was_killed_is_gone_on_with_on_any_number_of_ranks(self):
        job = study(self.plan, self.folder / "killed", "--threads", "1", ranks=3)
        self.wait_for_runs(job, "killed", 1)
        os.kill(ranks_of(job)[0], signal.SIGKILL)
        self.finish(job, None)
        self.assertNotEqual(job.returncode, 0)
        self.assertFalse((self.folder / "killed/dataset.h5").exists())
        # By the launcher, which asks all ranks to end.
        job = study(self.plan, self.folder / "killed", "--threads", "1", ranks=2)
        time.sleep(1.0)  # whatever it does then
        job.terminate()
        self.finish(job, None)
        out, _ = self.finish(study(self.plan, self.folder / "killed", "--threads", "2", ranks=2))
        self.assertEqual(out.count(f"{RUNS} of {RUNS} runs"), 1)
        self.assertIn("of which were there", out)
        self.same_as_alone("killed")

    def test_what_is_wrong_is_said_once(self):
        broken = self.folder / "broken.toml"
        broken.write_text(PLAN.replace("points", "pionts"))
        for plan, words, environment in (
                (broken, "points: is missing", {}),
                (self.plan, "is not there",
                 {"MJDIAG_MPI_MODULE": str(self.folder / "none.so")})):
            _, err = self.finish(study(plan, self.folder / "none", ranks=2,
                                       environment=environment), 2)
            self.assertEqual(err.count("mjdiag: "), 1, err)
            self.assertIn(words, err)


if __name__ == "__main__":
    if shutil.which("mpirun") is None:
        print("skipped: mpirun is not installed")
        sys.exit(77)
    if not (PROGRAM.parent / "libmjdiag-mpi.so").exists():
        print("skipped: built without MPI")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])

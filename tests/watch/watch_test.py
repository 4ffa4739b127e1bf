"""`mjdiag watch` beside `mjdiag simulate --stream`, as processes: over UDP, pipes and a
broker that is killed, with readers of its page and a browser. What is not installed is
said and passed over."""

import http.client
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import urllib.error
import urllib.request

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "browser"))
from browser import Browser, Tab  # noqa: E402

COMMAND = sys.argv[1] if __name__ == "__main__" else ""
SOURCE = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
MACHINE = ["--setup", os.path.join(SOURCE, "mjcf", "ab383"), "--linear"]
PATIENCE = 60.0  # s, until something counts as not coming


def wait_until(condition, what):
    """The first answer of the condition that is true."""
    deadline = time.monotonic() + PATIENCE
    while True:
        answer = condition()
        if answer:
            return answer
        if time.monotonic() > deadline:
            raise AssertionError("waited in vain for " + what)
        time.sleep(0.05)


def free_port(kind=socket.SOCK_STREAM):
    with socket.socket(socket.AF_INET, kind) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Process:
    """One that a test has started, with the lines that it prints."""

    def __init__(self, arguments, stdin=None):
        self.process = subprocess.Popen(arguments, cwd=SOURCE, stdin=stdin,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.out, self.err = [], []
        self._threads = [
            threading.Thread(target=self._read, args=pipe, daemon=True)
            for pipe in ((self.process.stdout, self.out), (self.process.stderr, self.err))]
        for thread in self._threads:
            thread.start()

    @staticmethod
    def _read(pipe, lines):
        for line in pipe:
            lines.append(line.decode().rstrip("\n"))

    def end(self):
        if self.process.poll() is None:
            self.process.terminate()
        return self.wait()

    def wait(self):
        status = self.process.wait(PATIENCE)
        for thread in self._threads:
            thread.join(PATIENCE)
        for pipe in (self.process.stdout, self.process.stderr):
            pipe.close()
        return status

    def kill(self):
        self.process.kill()
        self.wait()


class Watch(Process):
    def __init__(self, source, *options, stdin=None):
        super().__init__([COMMAND, "watch", *MACHINE, "--filters", WatchTest.filters,
                          "--source", source, "--listen", "127.0.0.1:0", *options], stdin)
        self.url = wait_until(self._find_url, "the address of the page")

    def _find_url(self):
        for line in list(self.err):
            if line.startswith("watch: http://"):
                return line[len("watch: "):]
        if self.process.poll() is not None:
            raise AssertionError("the watch has ended: " + "; ".join(self.err))
        return None

    def get(self, path):
        with urllib.request.urlopen(self.url + path, timeout=PATIENCE) as answer:
            return answer.read().decode()

    def state(self):
        return json.loads(self.get("state.json"))

    def wait_for(self, what, condition):
        return wait_until(lambda: (lambda s: s if condition(s) else None)(self.state()), what)

    def events(self):
        return [json.loads(line) for line in list(self.out)]


def is_running(state):
    return state["source"]["state"] == "running"


def names_zeta_x(state):
    return state["verdict"]["kind"] == "fault" and any(
        fault["name"] == "zeta_x" for fault in state["verdict"]["faults"])


class WatchTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="mjdiag-watch-")
        subprocess.run([COMMAND, "design", *MACHINE, "--out", cls.folder], check=True,
                       stdout=subprocess.DEVNULL)
        cls.filters = os.path.join(cls.folder, "filters.json")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def watch(self, source, *options, **more):
        watch = Watch(source, "--no-picture", *options, **more)
        self.addCleanup(watch.end)
        return watch

    def stream(self, target, *options):
        stream = Process([COMMAND, "simulate", *MACHINE, "--stream", target, *options])
        self.addCleanup(stream.end)
        return stream

    def refusal(self, *options):
        """The one line and the status of a watch that does not begin."""
        done = subprocess.run([COMMAND, "watch", *MACHINE, "--filters", self.filters, *options],
                              capture_output=True, text=True, cwd=SOURCE, timeout=PATIENCE,
                              stdin=subprocess.DEVNULL)
        lines = done.stderr.strip().splitlines()
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertEqual(done.returncode, 2)
        return lines[0]

    def test_a_fault_that_appears_is_said_everywhere(self):
        port = free_port(socket.SOCK_DGRAM)
        out = os.path.join(self.folder, "everywhere")
        watch = self.watch("udp:%d" % port, "--out", out)
        self.assertEqual(watch.state()["source"]["state"], "waiting")
        self.stream("udp:127.0.0.1:%d" % port, "--fault", "zeta_x=1.2@3")
        watch.wait_for("a healthy machine", lambda s: s["verdict"]["kind"] == "healthy")
        state = watch.wait_for("the fault", names_zeta_x)
        self.assertIn("zeta_x", state["verdict"]["words"])
        self.assertEqual(state["source"]["missing"], 0)
        metrics = watch.get("metrics")
        self.assertIn('mjdiag_watch_verdict{kind="fault"} 1', metrics)
        self.assertIn('mjdiag_watch_fault_detected{fault="zeta_x"} 1', metrics)
        for line in metrics.splitlines():
            self.assertRegex(line, r"^(# (HELP|TYPE) \w+ .+|\w+(\{\w+=\"[^\"]*\"\})? \S+)$")
        history = json.loads(watch.get("history.json?level=0"))
        self.assertGreater(len(history["time"]), 2)
        self.assertEqual(len(history["quantities"]["zeta_x"]["mean"]), len(history["time"]))
        self.assertEqual(watch.end(), 0)
        kinds = [event["verdict"]["kind"] for event in watch.events()
                 if event["event"] == "verdict"]
        self.assertEqual(kinds[0], "healthy")
        self.assertEqual(kinds[-1], "fault")
        with open(os.path.join(out, "events.jsonl"), encoding="utf-8") as file:
            self.assertEqual([line.rstrip("\n") for line in file], watch.out)

        # Another watch of the same folder goes on where this one ended.
        again = self.watch("udp:%d" % port, "--out", out)
        resumed = again.state()
        self.assertTrue(names_zeta_x(resumed))
        self.assertEqual(resumed["verdict"]["since"], state["verdict"]["since"])
        rows = json.loads(again.get("history.json?level=0"))["time"]
        self.assertEqual(rows[0], history["time"][0])
        again.wait_for("the fault again",
                       lambda s: s["look"] and s["look"]["kind"] == "fault")
        self.assertEqual(again.state()["verdict"]["since"], state["verdict"]["since"])
        self.assertEqual([e for e in again.events() if e["event"] == "verdict"], [])

    def test_stalls_nonsense_and_new_senders_are_told_and_survived(self):
        port = free_port(socket.SOCK_DGRAM)
        watch = self.watch("udp:%d" % port)
        first = self.stream("udp:127.0.0.1:%d" % port)
        watch.wait_for("ticks", is_running)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wild:
            for nonsense in (b"", b"\x00" * 40, b"MJDT", b"MJDT" + b"\xff" * 60,
                             os.urandom(1400), b"0.1,2,3,4,5\n" * 50, b"x" * 60000):
                wild.sendto(nonsense, ("127.0.0.1", port))
        state = watch.wait_for("the nonsense", lambda s: s["source"]["nonsense"] > 50)
        self.assertIn("expected", state["source"]["last_nonsense"])
        first.kill()
        watch.wait_for("silence", lambda s: s["source"]["state"] == "silent")
        self.stream("udp:127.0.0.1:%d" % port, "--twice")
        state = watch.wait_for("ticks again",
                               lambda s: is_running(s) and s["source"]["repeated"] > 100)
        self.assertEqual(state["source"]["sender_runs"], 2)
        watch.wait_for("a verdict", lambda s: s["verdict"]["kind"] == "healthy")
        self.assertEqual(watch.state()["source"]["missing"], 0)
        self.assertEqual(watch.end(), 0)
        states = [e["state"] for e in watch.events() if e["event"] == "source"]
        self.assertEqual(states, ["running", "silent", "running"])

    def test_lost_and_late_packets_are_counted(self):
        port = free_port(socket.SOCK_DGRAM)
        watch = self.watch("udp:%d" % port)
        target = free_port(socket.SOCK_DGRAM)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as inlet:
            inlet.bind(("127.0.0.1", target))
            inlet.settimeout(PATIENCE)
            self.stream("udp:127.0.0.1:%d" % target, "--batch", "20")
            held = None
            for k in range(1200):
                packet = inlet.recv(65536)
                if k in (200, 201):
                    continue  # lost
                if k % 200 == 100:
                    held = packet  # overtaken
                    continue
                inlet.sendto(packet, ("127.0.0.1", port))
                if held is not None:
                    inlet.sendto(held, ("127.0.0.1", port))
                    held = None
            source = watch.wait_for(
                "all of it", lambda s: s["source"]["taken"] >= 20 * 1198)["source"]
        self.assertEqual((source["missing"], source["gaps"]), (40, 1))
        self.assertEqual(source["reordered"], 6 * 20)
        self.assertEqual(source["diagnosis_runs"], 2)
        watch.wait_for("a verdict", lambda s: s["verdict"]["kind"] == "healthy")

    def test_a_record_through_a_pipe_is_judged_to_its_end(self):
        out = os.path.join(self.folder, "record")
        subprocess.run([COMMAND, "simulate", *MACHINE, "--fault", "zeta_x=1.2", "--out", out],
                       check=True, stdout=subprocess.DEVNULL, cwd=SOURCE)
        with open(os.path.join(out, "record.csv"), "rb") as record:
            rows = sum(1 for _ in record) - 1
            record.seek(0)
            watch = self.watch("stdin", stdin=record)
            self.assertEqual(watch.wait(), 0)
        verdicts = [e["verdict"] for e in watch.events() if e["event"] == "verdict"]
        self.assertEqual(verdicts[-1]["faults"][0]["name"], "zeta_x")
        self.assertGreater(rows, 1000)

    def test_ten_readers_get_the_events(self):
        port = free_port(socket.SOCK_DGRAM)
        watch = self.watch("udp:%d" % port)
        self.stream("udp:127.0.0.1:%d" % port)
        got = [0] * 10

        def read(place):
            with urllib.request.urlopen(watch.url + "events", timeout=PATIENCE) as events:
                for line in events:
                    if line.startswith(b"data: "):
                        json.loads(line[6:])
                        got[place] += 1
                        if got[place] == 10:
                            return

        readers = [threading.Thread(target=read, args=(k,)) for k in range(10)]
        for reader in readers:
            reader.start()
        for reader in readers:
            reader.join(PATIENCE)
        self.assertEqual(got, [10] * 10)
        self.assertEqual(watch.state()["source"]["missing"], 0)

    def test_there_is_nothing_to_write_and_nothing_without_a_token(self):
        watch = self.watch("udp:%d" % free_port(socket.SOCK_DGRAM), "--token", "s3cret")
        host = watch.url[len("http://"):].rstrip("/")

        def status(method, path, headers):
            connection = http.client.HTTPConnection(host, timeout=PATIENCE)
            connection.request(method, path, headers=headers)
            answer = connection.getresponse().status
            connection.close()
            return answer

        bearer = {"Authorization": "Bearer s3cret"}
        self.assertEqual(status("GET", "/", {}), 401)
        self.assertEqual(status("GET", "/metrics", {"Authorization": "Bearer s3cre"}), 401)
        self.assertEqual(status("GET", "/metrics", bearer), 200)
        self.assertEqual(status("GET", "/?token=s3cret", {}), 200)
        for method in ("POST", "PUT", "DELETE", "PATCH"):
            self.assertEqual(status(method, "/state.json", bearer), 405)
        self.assertEqual(status("GET", "/history.json?level=9", bearer), 404)
        self.assertEqual(status("GET", "/../../etc/passwd", bearer), 404)

    def test_another_name_for_this_machine_is_refused(self):
        watch = self.watch("udp:%d" % free_port(socket.SOCK_DGRAM))
        request = urllib.request.Request(watch.url, headers={"Host": "evil.example"})
        with self.assertRaises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(request, timeout=PATIENCE)
        self.assertEqual(refused.exception.code, 403)

    def test_bad_input_gets_one_line(self):
        with socket.socket() as taken, socket.socket(socket.AF_INET,
                                                     socket.SOCK_DGRAM) as heard:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            heard.bind(("127.0.0.1", 0))
            in_use = "127.0.0.1:%d" % taken.getsockname()[1]
            self.assertIn("the port is in use",
                          self.refusal("--source", "stdin", "--listen", in_use))
            self.assertIn("a port that nobody else listens on",
                          self.refusal("--source", "udp:%d" % heard.getsockname()[1],
                                       "--listen", "127.0.0.1:0"))
        self.assertIn("--token", self.refusal("--source", "stdin", "--listen", "0.0.0.0:0"))
        self.assertIn("mqtt:HOST", self.refusal("--source", "tcp:1"))
        self.assertIn("mqtt:HOST", self.refusal("--source", "stdin", "--publish", "udp:1"))

    def test_a_damaged_history_is_put_aside(self):
        out = os.path.join(self.folder, "damaged")
        os.mkdir(out)
        file = os.path.join(out, "watch.history")
        with open(file, "w", encoding="utf-8") as damaged:
            damaged.write("nothing of the kind")
        watch = self.watch("stdin", "--out", out, stdin=subprocess.DEVNULL)
        self.assertEqual(watch.wait(), 0)
        self.assertTrue(any("put aside" in line for line in watch.err), watch.err)
        self.assertTrue(os.path.exists(file + ".damaged"))
        self.assertTrue(os.path.exists(file))

    def test_a_broker_is_killed_and_comes_back(self):
        broker_command = shutil.which("mosquitto") or "/usr/sbin/mosquitto"
        if not os.path.exists(broker_command):
            self.skipTest("no mosquitto")
        port = free_port()

        def broker():
            made = Process([broker_command, "-p", str(port)])
            self.addCleanup(made.end)
            return made

        first = broker()
        here = "mqtt:127.0.0.1:%d/" % port
        watch = self.watch(here + "ticks", "--publish", here + "watch")
        self.stream(here + "ticks", "--fault", "zeta_x=1.2@6")
        watch.wait_for("ticks", is_running)
        first.kill()
        state = watch.wait_for("silence", lambda s: s["source"]["state"] == "silent")
        self.assertTrue(any("broker" in note for note in state["source"]["notes"]))
        broker()
        watch.wait_for("ticks again", is_running)
        watch.wait_for("the fault", names_zeta_x)
        # What was said last waits at the broker for those that come later.
        if shutil.which("mosquitto_sub"):
            said = wait_until(lambda: subprocess.run(
                ["mosquitto_sub", "-p", str(port), "-t", "watch/verdict", "-C", "1", "-W", "5"],
                capture_output=True, check=False).stdout, "the retained verdict")
            self.assertEqual(json.loads(said)["kind"], "fault")

    def test_the_page_says_what_is_wrong(self):
        if shutil.which("chromium") is None:
            self.skipTest("no chromium")
        port = free_port(socket.SOCK_DGRAM)
        watch = self.watch("udp:%d" % port)
        browser = Browser()
        self.addCleanup(browser.close)
        with Tab(browser, height=1400) as tab:
            tab.call("Page.navigate", url=watch.url)
            browser.wait_for("Page.loadEventFired", tab.session)

            def text(selector):
                return tab.run("(s) => document.querySelector(s).textContent", selector)

            wait_until(lambda: "Nothing has come in" in text("#source"), "the page")
            self.stream("udp:127.0.0.1:%d" % port, "--fault", "zeta_x=1.2@4")
            wait_until(lambda: "Nothing is wrong" in text("#verdict"), "a healthy machine")
            # Whoever looks at the page knows as soon as the watch itself does.
            wait_until(lambda: "zeta_x" in text("#verdict"), "the fault on the page")
            said = [e for e in watch.events()
                    if e["event"] == "verdict" and e["verdict"]["kind"] == "fault"]
            self.assertTrue(said)
            self.assertIn("!", text("#verdict .mark"))
            self.assertTrue(tab.run(
                "() => document.querySelector('tr[data-fault=zeta_x]').className === 'named'"))
            wait_until(lambda: tab.run("() => document.querySelectorAll('canvas').length > 2"),
                       "the plots")
            foreign = [c for c in tab.complaints() if not c.startswith("loads " + watch.url)]
            self.assertEqual(foreign, [])
            folder = os.environ.get("MJDIAG_SCREENSHOTS")
            if folder:
                time.sleep(2)
                with open(os.path.join(folder, "watch.png"), "wb") as file:
                    file.write(tab.screenshot())
            watch.end()
            wait_until(lambda: "does not answer" in text("#lost"), "that the watch has ended")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)

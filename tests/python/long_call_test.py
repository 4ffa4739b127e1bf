"""What takes long: progress, other threads, and Ctrl-C."""

import os
import signal
import sys
import threading
import time
import unittest
from unittest import mock


import mjdiag
from support import MJCF, Test, current, voice_coil


# Under a sanitizer what takes a moment takes seven times as long.
PATIENCE = 10.0 if "MJDIAG_SANITIZED" in os.environ else 1.0


def interrupt_after(seconds):
    """Ctrl-C, as a terminal sends it."""
    timer = threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT))
    timer.daemon = True
    timer.start()


class LongCallTest(Test):
    @classmethod
    def setUpClass(cls):
        cls.bonder = mjdiag.Machine(os.path.join(MJCF, "ab383"))
        # A shell lets what it runs in the background ignore Ctrl-C.
        signal.signal(signal.SIGINT, signal.default_int_handler)

    def test_tells_how_far_it_is_in_the_calling_thread(self):
        told = []
        self.bonder.simulate(
            progress=lambda fraction, what: told.append(
                (fraction, what, threading.get_ident())))
        self.assertEqual(told[-1][0], 1.0)
        self.assertGreater(len(told), 1)
        self.assertEqual([one[0] for one in told], sorted(one[0] for one in told))
        self.assertEqual({one[1:] for one in told},
                         {("simulating", threading.get_ident())})

    def test_what_the_callback_raises_ends_the_call(self):
        class Enough(Exception):
            pass

        def refuse(fraction, what):
            raise Enough(what)

        start = time.monotonic()
        with self.assertRaises(Enough):
            self.bonder.simulate(progress=refuse)
        self.assertLess(time.monotonic() - start, 5.0 * PATIENCE)

    def test_a_bar_is_no_requirement(self):
        self.bonder.simulate(duration=0.01, progress=True)
        self.bonder.simulate(duration=0.01, progress=False)
        self.assertRefuses(lambda: self.bonder.simulate(progress=3), "progress", "int")

    def test_a_bar_of_tqdm_goes_to_its_end_and_is_closed(self):
        tqdm = mock.MagicMock()
        with mock.patch.dict(sys.modules, {"tqdm": tqdm, "tqdm.auto": tqdm}):
            self.bonder.simulate(duration=0.1, progress=True)
        bar = tqdm.tqdm.return_value
        self.assertEqual(bar.n, 100.0)
        bar.close.assert_called_once()

    def test_other_threads_run_meanwhile(self):
        done, counted = threading.Event(), []

        def work():
            self.bonder.simulate()
            done.set()

        thread = threading.Thread(target=work)
        thread.start()
        while not done.is_set():
            counted.append(time.monotonic())
            time.sleep(0.001)
        thread.join()
        # Had the run kept the lock, this thread would have come to its end only.
        self.assertGreater(len(counted), 20)

    def test_threads_share_a_machine(self):
        results = [None] * 4

        def work(number):
            results[number] = worn.diagnose(tomorrow).faults["zeta"].value

        worn = voice_coil()
        tomorrow = worn.with_faults(zeta=1.1).simulate(replay=current(1.0))
        threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(set(results)), 1)
        self.assertAlmostEqual(results[0], 1.1, 2)

    def test_ctrl_c_ends_a_run(self):
        interrupt_after(0.1)
        start = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            for _ in range(1000):
                self.bonder.simulate()
        self.assertLess(time.monotonic() - start, 5.0 * PATIENCE)

    def test_ctrl_c_ends_a_discovery_with_the_best_answer(self):
        coil = voice_coil()
        measured = coil.with_effect("cubic_stiffness@stage", coefficient=4e6).simulate(
            replay=current())
        pressed = []

        def press(fraction, what):
            if "so far" in what and not pressed:
                pressed.append(what)
                os.kill(os.getpid(), signal.SIGINT)

        found = coil.discover([measured], budget=100, progress=press)
        self.assertTrue(pressed)
        self.assertTrue(found.stopped)
        self.assertEqual([cause.effect for cause in found.causes], ["cubic_stiffness"])

    def test_ctrl_c_ends_an_excitation_with_the_best_motion(self):
        pressed = []

        def press(fraction, what):
            if "so far" in what and not pressed:
                pressed.append(what)
                os.kill(os.getpid(), signal.SIGINT)

        start = time.monotonic()
        found = self.bonder.excite("beta_x", budget=1000, progress=press)
        self.assertTrue(pressed)
        self.assertTrue(found.stopped)
        self.assertGreater(found.gain, 1.0)
        self.assertLess(time.monotonic() - start, 60.0 * PATIENCE)
        self.assertGreater(found.machine.simulate(duration=0.01).samples, 0)

    def test_ctrl_c_ends_a_comparison(self):
        record = self.bonder.simulate()
        interrupt_after(0.1)
        with self.assertRaises(KeyboardInterrupt):
            for _ in range(1000):
                self.bonder.compare(record)

    def test_ctrl_c_ends_a_design(self):
        interrupt_after(0.3)
        with self.assertRaises(KeyboardInterrupt):
            self.bonder.design(nominal_runs=1000)


if __name__ == "__main__":
    unittest.main()

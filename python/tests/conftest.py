"""Shared parts of the tests: declarations, and the command `dalembert`."""

import os
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

BALL = """
/// A ball above a floor.
Ball {
    coordinates { x; }
    parameters {
        /// Mass.
        m > 0 = 1/2;
        /// Gravity.
        g > 0 = 9.81;
    }
    lagrangian = m/2*dot(x)^2 - m*g*x;
    impacts { floor: x >= 0 => newton(1/2); }
    initial { x = 1; until = 1; }
}
"""

SLEIGH = """
Sleigh {
    coordinates { x; y; theta: angle; }
    parameters { m > 0 = 1; I > 0 = 1; a = 1/5; }
    let slip = -dot(x)*sin(theta) + dot(y)*cos(theta);
    lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (I + m*a^2)/2*dot(theta)^2 + a*m*dot(theta)*slip;
    constraints { blade: slip = 0; }
    claims { density: exact; }
}
"""


class Interrupted(ThreadPoolExecutor):
    """A thread. The fourth call that is submitted is interrupted, as by Ctrl-C."""

    def __init__(self):
        super().__init__(1)
        self.calls = 0

    def submit(self, function, *arguments):
        self.calls += 1
        if self.calls == 4:
            raise KeyboardInterrupt
        return super().submit(function, *arguments)


@pytest.fixture(scope="session")
def command():
    """Runs the command `dalembert`: the one that the variable DALEMBERT names, or one that is built in the checkout."""
    built = Path(__file__).parents[2] / "target" / "release" / "dalembert"
    path = os.environ.get("DALEMBERT") or shutil.which(built)
    if path is None:
        pytest.skip("no command `dalembert`: build it with `cargo build --release`, or name it by the variable DALEMBERT")

    def run(*arguments):
        finished = subprocess.run([path, *arguments], capture_output=True, text=True)
        assert finished.returncode in (0, 1), finished.stderr
        return finished.stdout

    return run

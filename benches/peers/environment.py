"""The folder that the peers need: a Python environment, the compiled peers, and this project, compiled."""

import os
import platform
import subprocess
import sys
from importlib import metadata
from pathlib import Path

HERE = Path(__file__).resolve().parent
PACKAGES = ("numpy", "scipy", "numba", "heyoka", "casadi", "symforce")
SUNDIALS = ("cvode", "arkode", "nvecserial", "sunnonlinsolfixedpoint")


def say(text):
    print(text, file=sys.stderr, flush=True)


class Environment:
    """Builds everything in a folder. Packages that are installed there are kept."""

    def __init__(self, folder):
        self.folder = Path(folder).resolve()
        self.folder.mkdir(parents=True, exist_ok=True)
        self.python = self.folder / "venv" / "bin" / "python"
        self.dop853 = self.folder / "dop853"
        self.sundials = self.folder / "sundials"
        self.ours = None

    def prepare(self):
        self.make_python()
        self.compile_hand()
        self.compile_sundials()
        self.compile_ours()

    def make_python(self):
        if not self.python.exists():
            subprocess.run([sys.executable, "-m", "venv", self.folder / "venv"], check=True)
        missing = [name for name in PACKAGES if not self.version(name)]
        if missing:
            say(f"installing {', '.join(missing)}")
            subprocess.run([self.python, "-m", "pip", "install", "--quiet", *missing], check=True)

    def version(self, package):
        """The version of an installed package; empty if it is not there."""
        places = [str(path) for path in (self.folder / "venv" / "lib").glob("python*/site-packages")]
        found = [found.version for found in metadata.distributions(name=package, path=places)]
        return found[0] if found else ""

    def compile(self, source, target, libraries=()):
        command = ["gcc", "-O3", "-march=native", f"-I{self.folder}", "-o", target, HERE / "c" / source]
        return subprocess.run([*command, *(f"-l{name}" for name in libraries), "-lm"], capture_output=True, text=True)

    def compile_hand(self):
        subprocess.run([self.python, HERE / "c" / "stages.py", self.folder / "stages.h"], check=True)
        result = self.compile("dop853.c", self.dop853)
        if result.returncode != 0:
            sys.exit(result.stderr)

    def compile_sundials(self):
        result = self.compile("sundials.c", self.sundials, [f"sundials_{name}" for name in SUNDIALS])
        if result.returncode != 0:
            say("SUNDIALS is left out: its headers or libraries are not installed (Debian: libsundials-dev)")
            self.sundials = None

    def compile_ours(self):
        say("building our side")
        target = self.folder / "target"
        variables = dict(os.environ, RUSTFLAGS="-C target-cpu=native", CARGO_TARGET_DIR=str(target))
        command = ["cargo", "build", "--release", "--quiet", "--locked"]
        if subprocess.run(command, cwd=HERE / "dalembert", env=variables).returncode != 0:
            sys.exit("our side does not build")
        self.ours = target / "release" / "dalembert-peer"

    def describe(self):
        """Versions and the machine, kept with the results."""
        compilers = {
            name: subprocess.run([name, "--version"], capture_output=True, text=True).stdout.splitlines()[0]
            for name in ("gcc", "rustc")
        }
        packages = {name: self.version(name) for name in PACKAGES}
        return {"machine": platform.processor() or platform.machine(), "cores": os.cpu_count(), **compilers, **packages}

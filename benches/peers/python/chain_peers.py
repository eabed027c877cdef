"""W3b: the right-hand side of the chain of N unit masses on unit rods, by hand and from code generators.

python chain_peers.py W3b REPETITIONS FOLDER prints one line of JSON for each peer and N. Generated and compiled files
stay in FOLDER.
"""

import ctypes
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

SIZES = (2, 4, 8, 16, 32)
LARGEST_HEYOKA, LARGEST_SYMFORCE = 8, 16
STATES, BATCH = 64, 4096
EVALUATIONS = 1 << 17  # number of evaluations in one timing, times the number of links
GRAVITY = 9.81
HERE = Path(__file__).resolve().parent
LOOP = """
#include <time.h>
double nanoseconds(const double *states, int count, int times) {
    static double d[64];
    struct timespec a, b;
    clock_gettime(CLOCK_MONOTONIC, &a);
    for (int r = 0; r < times; r++)
        for (int k = 0; k < count; k++) {
            evaluate(states + k * WIDTH, d);
            __asm__ volatile("" ::"r"(d) : "memory");
        }
    clock_gettime(CLOCK_MONOTONIC, &b);
    return ((b.tv_sec - a.tv_sec) * 1e9 + (b.tv_nsec - a.tv_nsec)) / times / count;
}
"""


def states(n):
    random = np.random.default_rng(n)
    return np.ascontiguousarray(np.hstack([random.uniform(-2, 2, (STATES, n)), random.uniform(-1, 1, (STATES, n))]))


def times(n):
    return max(1, EVALUATIONS // n // STATES)


def acceleration(y):
    """Angular accelerations by a dense solve."""
    n = len(y) // 2
    theta, omega = y[:n], y[n:]
    carried = n - np.maximum.outer(np.arange(n), np.arange(n))
    difference = theta[:, None] - theta[None, :]
    weight = GRAVITY * (n - np.arange(n)) * np.sin(theta)
    return np.linalg.solve(carried * np.cos(difference), -((carried * np.sin(difference)) @ omega**2 + weight))


def worst(n, evaluate):
    """The largest error of an angular acceleration, relative to 1 plus the largest acceleration of its state."""
    errors = []
    for y in states(n):
        expected = acceleration(y)
        errors.append(np.max(np.abs(evaluate(y) - expected)) / (1 + np.max(np.abs(expected))))
    return max(errors)


def pointer(array):
    return np.ascontiguousarray(array).ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def library(compiler, source, extra=()):
    target = source.with_suffix(".so").name
    command = [compiler, "-O3", "-march=native", "-fPIC", "-shared", *extra, str(source), "-o", target, "-lm"]
    subprocess.run(command, check=True)
    loaded = ctypes.CDLL(str(Path(target).resolve()))
    loaded.nanoseconds.restype = ctypes.c_double
    return loaded


def from_library(n, loaded, prefix=()):
    """A function that evaluates the right-hand side of a library, and one that measures its time in nanoseconds."""
    y = states(n)

    def evaluate(state):
        rate = np.zeros(2 * n)
        loaded.evaluate(*prefix, pointer(state), pointer(rate))
        return rate[n:]

    return evaluate, lambda: loaded.nanoseconds(*prefix, pointer(y), STATES, times(n))


def by_hand():
    loaded = library("gcc", HERE.parent / "c" / "chain.c")
    for n in SIZES:
        for is_dense, peer in ((0, "hand-tensions"), (1, "hand-dense")):
            yield peer, n, *from_library(n, loaded, (is_dense, n))


def eliminated(n, theta, omega, sin, cos):
    """Angular accelerations as expressions of any algebra, by L D L^T written out."""
    s, c = [sin(angle) for angle in theta], [cos(angle) for angle in theta]
    a = [[(n - i) * (c[i] * c[j] + s[i] * s[j]) for j in range(i + 1)] for i in range(n)]
    b = []
    for i in range(n):
        r = -GRAVITY * (n - i) * s[i]
        for j in range(n):
            r = r - (n - max(i, j)) * (s[i] * c[j] - c[i] * s[j]) * omega[j] * omega[j]
        b.append(r)
    lower = [[None] * n for _ in range(n)]
    for j in range(n):
        for i in range(j + 1, n):
            lower[i][j] = a[i][j] / a[j][j]
        for i in range(j + 1, n):
            for k in range(j + 1, i + 1):
                a[i][k] = a[i][k] - lower[i][j] * a[k][j]
            b[i] = b[i] - lower[i][j] * b[j]
    x = [b[i] / a[i][i] for i in range(n)]
    for i in reversed(range(n)):
        for k in range(i + 1, n):
            x[i] = x[i] - lower[k][i] * x[k]
    return x


def by_casadi():
    import casadi

    for n in SIZES:
        y = casadi.SX.sym("y", 2 * n)
        mass, right = casadi.SX(n, n), casadi.SX(n, 1)
        for i in range(n):
            right[i] = -GRAVITY * (n - i) * casadi.sin(y[i])
            for j in range(n):
                carried = n - max(i, j)
                mass[i, j] = carried * casadi.cos(y[i] - y[j])
                right[i] -= carried * casadi.sin(y[i] - y[j]) * y[n + j] ** 2
        d, lower, order = casadi.ldl(mass)
        rate = casadi.vertcat(y[n:], casadi.ldl_solve(right, d, lower, order))
        casadi.Function("f", [y], [casadi.cse(rate)]).generate(f"casadi{n}.c")
        source = Path(f"casadi_timed{n}.c")
        call = "void evaluate(const double *y, double *d) { const double *a[] = {y}; double *r[] = {d}; f(a, r, 0, 0, 0); }"
        source.write_text(f'#define WIDTH {2 * n}\n#include "casadi{n}.c"\n{call}\n{LOOP}')
        yield "casadi", n, *from_library(n, library("gcc", source, ["-I."]))


def by_heyoka():
    import heyoka

    heyoka.set_nthreads(1)
    for n in (n for n in SIZES if n <= LARGEST_HEYOKA):
        variables = heyoka.make_vars(*(f"y{i}" for i in range(2 * n)))
        theta, omega = variables[:n], variables[n:]
        x = eliminated(n, theta, omega, heyoka.sin, heyoka.cos)
        compiled = heyoka.cfunc(list(omega) + x, variables)
        batch = np.ascontiguousarray(np.tile(states(n), (BATCH // STATES, 1)).T)
        rates = np.zeros_like(batch)

        def evaluate(y, compiled=compiled, n=n):
            return compiled(np.ascontiguousarray(y))[n:]

        def seconds(compiled=compiled, batch=batch, rates=rates):
            begin = time.perf_counter()
            compiled(batch, outputs=rates)
            return (time.perf_counter() - begin) / BATCH * 1e9

        yield "heyoka-batch", n, evaluate, seconds


def by_symforce():
    import symforce.symbolic as sf
    from symforce.codegen.backends.cpp.cpp_code_printer import CppCodePrinter

    for n in (n for n in SIZES if n <= LARGEST_SYMFORCE):
        y = [sf.Symbol(f"y{i}") for i in range(2 * n)]
        rate = y[n:] + eliminated(n, y[:n], y[n:], sf.sin, sf.cos)
        names = (sf.Symbol(f"_t{i}") for i in range(10**7))
        shared, outputs = sf.cse(list(sf.Matrix(rate)), symbols=names)
        text = CppCodePrinter().doprint
        lines = [f"const double y{i} = y[{i}];" for i in range(2 * n)]
        lines += [f"const double {name} = {text(value)};" for name, value in shared]
        lines += [f"d[{i}] = {text(value)};" for i, value in enumerate(outputs)]
        body = "\n".join(lines).replace("Scalar(", "double(").replace("<Scalar>", "<double>")
        source = Path(f"symforce{n}.cpp")
        function = f"void evaluate(const double *y, double *d) {{\n{body}\n}}"
        source.write_text(f'#include <cmath>\n#define WIDTH {2 * n}\nextern "C" {{\n{function}\n{LOOP}\n}}')
        yield "symforce", n, *from_library(n, library("g++", source))


def measure(repetitions):
    for peers in (by_hand, by_casadi, by_heyoka, by_symforce):
        try:
            for peer, n, evaluate, seconds in peers():
                least = min(seconds() for _ in range(repetitions))
                line = {"peer": peer, "work": "W3b", "n": n, "ns": least, "relerr": worst(n, evaluate)}
                print(json.dumps(line), flush=True)
        except (ImportError, AttributeError, subprocess.CalledProcessError) as error:
            print(f"{peers.__name__}: {error}", file=sys.stderr)


if __name__ == "__main__":
    folder = Path(sys.argv[3])
    folder.mkdir(parents=True, exist_ok=True)
    os.chdir(folder)
    measure(int(sys.argv[2]))

"""Solutions of the workloads with 34 digits, printed as JSON. `python reference.py > ../reference.json` takes minutes.

W1 and W5: arcs of circles between impacts, roots of the gaps with 60 digits. W2: speed, spin and angle in closed form,
x and y by quadrature. W2b: the same between impacts, Newton's method on the gaps. W3: Taylor series of heyoka with 160
bits; an extrapolated midpoint rule with 42 digits agrees with it at t = 10 to 19 digits. W4 needs no file: the n-th
bounce and the accumulation are sums of geometric series.
"""

import json
import sys

import mpmath as mp
import numpy as np
from mpmath import mpf

mp.mp.dps = 60
IMPACTS = 20
TRAJECTORIES, SAMPLES = 10_000, 10


def digits(values):
    return [mp.nstr(value, 34) for value in values]


class Disk:
    """The disk on its arc since the last impact."""

    m, R, I, J = mpf(25) / 10**4, mpf(1) / 100, mpf(125) / 10**9, mpf(625) / 10**10
    a, b = mpf(15) / 100, mpf(1) / 5
    SCAN = np.arange(1, 200_001) * 1e-4

    def __init__(self, roll):
        self.x = self.y = mpf(0)
        self.phi, self.roll, self.turn = mp.pi / 2, roll, mpf(1) / 5

    def place(self, t):
        phi, radius = self.phi + self.turn * t, self.R * self.roll / self.turn
        return (
            self.x + radius * (mp.sin(phi) - mp.sin(self.phi)),
            self.y - radius * (mp.cos(phi) - mp.cos(self.phi)),
            phi,
        )

    def gap(self, t, side):
        x, y, phi = self.place(t)
        reach = side * self.R
        return 1 - ((x + reach * mp.cos(phi)) / self.a) ** 2 - ((y + reach * mp.sin(phi)) / self.b) ** 2

    def scanned(self, side):
        """Index of the first time of the scan at which the gap is negative."""
        x, y, start, roll, turn = map(float, (self.x, self.y, self.phi, self.roll, self.turn))
        phi, radius, reach = start + turn * self.SCAN, 0.01 * roll / turn, side * 0.01
        x = x + radius * (np.sin(phi) - np.sin(start)) + reach * np.cos(phi)
        y = y - radius * (np.cos(phi) - np.cos(start)) + reach * np.sin(phi)
        negative = 1 - (x / 0.15) ** 2 - (y / 0.2) ** 2 < 0
        return int(np.argmax(negative)) if negative.any() else len(self.SCAN)

    def impact(self):
        """Time and side of the next impact."""
        first = {side: self.scanned(side) for side in (1, -1)}
        cell, roots = min(first.values()), []
        for side in (side for side in first if first[side] == cell):
            low, high = mpf(cell) / 10**4, mpf(cell + 1) / 10**4
            roots.append(
                (mp.findroot(lambda t: self.gap(t, side), (low, high), solver="anderson", tol=mpf(10) ** -60), side)
            )
        return min(roots)

    def bounce(self, t, side):
        self.x, self.y, self.phi = self.place(t)
        c, s, reach = mp.cos(self.phi), mp.sin(self.phi), side * self.R
        hx, hy = -2 * (self.x + reach * c) / self.a**2, -2 * (self.y + reach * s) / self.b**2
        hw, ho = self.R * (hx * c + hy * s), reach * (-s * hx + c * hy)
        nw, no = hw / (self.I + self.m * self.R**2), ho / self.J
        k = 2 * (hw * self.roll + ho * self.turn) / (hw * nw + ho * no)
        self.roll, self.turn = self.roll - k * nw, self.turn - k * no


def disk_impacts():
    disk, now, rows = Disk(mpf(10)), mpf(0), []
    for _ in range(IMPACTS):
        t, side = disk.impact()
        disk.bounce(t, side)
        now += t
        rows.append(digits((now, disk.x, disk.y)))
    return rows


def disk_end(k, until=mpf(10)):
    """The x of trajectory k of the ensemble at the time `until`."""
    disk, now = Disk(10 + mpf(5) / 1000 * (mpf(2 * k) / (TRAJECTORIES - 1) - 1)), mpf(0)
    while True:
        t, side = disk.impact()
        if now + t > until:
            return disk.place(until - now)[0]
        disk.bounce(t, side)
        now += t


class Sleigh:
    """The sleigh since the last impact: m = I = 1, a = 0.3."""

    a, inertia, reach = mpf(3) / 10, 1 + mpf(9) / 100, mpf(1) / 2

    def __init__(self, x, y, theta, v, spin):
        self.x, self.y, self.theta = x, y, theta
        self.top = mp.sqrt(v * v + self.inertia * spin * spin)
        self.rate = self.a * self.top / self.inertia
        self.most = self.top / mp.sqrt(self.inertia) * mp.sign(spin)
        self.late = -mp.atanh(v / self.top) / self.rate

    @staticmethod
    def angle(u):
        return 2 * mp.atan(mp.tanh(u / 2))

    def at(self, t):
        """Angle, speed and spin."""
        u = self.rate * (t - self.late)
        theta = self.theta + self.most / self.rate * (self.angle(u) - self.angle(-self.rate * self.late))
        return theta, self.top * mp.tanh(u), self.most / mp.cosh(u)

    def place(self, t, pieces):
        x = mp.quad(lambda z: self.at(z)[1] * mp.cos(self.at(z)[0]), pieces(t))
        y = mp.quad(lambda z: self.at(z)[1] * mp.sin(self.at(z)[0]), pieces(t))
        return self.x + x, self.y + y


def pieces_of(length):
    """Splits an interval from 0 for quadrature."""
    return lambda t: [length * k for k in range(int(mp.ceil(t / length)))] + [t]


def free_sleigh():
    sleigh, ends = Sleigh(mpf(0), mpf(0), mpf(0), mpf(-1), mpf(1) / 5), {}
    for t in (1, 10, 100, 1000):
        theta, v, spin = sleigh.at(mpf(t))
        x, y = sleigh.place(mpf(t), pieces_of(mpf(2)))
        ends[str(t)] = digits((x, y, theta, v * mp.cos(theta), v * mp.sin(theta), spin))
    return ends


def tip_gap(sleigh, t, side):
    """Gap of a tip, its rate, the state, and the derivatives of the gap along the blade and with respect to the angle."""
    x, y = sleigh.place(t, pieces_of(mpf(1) / 2))
    theta, v, spin = sleigh.at(t)
    c, s, reach = mp.cos(theta), mp.sin(theta), side * sleigh.reach
    hx, hy = -2 * (x + reach * c) / 9, -2 * (y + reach * s) / 16
    along, turning = hx * c + hy * s, reach * (-s * hx + c * hy)
    gap = 1 - ((x + reach * c) / 3) ** 2 - ((y + reach * s) / 4) ** 2
    return gap, along * v + turning * spin, (x, y, theta, v, spin), (along, turning)


def scanned_tip(sleigh, step=1e-4, until=40.0):
    """First time at which a gap is negative, and its tip. The position is found by the trapezoidal rule."""
    t = np.arange(0, until, step)
    top, rate, most, late, start = map(float, (sleigh.top, sleigh.rate, sleigh.most, sleigh.late, sleigh.theta))

    def angle(u):
        return 2 * np.arctan(np.tanh(u / 2))

    theta = start + most / rate * (angle(rate * (t - late)) - angle(-rate * late))
    v = top * np.tanh(rate * (t - late))

    def total(f):
        return np.concatenate([[0], np.cumsum((f[1:] + f[:-1]) * step / 2)])

    x, y = float(sleigh.x) + total(v * np.cos(theta)), float(sleigh.y) + total(v * np.sin(theta))
    found = []
    for side in (1, -1):
        reach = side * 0.5
        gap = 1 - ((x + reach * np.cos(theta)) / 3) ** 2 - ((y + reach * np.sin(theta)) / 4) ** 2
        negative = np.nonzero((gap < 0) & (np.arange(len(t)) > 4))[0]
        found += [(float(t[negative[0]]), side)] if len(negative) else []
    return min(found)


def sleigh_impacts():
    theta = mpf(3) / 10
    sleigh, now, rows = Sleigh(mpf(0), mpf(0), theta, mpf(1), mpf(1)), mpf(0), []
    for _ in range(IMPACTS):
        t, side = scanned_tip(sleigh)
        t = mpf(t)
        for _ in range(6):
            gap, rate, state, (along, turning) = tip_gap(sleigh, t, side)
            t -= gap / rate
            if abs(gap / rate) < mpf(10) ** -34:
                break
        x, y, theta, v, spin = state
        n_along, n_turning = along, turning / sleigh.inertia
        k = 2 * (along * v + turning * spin) / (along * n_along + turning * n_turning)
        sleigh = Sleigh(x, y, theta, v - k * n_along, spin - k * n_turning)
        now += t
        rows.append(digits((now, x, y)))
    return rows


def pendulum():
    import heyoka as hy

    bits = 160
    t1, t2, w1, w2 = hy.make_vars("t1", "t2", "w1", "w2")
    g = hy.expression(hy.real("9.81", bits))
    c, s = hy.cos(t1 - t2), hy.sin(t1 - t2)
    r1, r2 = -s * w2 * w2 - 2.0 * g * hy.sin(t1), s * w1 * w1 - g * hy.sin(t2)
    det = 2.0 - c * c
    rates = [(t1, w1), (t2, w2), (w1, (r1 - c * r2) / det), (w2, (2.0 * r2 - c * r1) / det)]
    start = [hy.real(value, bits) for value in ("2.0", "2.5", "0", "0")]
    series = hy.taylor_adaptive(rates, start, fp_type=hy.real, tol=hy.real("1e-40", bits), compact_mode=True)
    ends = {}
    for t in (1, 10, 20):
        series.propagate_until(hy.real(float(t), bits))
        ends[str(t)] = digits(mpf(str(value)) for value in series.state)
    return ends


if __name__ == "__main__":
    between = (TRAJECTORIES - 1) // (SAMPLES - 1)
    solutions = {
        "W1": disk_impacts(),
        "W5": digits(disk_end(k * between) for k in range(SAMPLES)),
    }
    mp.mp.dps = 40
    solutions |= {"W2": free_sleigh(), "W2b": sleigh_impacts(), "W3": pendulum()}
    json.dump(solutions, sys.stdout, indent=1)

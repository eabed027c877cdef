"""Ensembles: rows of the command line; the same bytes on any executor, after losses and interruptions; arguments that are refused."""

import csv
import gc
import io
import itertools
import json
import math
import multiprocessing
import os
import pickle
import signal
import threading
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor, ThreadPoolExecutor
from fractions import Fraction
from functools import partial

import numpy as np
import pytest
from conftest import BALL, Interrupted

import dalembert
from dalembert import EnsembleError, Normal, RequestError, _sweep, _units

#: Members whose runs differ in length, with some that cannot start.
VARY = {"x": (-0.5, 3.5, 9), "x_dot": (-1.0, 1.0, 14)}
FLAGS = ["--vary", "x=-0.5..3.5:9", "--vary", "x_dot=-1..1:14"]
#: With `fork`, a pool starts workers while others run. It may wait forever if a worker is lost meanwhile.
SPAWN = multiprocessing.get_context("spawn")
SMALL = {"unit": 0.001, "until": 6}
DENSITY = {"density": {"x_dot": (-3, 3), "x": (0, 4)}, "bins": 8, "every": 0.25}


def drops(vary=VARY, **arguments):
    return dalembert.models.bouncing_ball.ensemble(vary, **arguments)


def files(ensemble, tmp_path, name="rows.csv"):
    """Rows and summary as bytes."""
    ensemble.to_csv(tmp_path / name)
    return (tmp_path / name).read_bytes(), (ensemble.directory / "summary.json").read_bytes()


@pytest.mark.parametrize("integrator", ["dop853", "taylor"])
def test_rows_are_those_of_the_command(command, tmp_path, integrator):
    told = command("ensemble", "bouncing_ball", *FLAGS, "--until", "6", "--integrator", integrator, "--csv", "-")
    ensemble = drops(until=6, integrator=integrator)
    rows, _ = files(ensemble, tmp_path)
    refused = [number for number, row in enumerate(csv.DictReader(io.StringIO(told))) if row["outcome"] != "done"]
    assert rows.decode() == told and 0 < len(refused) < 126
    assert ensemble.outcomes == {"done": 126 - len(refused), "starts_inside": len(refused)}
    assert ensemble.not_reached[0][:2] == (0, "starts_inside")


def test_members_from_draws_and_tables_are_those_of_the_command(command, tmp_path):
    flags = ["--random", "7", "--members", "40", "--vary", "x=2+-0.1", "--vary", "g=1..3", "--until", "2", "--csv", "-"]
    told = command("ensemble", "bouncing_ball", *flags)
    drawn = drops({"x": Normal(2, 0.1), "g": (1, 3)}, members=40, seed=7, until=2)
    assert files(drawn, tmp_path)[0].decode() == told
    table = {"x": drawn["in.x"], "g": drawn["in.g"]}
    with ProcessPoolExecutor(2, SPAWN) as pool:
        listed = drops(None, table=table, until=2, executor=pool, unit=0.001)
    assert files(listed, tmp_path)[0].decode() == told
    listed = dalembert.models.bouncing_ball.with_parameters(g=2).ensemble({"x": [1, 2, 0.5]}, until=1)
    flags = ["--set", "g=2", "--vary", "x=1,2,0.5", "--until", "1", "--csv", "-"]
    assert files(listed, tmp_path)[0].decode() == command("ensemble", "bouncing_ball", *flags)


def test_settings_are_those_of_the_command(command, tmp_path):
    disk = dalembert.models.rolling_disk
    ensemble = disk.ensemble({"theta_dot": (9, 11, 5)}, impacts=3, tol=1e-8, law="elastic", state={"phi": 1.3}, form="global")
    flags = ["--vary", "theta_dot=9..11:5", "--impacts", "3", "--tol", "1e-8", "--law", "elastic", "--initial", "phi=1.3"]
    told = command("ensemble", "rolling_disk", *flags, "--form", "global", "--csv", "-")
    assert files(ensemble, tmp_path)[0].decode() == told
    assert set(ensemble.outcomes) == {"impact_budget"} and ensemble.not_reached == []


def test_densities_are_those_of_the_command(command):
    flags = ["--until", "6", "--density", "x_dot=-3..3,x=0..4:8", "--every", "0.25", "--json", "-"]
    told = json.loads(command("ensemble", "bouncing_ball", *FLAGS, *flags))
    density = drops(until=6, **DENSITY).density
    assert density.counts.tolist() == told["counts"] and density.outside == told["density_outside"]
    assert [dict(row) for row in density.convergence] == told["convergence"]
    assert density.counts.sum() == told["density_states"] and density.edges[1].tolist() == [0.5 * k for k in range(9)]
    # Ranges that are not given come from members of the whole ensemble, not of a unit.
    told = json.loads(command("ensemble", "bouncing_ball", *FLAGS, "--until", "6", "--density", "x,x_dot:5", "--json", "-"))
    with ThreadPoolExecutor(3) as pool:
        density = drops(until=6, density=("x", "x_dot"), bins=5, executor=pool, unit=0.001).density
    assert density.counts.tolist() == told["counts"]
    assert [list(edges[[0, -1]]) for edges in density.edges] == [axis["range"] for axis in told["density"]["axes"]]


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Rows and summary of one thread and one unit."""
    ensemble = drops(until=6, workers=1, unit=1000, **DENSITY)
    return files(ensemble, tmp_path_factory.mktemp("whole"))


@pytest.mark.parametrize("count", [1, 2, 3])
def test_bytes_do_not_depend_on_workers_and_units(whole, tmp_path, monkeypatch, count):
    monkeypatch.setattr(_units, "FIRST", 5 * count)
    assert files(drops(workers=count, directory=tmp_path / "kept", **SMALL, **DENSITY), tmp_path) == whole
    assert len(list((tmp_path / "kept").glob("part-*.parquet"))) > 5
    with ProcessPoolExecutor(count, SPAWN) as pool:
        assert files(drops(executor=pool, **SMALL, **DENSITY), tmp_path) == whole


def killed_once(path, call, *arguments):
    """A call whose first worker is killed, with a signal that it cannot handle."""
    try:
        with open(path, "x"):
            pass
    except FileExistsError:
        return call(*arguments)
    os.kill(os.getpid(), signal.SIGKILL)


class Deadly:
    """An executor whose first call kills its worker."""

    def __init__(self, inner, path):
        self.inner, self.path = inner, path
        self._max_workers = 2

    def submit(self, function, *arguments):
        return self.inner.submit(killed_once, self.path, function, *arguments)

    def shutdown(self, **arguments):
        self.inner.shutdown(**arguments)


def test_a_pool_of_processes_that_loses_a_worker_is_replaced(whole, tmp_path):
    made = []

    def pool():
        made.append(Deadly(ProcessPoolExecutor(2, SPAWN), tmp_path / "killed"))
        return made[-1]

    assert files(drops(executor=pool, **SMALL, **DENSITY), tmp_path) == whole
    assert len(made) == 2 and (tmp_path / "killed").exists()


def doomed(path):
    """Initializer of workers. The first worker that reaches its third unit is killed."""
    _sweep.run_unit = partial(killed_later, path, itertools.count(), _sweep.run_unit)


def killed_later(path, calls, call, *arguments):
    return call(*arguments) if next(calls) < 2 else killed_once(path, call, *arguments)


def test_a_given_pool_of_processes_is_replaced_by_one_like_it(whole, tmp_path):
    with ProcessPoolExecutor(2, SPAWN, doomed, (tmp_path / "killed",)) as pool:
        assert files(drops(executor=pool, **SMALL, **DENSITY), tmp_path) == whole
        assert (tmp_path / "killed").exists()
        with pytest.raises(BrokenExecutor):
            pool.submit(os.getpid).result()


def test_loky_replaces_a_pool_that_lost_a_worker(whole, tmp_path):
    loky = pytest.importorskip("loky", reason="loky is not installed: pip install './python[test]'")

    def pool():
        return Deadly(loky.get_reusable_executor(max_workers=2), tmp_path / "killed")

    assert files(drops(executor=pool, **SMALL, **DENSITY), tmp_path) == whole
    assert (tmp_path / "killed").exists()


def test_jobs_of_submitit_are_units(tmp_path):
    submitit = pytest.importorskip("submitit", reason="submitit is not installed: pip install './python[test]'")
    executor = submitit.AutoExecutor(folder=tmp_path / "log", cluster="local")
    jobs = drops({"x": (1.0, 2.0, 3)}, until=3, executor=executor, workers=1)
    assert files(jobs, tmp_path) == files(drops({"x": (1.0, 2.0, 3)}, until=3), tmp_path)


def test_a_worker_of_dask_that_is_killed_costs_its_unit(whole, tmp_path):
    distributed = pytest.importorskip("distributed", reason="dask.distributed is not installed: pip install './python[test]'")
    arguments = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with distributed.LocalCluster(**arguments) as cluster, distributed.Client(cluster) as client:
        executor = client.get_executor()
        assert _units.workers_of(executor) == 2
        assert files(drops(executor=executor, **SMALL, **DENSITY), tmp_path) == whole
        deadly = Deadly(executor, str(tmp_path / "killed"))
        assert files(drops(executor=deadly, **SMALL, **DENSITY), tmp_path) == whole
        assert (tmp_path / "killed").exists()


def test_a_worker_of_ray_that_is_killed_costs_its_unit(whole, tmp_path):
    ray = pytest.importorskip("ray", reason="ray is not installed: pip install './python[test]'")
    from dalembert.ray import RayExecutor

    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, configure_logging=False)
    try:
        executor = RayExecutor(runtime_env={"env_vars": {"PYTHONPATH": os.path.dirname(__file__)}})
        assert _units.workers_of(executor) == 2
        assert files(drops(executor=executor, **SMALL, **DENSITY), tmp_path) == whole
        deadly = Deadly(executor, str(tmp_path / "killed"))
        assert files(drops(executor=deadly, **SMALL, **DENSITY), tmp_path) == whole
        assert (tmp_path / "killed").exists()
        with pytest.raises(EnsembleError, match="ZeroDivisionError"):
            drops(executor=Raising(executor), unit=0.001, until=6)
    finally:
        ray.shutdown()


def failing(*_):
    return 1 / 0


class Raising:
    """An executor whose calls fail."""

    def __init__(self, inner):
        self.inner = inner

    def submit(self, function, *arguments):
        return self.inner.submit(failing, *arguments)


class Job:
    """A future without the protocol of `concurrent.futures.wait`, as those of submitit."""

    def __init__(self, call):
        self.call, self.asked = call, 0

    def done(self):
        self.asked += 1
        return self.asked > 1

    def result(self):
        return self.call()

    def cancel(self):
        return False


class KilledWorker(Exception):
    """An error with the name that dask uses."""


class Lossy:
    """An executor of jobs, some of which are lost."""

    def __init__(self, losses):
        self.left = losses

    def submit(self, function, *arguments):
        def call():
            if self.left > 0:
                self.left -= 1
                raise KilledWorker("lost")
            return pickle.loads(pickle.dumps(function(*pickle.loads(pickle.dumps(arguments)))))

        return Job(call)


def test_executors_without_waiting_are_asked(whole, tmp_path):
    assert files(drops(executor=Lossy(0), workers=2, **SMALL, **DENSITY), tmp_path) == whole
    assert files(drops(executor=Lossy(3), workers=2, **SMALL, **DENSITY), tmp_path) == whole


def test_losses_are_bounded_and_parts_are_kept(whole, tmp_path):
    with pytest.raises(EnsembleError, match="members 0 to 0: 3 workers were lost with these members, the last by KilledWorker"):
        drops({"x": [1.0]}, executor=Lossy(1000), workers=1, retries=2, until=6)

    class Failing(Lossy):
        def submit(self, function, *arguments):
            self.left -= 1
            if self.left < 0:
                return Job(lambda: 1 / 0)
            return Job(lambda: function(*arguments))

    arguments = {"directory": tmp_path / "kept", **SMALL, **DENSITY}
    with pytest.raises(EnsembleError, match="members .*: ZeroDivisionError"):
        drops(executor=Failing(3), workers=1, **arguments)
    kept = sorted((tmp_path / "kept").glob("part-*.parquet"))
    assert 1 <= len(kept) <= 3
    with pytest.raises(RequestError, match="not complete"):
        dalembert.Ensemble.open(tmp_path / "kept")
    before = {path: path.stat().st_mtime_ns for path in kept}
    assert files(drops(**arguments), tmp_path) == whole
    assert {path: path.stat().st_mtime_ns for path in kept} == before
    assert files(dalembert.Ensemble.open(tmp_path / "kept"), tmp_path) == whole


def test_an_executor_that_broke_and_cannot_be_replaced_says_what_to_give():
    class Broken:
        def submit(self, function, *arguments):
            raise BrokenExecutor("all gone")

    with pytest.raises(EnsembleError, match="all gone; give a function that makes one"):
        drops(executor=Broken())
    with pytest.raises(EnsembleError, match="3 workers were lost with these members, the last by BrokenExecutor: all gone"):
        drops(executor=lambda: Broken(), retries=2, workers=1)


def test_an_interruption_keeps_what_is_done(whole, tmp_path):
    arguments = {"directory": tmp_path / "kept", **SMALL, **DENSITY}
    with pytest.raises(KeyboardInterrupt):
        drops(executor=lambda: Interrupted(), **arguments)
    # A part whose last file is missing was interrupted.
    parts = sorted((tmp_path / "kept").glob("part-*.json"))
    if parts:
        parts[0].unlink()
    (tmp_path / "kept" / "part-000000000000.parquet.new").write_text("torn")
    assert files(drops(**arguments), tmp_path) == whole


def test_long_units_end_soon_after_they_are_stopped():
    spec = _sweep._request(dalembert.models.rolling_disk, {"until": 1e9}) | {
        "varied": {"values": [("theta_dot", "list", [10.0])], "seed": None, "count": 1}, "density": None,
    }
    native = _sweep._built(dalembert.models.rolling_disk, spec, None, 0)
    threading.Timer(0.1, native.stop).start()
    with pytest.raises(RequestError, match="stopped"):
        native.run(0, 1, math.inf)


def test_a_unit_whose_time_is_over_leaves_its_other_members():
    spec = _sweep._request(dalembert.models.bouncing_ball, {"until": 6}) | {
        "varied": {"values": [("x", "spaced", [1.0, 2.0, 50])], "seed": None, "count": 50}, "density": None,
    }
    native = _sweep._built(dalembert.models.bouncing_ball, spec, None, 0)
    assert [native.run(7, 50, seconds)["members"] for seconds in (0.0, math.inf)] == [1, 43]


def test_statistics_are_those_of_exact_sums(tmp_path):
    ensemble = drops(until=6)
    # Members that start behind the floor do not move, and do not count.
    moved = zip(ensemble["outcome"], ensemble["energy"])
    energies = [Fraction(value) for outcome, value in moved if outcome != "starts_inside"]
    mean = sum(energies) / len(energies)
    variance = sum((energy - mean) ** 2 for energy in energies) / (len(energies) - 1)
    told = ensemble.statistics["energy"]
    assert (told.count, told.mean, told.std) == (len(energies), float(mean), math.sqrt(float(variance)))
    assert (told.least, told.greatest) == (float(min(energies)), float(max(energies)))
    has_moved = ensemble["outcome"] != "starts_inside"
    assert ensemble.statistics["impacts.floor"].mean == np.mean(ensemble["impacts.floor"][has_moved])
    assert math.isnan(drops({"x": [1.0]}, until=1).statistics["energy"].std)
    table = ensemble.to_pandas()
    assert list(table.columns) == list(ensemble.columns) and len(table) == len(ensemble) == 126
    for name in ["member", "outcome", "end.x", "rejected", "reason"]:
        np.testing.assert_array_equal(table[name].to_numpy(), ensemble[name], name)
    with pytest.raises(KeyError, match="`end.z` is no column; accepted: member, in.x"):
        ensemble["end.z"]
    assert repr(ensemble).startswith("<126 members of bouncing_ball: done ")


def test_directories_that_are_not_this_ensemble_are_refused(tmp_path):
    kept = tmp_path / "kept"
    drops({"x": (1, 2, 4)}, until=1, directory=kept)
    with pytest.raises(RequestError, match="holds another ensemble: request was .*give the same arguments"):
        drops({"x": (1, 2, 4)}, until=2, directory=kept)
    with pytest.raises(RequestError, match="holds another ensemble: parameters"):
        dalembert.models.bouncing_ball.with_parameters(g=3).ensemble({"x": (1, 2, 4)}, until=1, directory=kept)
    with pytest.raises(RequestError, match="holds other files and no manifest.json"):
        drops({"x": (1, 2, 4)}, until=1, directory=tmp_path)
    with pytest.raises(RequestError, match="manifest.json is missing"):
        dalembert.Ensemble.open(tmp_path)
    held = _sweep.Directory(kept)
    held.begin(held.manifest())
    with pytest.raises(RequestError, match="another run is writing"):
        drops({"x": (1, 2, 4)}, until=1, directory=kept)
    held.close()
    part = kept / "part-000000000000.parquet"
    part.write_bytes(part.read_bytes().replace(b"done", b"gone", 1))
    for again in [lambda: dalembert.Ensemble.open(kept), lambda: drops({"x": (1, 2, 4)}, until=1, directory=kept)]:
        with pytest.raises(EnsembleError, match="altered or lost.*remove part-000000000000.json"):
            again()


REFUSED = {
    "unknown coordinate, velocity or parameter `z`": {"vary": {"z": [1.0]}},
    "low, high, count": {"vary": {"x": 1.0}},
    "positive whole number": {"vary": {"x": (1, 2, 0)}},
    "and members=": {"vary": {"x": (1, 2)}},
    "finite numbers": {"vary": {"x": [math.nan]}},
    "or a seed= to draw with": {"vary": {"x": Normal(1, 2)}},
    "deviation that is not negative": {"vary": {"x": Normal(1, -2)}, "seed": 1, "members": 2},
    "as members are drawn": {"vary": {"x": [1.0]}, "seed": 1, "members": 2},
    "seed: it needs members= and vary=": {"vary": {"x": (1, 2)}, "seed": 1},
    "seed: -1 is not": {"vary": {"x": (1, 2)}, "seed": -1, "members": 2},
    "expected 6, the product": {"vary": {"x": (1, 2, 3), "g": [1, 2]}, "members": 5},
    "all members are equal": {"members": 5},
    "members: 0 is not": {"vary": {"x": (1, 2)}, "members": 0},
    "table: its rows": {"table": {"x": [1.0]}, "vary": {"g": [1.0]}},
    "columns of one length": {"table": {"x": [1.0], "g": [1.0, 2.0]}},
    "table: expected finite": {"table": {"x": [math.inf]}},
    "until: -1": {"vary": {"x": [1.0]}, "until": -1},
    "no usable `until`": {"vary": {"x": [1.0]}},
    "expected two quantities": {"vary": {"x": [1.0]}, "density": "x"},
    "density: unknown": {"vary": {"x": [1.0]}, "density": ("x", "z"), "until": 3},
    "low below high": {"vary": {"x": [1.0]}, "density": {"x": (1, 0), "x_dot": None}},
    "bins: 0": {"vary": {"x": [1.0]}, "density": ("x", "x_dot"), "bins": 0},
    "bins: 1001": {"vary": {"x": [1.0]}, "density": ("x", "x_dot"), "bins": 1001, "until": 3},
    "every: 0": {"vary": {"x": [1.0]}, "density": ("x", "x_dot"), "every": 0},
    "discard: -1": {"vary": {"x": [1.0]}, "density": ("x", "x_dot"), "discard": -1},
    "first counted state": {"vary": {"x": [1.0]}, "density": ("x", "x_dot"), "until": 0.5},
    "unit: 0": {"vary": {"x": [1.0]}, "unit": 0},
    "retries: -1": {"vary": {"x": [1.0]}, "retries": -1},
    "workers: 0": {"vary": {"x": [1.0]}, "workers": 0},
    "unknown input": {"vary": {"x": [1.0]}, "inputs": {"u": 1}},
    "give qdot": {"vary": {"x_dot": [1.0]}, "q": [1], "p": [1], "until": 1},
}


@pytest.mark.parametrize("told", REFUSED)
def test_arguments_that_are_refused_are_named(told):
    ball = dalembert.Model.from_text(BALL.replace("until = 1;", "")) if "usable" in told else dalembert.models.bouncing_ball
    with pytest.raises(RequestError) as refused:
        ball.ensemble(**REFUSED[told])
    assert told in str(refused.value)


def test_arguments_of_runs_alone_are_refused():
    with pytest.raises(TypeError, match="no argument `samples`; accepted for all members: until"):
        drops({"x": [1.0]}, samples=3)
    with pytest.raises(RequestError, match="inputs: members take numbers alone"):
        driven = dalembert.Model.from_text("Cart { coordinates { x; } inputs { u; } lagrangian = dot(x)^2/2; forces { push: u*d(x); } }")
        driven.ensemble({"x": [1.0]}, until=1, inputs={"u": lambda t, q, qdot: 0.0})
    with pytest.raises(RequestError, match="parameter `k` has no default; .* or vary it"):
        dalembert.Model.from_text("Bare { coordinates { x; } parameters { k > 0; } lagrangian = dot(x)^2/2 - k*x^2/2; }").ensemble(
            {"x": [1.0]}, until=1,
        )


def test_inputs_and_parameters_without_default_reach_the_members():
    text = "Cart { coordinates { x; } parameters { k > 0; } inputs { u; } lagrangian = dot(x)^2/2*k; forces { push: u*d(x); } }"
    driven = dalembert.Model.from_text(text).ensemble({"k": [1.0, 2.0]}, until=2, inputs={"u": 1.0}, state={"x": 0, "x_dot": 0})
    np.testing.assert_allclose(driven["end.x"], [2.0, 1.0], rtol=1e-12)


def test_models_are_pickled_with_scene_and_parameters():
    model = dalembert.models.rolling_disk.with_parameters(ta=0.3)
    for one in [model, model.scene(model.scenes[1])]:
        again = pickle.loads(pickle.dumps(one))
        assert (again._scene, dict(again.parameters)) == (one._scene, dict(one.parameters))
        np.testing.assert_array_equal(again.simulate(until=2).q, one.simulate(until=2).q)


def test_workers_with_another_version_are_refused():
    with pytest.raises(EnsembleError, match="the worker has dalembert .*, and the driver 0.0.1; install the same"):
        _sweep.run_unit(b"", 0, 1, 1.0, None, 0, "0.0.1")


def test_a_thousand_small_units_keep_their_order():
    """The sizes of units follow the measured pace, and towards the end the share of a worker."""
    units = _units.Units(Lossy(0), lambda unit, longest: (dict, ({"members": unit.last - unit.first, "seconds": 1e-3},)), [(0, 5000)],
                         _units.Plan(0.002, 0, 1))
    sizes = {first: result["members"] for first, result in units.results()}
    assert sum(sizes.values()) == 5000 and max(sizes.values()) > _units.FIRST and sizes[max(sizes)] == 1


def test_temporary_directories_go_with_their_ensemble():
    ensemble = drops({"x": [1.0]}, until=1)
    path = ensemble.directory
    assert path.exists()
    del ensemble
    gc.collect()
    assert not path.exists()


def test_members_that_a_unit_leaves_are_run_by_others():
    def halves(unit, longest):
        return dict, ({"members": -(-(unit.last - unit.first) // 2), "seconds": 1e-3},)

    units = _units.Units(Lossy(0), halves, [(3, 40), (50, 99)], _units.Plan(0.01, 0, 2))
    found = sorted((first, first + result["members"]) for first, result in units.results())
    members = [member for first, last in found for member in range(first, last)]
    assert members == [*range(3, 40), *range(50, 99)]

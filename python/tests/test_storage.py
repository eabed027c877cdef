"""Where ensembles are kept: files that other programs read; stores of objects, with their locks, interruptions and refusals."""

import json
import os
import platform
import subprocess
import sys

import numpy as np
import pytest
from conftest import Interrupted

import dalembert
from dalembert import EnsembleError, RequestError, _parts, _storage

VARY = {"x": (-0.5, 3.5, 40)}
SMALL = {"until": 3, "unit": 0.001}
#: Packages of the tests.
MISSING = "{} is not installed: pip install './python[test]'"


def drops(**arguments):
    return dalembert.models.bouncing_ball.ensemble(VARY, **SMALL, **arguments)


def rows(ensemble, tmp_path):
    ensemble.to_csv(tmp_path / "rows.csv")
    return (tmp_path / "rows.csv").read_bytes()


def test_parts_are_files_that_other_programs_read(tmp_path):
    pandas = pytest.importorskip("pandas", reason=MISSING.format("pandas"))
    pytest.importorskip("pyarrow", reason=MISSING.format("pyarrow"))
    ensemble = drops(directory=tmp_path / "kept")
    parts = sorted((tmp_path / "kept").glob("part-*.parquet"))
    table = pandas.concat([pandas.read_parquet(part) for part in parts], ignore_index=True)
    assert len(parts) > 1 and tuple(table.columns) == ensemble.columns
    for name in ensemble.columns:
        np.testing.assert_array_equal(table[name].to_numpy(), ensemble[name], name)


@pytest.fixture
def memory():
    return pytest.importorskip("obstore", reason=MISSING.format("obstore")).store.MemoryStore()


@pytest.fixture(scope="module")
def bucket():
    """The address of an empty bucket, and the settings with which a server of this machine is asked for it."""
    pytest.importorskip("obstore", reason=MISSING.format("obstore"))
    server = pytest.importorskip("moto.server", reason=MISSING.format("moto")).ThreadedMotoServer(port=0, verbose=False)
    server.start()
    host, port = server.get_host_and_port()
    import boto3

    keys = {"aws_access_key_id": "testing", "aws_secret_access_key": "testing", "region_name": "us-east-1"}
    boto3.client("s3", endpoint_url=f"http://{host}:{port}", **keys).create_bucket(Bucket="motions")
    settings = {
        "AWS_ENDPOINT_URL": f"http://{host}:{port}", "AWS_ALLOW_HTTP": "true", "AWS_ACCESS_KEY_ID": "testing",
        "AWS_SECRET_ACCESS_KEY": "testing", "AWS_REGION": "us-east-1",
    }
    yield "s3://motions", settings
    server.stop()


def test_a_bucket_of_s3_is_a_directory(bucket, monkeypatch, tmp_path):
    address, settings = bucket
    for name, value in settings.items():
        monkeypatch.setenv(name, value)
    kept = drops(directory=f"{address}/balls/today", density=("x", "x_dot"), every=0.5)
    here = drops(directory=tmp_path / "here", density=("x", "x_dot"), every=0.5)
    assert kept.directory == f"{address}/balls/today"
    again = dalembert.Ensemble.open(f"{address}/balls/today")
    assert rows(again, tmp_path) == rows(kept, tmp_path) == rows(here, tmp_path)
    assert again.statistics == here.statistics
    np.testing.assert_array_equal(again.density.counts, here.density.counts)
    # The lock of a run that goes on is created once.
    held = _parts.Directory(f"{address}/balls/today")
    held.begin(held.manifest())
    with pytest.raises(RequestError, match="another run is writing `s3://motions/balls/today`: process .*; if it has ended, delete lock"):
        _parts.Directory(f"{address}/balls/today").begin(held.manifest())
    held.close()
    _parts.Directory(f"{address}/balls/today").begin(held.manifest())


def test_an_interrupted_ensemble_in_a_store_goes_on(memory, tmp_path):
    with pytest.raises(KeyboardInterrupt):
        drops(directory=memory, executor=lambda: Interrupted())
    store = _storage.storage(memory)
    kept = {name: store.read(name) for name in store.names()}
    assert "summary.json" not in kept and _storage.LOCK not in kept
    assert rows(drops(directory=memory), tmp_path) == rows(drops(), tmp_path)
    assert all(store.read(name) == content for name, content in kept.items())
    with pytest.raises(RequestError, match="holds another ensemble: request was"):
        dalembert.models.bouncing_ball.ensemble(VARY, until=4, directory=memory)
    part = next(name for name in store.names() if name.endswith(".parquet"))
    store.write(part, store.read(part).replace(b"done", b"gone", 1))
    with pytest.raises(EnsembleError, match=f"{part} was altered or lost after it was written; remove part-.*json"):
        dalembert.Ensemble.open(memory)


def test_the_lock_of_a_process_that_has_ended_is_taken_over(memory, tmp_path):
    ended = subprocess.run([sys.executable, "-c", "import os; print(os.getpid())"], capture_output=True, check=True, text=True)
    store = _storage.storage(memory)

    def lock(host, process):
        store.write(_storage.LOCK, json.dumps({"host": host, "process": process, "since": "2026-01-01T00:00:00Z"}).encode())

    lock(platform.node(), int(ended.stdout))
    assert len(drops(directory=memory)) == 40
    for host, process in [("elsewhere", int(ended.stdout)), (platform.node(), os.getpid())]:
        lock(host, process)
        with pytest.raises(RequestError, match=f"process {process} on {host}, since 2026-01-01T00:00:00Z"):
            drops(directory=memory)


def test_addresses_that_are_not_accepted_are_named(monkeypatch):
    pytest.importorskip("obstore", reason=MISSING.format("obstore"))
    with pytest.raises(RequestError, match="directory: `gopher://motions/balls` is not accepted"):
        drops(directory="gopher://motions/balls")
    monkeypatch.setitem(sys.modules, "obstore.store", None)
    with pytest.raises(RequestError, match="directory: `s3://motions` needs the package obstore: pip install obstore"):
        drops(directory="s3://motions")

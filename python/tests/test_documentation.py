"""The Python that the documentation shows is run."""

import doctest
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import SLEIGH

import dalembert
import dalembert._ensemble
import dalembert._model
import dalembert._run

ROOT = Path(__file__).parents[2]
SKATE = re.search(r"```text\n(/// Skate on an incline.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)


#: Blocks that begin with the name of a file are programs of their own.
PROGRAM = re.compile(r"# (\w+)\.py\n")


def blocks_of(page):
    return re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.parametrize("page", ["README.md", "python/README.md", "docs/python.md", "docs/guide/cluster.md", "docs/guide/gradients.md"])
def test_blocks_of_python_run_as_they_are(page, tmp_path, monkeypatch, capsys):
    matplotlib = pytest.importorskip("matplotlib")
    pytest.importorskip("pandas")
    pytest.importorskip("obstore")
    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    Path("skate.dal").write_text(SKATE.group(1), encoding="utf-8")
    blocks = [block for block in blocks_of(page) if not PROGRAM.match(block)]
    assert blocks
    names = {"sleigh": SLEIGH}
    for block in blocks:
        exec(compile(block, page, "exec"), names)


#: Programs of the page, with the packages that they need, and how they are started.
PROGRAMS = {
    "processes": (None, []), "dask_cluster": ("distributed", []), "ray_cluster": ("ray", []),
    "mpi": ("mpi4py", ["-m", "mpi4py.futures"]),
}


@pytest.mark.parametrize("name", PROGRAMS)
def test_programs_for_clusters_run_as_they_are(name, tmp_path):
    package, flags = PROGRAMS[name]
    if package is not None:
        pytest.importorskip(package, reason=f"{package} is not installed: the program {name}.py of docs/guide/cluster.md needs it")
    programs = {found.group(1): block for block in blocks_of("docs/guide/cluster.md") if (found := PROGRAM.match(block))}
    assert set(PROGRAMS) <= set(programs)
    (tmp_path / f"{name}.py").write_text(programs[name], encoding="utf-8")
    start = []
    if name == "mpi":
        # The program of the package `mpich`, or that of the system.
        mpiexec = shutil.which("mpiexec", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
        if mpiexec is None:
            pytest.skip("mpiexec is not on the path: the program mpi.py of docs/guide/cluster.md needs it")
        start = [mpiexec, "-n", "2"]
    done = subprocess.run([*start, sys.executable, *flags, f"{name}.py"], cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "<200 members of rolling_disk: done 200>"
    (directory,) = (path for path in tmp_path.iterdir() if path.is_dir())
    inside = dalembert.models.rolling_disk.ensemble({"theta_dot": (9, 11)}, members=200, until=10)
    assert (directory / "summary.json").read_bytes() == (inside.directory / "summary.json").read_bytes()


def test_counterexamples_are_those_of_the_documentation():
    told = re.search(r"error\.counterexample +# (\{.*\})", (ROOT / "docs/python.md").read_text(encoding="utf-8")).group(1)
    with pytest.raises(dalembert.ModelError) as refused:
        dalembert.Model.from_text(SLEIGH)
    assert refused.value.counterexample == eval(told)


@pytest.mark.parametrize("module", [dalembert, dalembert._ensemble, dalembert._model, dalembert._run])
def test_examples_of_doc_comments(module):
    failed, tried = doctest.testmod(module)
    assert tried > 0 and failed == 0

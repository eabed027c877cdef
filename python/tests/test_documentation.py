"""The Python that the documentation shows is run."""

import doctest
import re
from pathlib import Path

import pytest
from conftest import SLEIGH

import dalembert
import dalembert._model
import dalembert._run

ROOT = Path(__file__).parents[2]
SKATE = re.search(r"```text\n(/// Skate on an incline.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.parametrize("page", ["README.md", "docs/python.md"])
def test_blocks_of_python_run_as_they_are(page, tmp_path, monkeypatch, capsys):
    matplotlib = pytest.importorskip("matplotlib")
    pytest.importorskip("pandas")
    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    Path("skate.dal").write_text(SKATE.group(1), encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(encoding="utf-8"), re.DOTALL)
    assert blocks
    names = {"sleigh": SLEIGH}
    for block in blocks:
        exec(compile(block, page, "exec"), names)


def test_counterexamples_are_those_of_the_documentation():
    told = re.search(r"error\.counterexample +# (\{.*\})", (ROOT / "docs/python.md").read_text(encoding="utf-8")).group(1)
    with pytest.raises(dalembert.ModelError) as refused:
        dalembert.Model.from_text(SLEIGH)
    assert refused.value.counterexample == eval(told)


@pytest.mark.parametrize("module", [dalembert, dalembert._model, dalembert._run])
def test_examples_of_doc_comments(module):
    failed, tried = doctest.testmod(module)
    assert tried > 0 and failed == 0

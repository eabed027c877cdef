"""Docstrings of everything public have the form of numpydoc, and stubs have what the extension module has."""

import ast
import importlib
import inspect
import operator
import re
from pathlib import Path

import pytest

import dalembert
from dalembert import _native

HEADINGS = {"Parameters", "Attributes", "Returns", "Yields", "Raises", "Examples", "Notes"}


def public():
    """Public functions and methods, with their names."""
    found = []
    for name in dalembert.__all__:
        item = getattr(dalembert, name)
        if inspect.ismodule(item):
            found += [(f"{name}.{key}", value) for key, value in vars(item).items() if inspect.isfunction(value) and key[0] != "_"]
        elif inspect.isclass(item):
            found.append((name, item))
            for key, value in inspect.getmembers(item, callable):
                value = getattr(value, "__func__", value)
                if inspect.isfunction(value) and key[0] != "_" and value.__module__.startswith("dalembert"):
                    found.append((f"{name}.{key}", value))
    for name, key in (("jax", "final_state"), ("torch", "final_state"), ("ray", "RayExecutor"), ("ray", "RayExecutor.submit")):
        try:
            module = importlib.import_module(f"dalembert.{name}")
        except ImportError:
            continue
        found.append((f"{name}.{key}", operator.attrgetter(key)(module)))
    return found


def sections(text):
    """Sections of a docstring: headings with the text below."""
    parts = re.split(r"^(\w+)\n-+\n", text, flags=re.MULTILINE)
    return parts[0], dict(zip(parts[1::2], parts[2::2]))


def documented(section):
    """Names that a section describes; a line may have several."""
    lines = [line for line in section.splitlines() if line and not line.startswith(" ")]
    return [name.strip().lstrip("*") for line in lines for name in line.split(" : ")[0].split(",")]


@pytest.mark.parametrize(("name", "item"), public(), ids=[name for name, _ in public()])
def test_docstrings_have_the_form_of_numpydoc(name, item):
    text = inspect.getdoc(item)
    assert text, name
    summary, parts = sections(text)
    assert summary.split("\n\n")[0].strip().endswith((".", ":")), summary
    assert set(parts) <= HEADINGS
    if inspect.isclass(item):
        return
    signature = inspect.signature(item)
    given = [parameter for parameter in signature.parameters if parameter not in ("self", "cls")]
    assert documented(parts.get("Parameters", "")) == given
    returns = signature.return_annotation not in ("None", None, inspect.Signature.empty)
    assert ("Returns" in parts) == returns, "Returns"


def test_stubs_have_what_the_module_has():
    tree = ast.parse((Path(dalembert.__file__).parent / "_native.pyi").read_text(encoding="utf-8"))
    told = {}
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            told[node.name] = None
        elif isinstance(node, ast.ClassDef):
            names = [item.name if isinstance(item, ast.FunctionDef) else item.target.id for item in node.body]
            told[node.name] = sorted(name for name in names if name[0] != "_")
    there = {}
    for name, value in vars(_native).items():
        if not name.startswith("_"):
            is_class = inspect.isclass(value)
            there[name] = sorted(key for key in vars(value) if key[0] != "_") if is_class else None
    assert told == there

"""Models for other programs: a C header, functions of CasADi."""

from __future__ import annotations

import operator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Mapping, Sequence

from . import _native
from ._errors import RequestError

if TYPE_CHECKING:
    import os

    import casadi

    from ._model import Model

#: Operations that modules do not offer as functions with the names in C.
SIGNS = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv, "neg": operator.neg, "pow": operator.pow,
}


def to_c(model: Model, path: str | os.PathLike[str] | None) -> str:
    """The model as a C header: see :meth:`Model.to_c`."""
    text = _native.to_c(model.source, _scene(model, None))
    if path is not None:
        Path(path).write_text(text, encoding="utf-8")
    return text


def to_casadi(model: Model, name: str, scene: str | None) -> casadi.Function:
    """A function of the model: see :meth:`Model.to_casadi`."""
    import casadi

    parts = _native.lines(model.source, _scene(model, scene))
    if len(parts) > 1:
        raise RequestError(f"`{model.name}` has modes; say which one by scene=: {', '.join(model.modes)}")
    [part] = parts
    if name not in part["routines"]:
        raise RequestError(f"`{part['name']}` has no function `{name}`\n  accepted: {', '.join(part['routines'])}")
    n, size = len(part["coordinates"]), len(part["coordinates"]) + len(part["motion"])
    of_state = part["routines"][name][0]
    arguments = {
        "t": casadi.SX.sym("t"), "s": casadi.SX.sym("s", size if of_state else n), "v": casadi.SX.sym("v", n),
        "k": casadi.SX.sym("k", len(part["parameters"])),
    }
    known = {kind: casadi.vertsplit(symbol) if symbol.numel() else [] for kind, symbol in arguments.items()}
    if of_state:
        known["v"] = results(casadi, part["routines"]["velocity"], known) if "velocity" in part["routines"] else []
    outputs = casadi.vertcat(*results(casadi, part["routines"][name], known))
    taken = {"t": "t", "s": "s", "k": "k"} if of_state else {"t": "t", "s": "q", "v": "v", "k": "k"}
    symbols = [arguments[kind] for kind in taken]
    return casadi.Function(f"{part['name']}_{name}", symbols, [outputs], list(taken.values()), [name])


def results(module: Any, routine: Sequence[Any], known: Mapping[str, Sequence[Any]]) -> list[Any]:
    """The results of a function of a model, over the numbers of a module that has the functions of C, such as CasADi."""
    _, lines, outputs, _ = routine
    values: dict[int, Any] = {}

    def operand(kind: str, number: Any) -> Any:
        if kind == "number":
            return number
        return values[number] if kind == "value" else known[kind][number]

    for line in lines:
        if line is not None:
            value, operation, operands = line
            function = SIGNS.get(operation) or getattr(module, operation)
            values[value] = function(*(operand(*item) for item in operands))
    return [operand(*item) for item in outputs]


def _scene(model: Model, scene: str | None) -> str | None:
    scene = model._scene if scene is None else scene
    return None if scene == "all" else scene

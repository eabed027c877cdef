"""Nonholonomic mechanics with impacts: declared models, checked equations, events located to rounding.

>>> import dalembert
>>> disk = dalembert.models.rolling_disk
>>> run = disk.simulate(until=20, state={"theta_dot": 12})
>>> run.outcome.kind, len(run.events)
('done', 16)

A model comes from a text of the language (:meth:`Model.from_text`), from a file (:meth:`Model.from_file`), or is one of the
shipped ones (:mod:`dalembert.models`).
"""

from . import _native, models
from ._ensemble import Density, Ensemble, Normal, Statistics
from ._errors import DalembertError, EnsembleError, Mistake, ModelError, RequestError
from ._events import Event, Occurrence
from ._model import Model, Parameter
from ._report import Derivation, Expression, Section, Verdict
from ._run import Outcome, Run

#: The version of the package.
__version__: str = _native.version()

__all__ = [
    "DalembertError", "Density", "Derivation", "Ensemble", "EnsembleError", "Event", "Expression", "Mistake", "Model", "ModelError",
    "Normal", "Occurrence", "Outcome", "Parameter", "RequestError", "Run", "Section", "Statistics", "Verdict", "models",
]

"""Nonholonomic mechanics with impacts: declared models, checked equations, exact events.

>>> import dalembert
>>> disk = dalembert.models.rolling_disk
>>> run = disk.simulate(until=20, state={"theta_dot": 12})
>>> run.outcome.kind, len(run.events)
('done', 16)

A model comes from a text of the language (:meth:`Model.from_text`), from a file (:meth:`Model.from_file`), or is one of the
shipped ones (:mod:`dalembert.models`).
"""

from . import models
from ._errors import DalembertError, Mistake, ModelError, RequestError
from ._events import Event, Occurrence
from ._model import Model, Parameter
from ._report import Derivation, Expression, Section, Verdict
from ._run import Outcome, Run

__all__ = [
    "DalembertError", "Derivation", "Event", "Expression", "Mistake", "Model", "ModelError", "Occurrence", "Outcome", "Parameter",
    "RequestError", "Run", "Section", "Verdict", "models",
]

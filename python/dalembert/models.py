"""The shipped models, each loaded on first use: ``dalembert.models.rolling_disk``."""

from __future__ import annotations

from . import _native
from ._model import Model

_TEXTS = dict(_native.shipped())


def names() -> list[str]:
    """Names of the shipped models.

    Returns
    -------
    list of str
        The names in alphabetical order, chains by their length.
    """
    return list(_TEXTS)


def text(name: str) -> str:
    """Declaration of a shipped model.

    Parameters
    ----------
    name : str
        One of :func:`names`.

    Returns
    -------
    str
        The text that :meth:`dalembert.Model.from_text` takes.
    """
    return _TEXTS[name]


def __getattr__(name: str) -> Model:
    if name not in _TEXTS:
        raise AttributeError(f"no shipped model is called `{name}`; dalembert.models.names() lists them")
    model = Model.from_text(_TEXTS[name])
    globals()[name] = model
    return model


def __dir__() -> list[str]:
    return sorted([*_TEXTS, "names", "text"])

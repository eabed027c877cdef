"""The extension module: what the Python files call."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

def load(text: str, shown: str, claims: bool) -> list[NativeModel]: ...
def shipped() -> list[tuple[str, str]]: ...
def derive(source: str, claims: bool) -> list[dict[str, Any]]: ...
def to_c(source: str, scene: str | None) -> str: ...
def lines(source: str, scene: str | None) -> list[dict[str, Any]]: ...
def documentation(source: str) -> dict[str, str]: ...

class NativeModel:
    def with_parameters(self, values: list[tuple[str, float]]) -> NativeModel: ...
    def with_inputs(self, values: list[tuple[str, float]]) -> NativeModel: ...
    def with_mode(self, name: str) -> NativeModel: ...
    def in_scene(self, name: str) -> NativeModel: ...
    def values(self) -> list[float]: ...
    def description(self) -> dict[str, Any]: ...
    def initial(self) -> tuple[list[float], list[float], list[bool], list[bool], float | None]: ...
    def simulate(self, request: dict[str, Any]) -> NativeRun: ...
    def evaluate(self, at: dict[str, Any]) -> dict[str, Any]: ...
    def region(self, t: float, q: NDArray[np.float64]) -> NDArray[np.float64]: ...

class Table:
    t: NDArray[np.float64]
    q: NDArray[np.float64]
    qdot: NDArray[np.float64]
    p: NDArray[np.float64]
    energy: NDArray[np.float64]
    outputs: NDArray[np.float64]
    view: NDArray[np.float64] | None
    mode: NDArray[np.int64] | None

class ImpactTable:
    before: Table
    after: Table
    surfaces: NDArray[np.int64]
    simultaneous: NDArray[np.bool_]
    grazing: NDArray[np.bool_]

class ContactTable:
    at: Table
    surfaces: NDArray[np.int64]
    begins: NDArray[np.bool_]
    accumulation: NDArray[np.float64]

class CrossingTable:
    at: Table
    events: NDArray[np.int64]
    rising: NDArray[np.bool_]

class NativeRun:
    samples: Table
    impacts: ImpactTable
    contacts: ContactTable
    crossings: CrossingTable
    stop: tuple[int | None, str | None]
    kind: str
    t_end: float
    reached: bool
    words: str
    details: dict[str, Any]
    counters: dict[str, int]
    warnings: list[str]
    settings: tuple[str, str, float, float | None]
    laws: list[tuple[str, str | None]]
    last: tuple[list[float], list[float], float]
    def at(self, times: NDArray[np.float64], before: bool) -> Table: ...
    def jacobian(self, wrt: list[str]) -> NDArray[np.float64]: ...

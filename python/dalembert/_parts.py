"""The files of an ensemble: a manifest, parts with rows and sums, a summary."""

from __future__ import annotations

import hashlib
import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, Iterator

from . import _native
from ._errors import EnsembleError, RequestError
from ._storage import storage

if TYPE_CHECKING:
    import numpy as np

#: The file that identifies the ensemble.
MANIFEST = "manifest.json"
#: The file of the sums over all members.
SUMMARY = "summary.json"


class Directory:
    """A directory in which an ensemble is kept. One run at a time writes it.

    Parameters
    ----------
    place
        A path, an address as ``s3://bucket/path``, or a store of obstore.
    """

    def __init__(self, place: Any) -> None:
        self._storage = storage(place)
        self._claimed = False
        self.parts: dict[int, dict[str, Any]] = {}

    @property
    def place(self) -> Path | str:
        """The path, or the address."""
        return self._storage.place

    def begin(self, identity: dict[str, Any]) -> None:
        """Begins or continues an ensemble: reads the finished parts.

        Raises
        ------
        RequestError
            A directory that holds another ensemble or other files, or that another run is writing.
        EnsembleError
            A part that was altered.
        """
        text = document(identity, indent=1)
        names = self._storage.names()
        if MANIFEST in names:
            self._compare(text)
        elif names:
            raise RequestError(f"directory: `{self.place}` holds other files and no {MANIFEST}; give an empty directory")
        else:
            self._storage.write(MANIFEST, text)
        self._storage.claim()
        self._claimed = True
        self.read()

    def _compare(self, text: bytes) -> None:
        before, now = self.manifest(), json.loads(text)
        for key in [*now, *before]:
            was, asked = (json.dumps(it.get(key)) for it in (before, now))
            if was != asked:
                raise RequestError(
                    f"directory: `{self.place}` holds another ensemble: {key} was {was} and is {asked}; give the same arguments, "
                    "or another directory"
                )

    def close(self) -> None:
        """Lets other runs write the directory."""
        if self._claimed:
            self._storage.release()
            self._claimed = False

    def manifest(self) -> dict[str, Any]:
        """The content of the manifest."""
        try:
            return json.loads(self._storage.read(MANIFEST))
        except FileNotFoundError:
            raise RequestError(f"directory: `{self.place}` holds no ensemble: {MANIFEST} is missing") from None

    def read(self) -> None:
        """Reads the parts. Parts whose last file is missing were interrupted, and are not read."""
        self.parts = {}
        for name in self._storage.names():
            if not (name.startswith("part-") and name.endswith(".json")):
                continue
            part = json.loads(self._storage.read(name))
            for file, told in part["files"].items():
                if self._digest(file) != told:
                    raise EnsembleError(
                        f"{self.place}: {file} was altered or lost after it was written; remove {name} to run its members again"
                    )
            self.parts[part["first"]] = part

    def _digest(self, name: str) -> str | None:
        """The checksum of a file; None if there is no such file."""
        try:
            return hashlib.sha256(self._storage.read(name)).hexdigest()
        except FileNotFoundError:
            return None

    def gaps(self, count: int) -> list[tuple[int, int]]:
        """Ranges of members that are in no part."""
        gaps, next_member = [], 0
        for first, part in sorted(self.parts.items()):
            if first > next_member:
                gaps.append((next_member, first))
            next_member = first + part["members"]
        if next_member < count:
            gaps.append((next_member, count))
        return gaps

    def add(self, first: int, unit: dict[str, Any]) -> None:
        """Writes a part. Its last file completes it."""
        name = f"part-{first:012}"
        part = {"first": first, **unit}
        contents = {f"{name}.parquet": part.pop("rows"), f"{name}.counts": part.pop("counts")}
        part["sums"] = [[*numbers, total.hex(), squares.hex()] for *numbers, total, squares in part["sums"]]
        part["files"] = {}
        for file, content in contents.items():
            if content is not None:
                part["files"][file] = hashlib.sha256(content).hexdigest()
                self._storage.write(file, content)
        text = document(part)
        self._storage.write(f"{name}.json", text)
        self.parts[first] = json.loads(text)

    def finish(self, summary: dict[str, Any]) -> None:
        """Writes the summary."""
        self._storage.write(SUMMARY, document(summary, indent=1))

    def summary(self) -> dict[str, Any]:
        """The summary of an ensemble whose members were all run."""
        try:
            return json.loads(self._storage.read(SUMMARY))
        except FileNotFoundError:
            raise RequestError(
                f"directory: the ensemble in `{self.place}` is not complete; run `ensemble` again with the same arguments"
            ) from None

    def counts(self) -> Iterator[bytes]:
        """Counts of the parts."""
        return self._contents("counts")

    def lines(self) -> Iterator[bytes]:
        """Rows as lines of CSV, part by part, in the order of members."""
        return map(_native.csv_lines, self._contents("parquet"))

    def columns(self, places: list[int]) -> Iterator[list[np.ndarray | list[str]]]:
        """Values of some columns, part by part, in the order of members."""
        for part in self._contents("parquet"):
            yield [_native.column(part, place) for place in places]

    def _contents(self, suffix: str) -> Iterator[bytes]:
        """Contents of the files of a kind, in the order of members."""
        return (self._storage.read(f"part-{first:012}.{suffix}") for first in sorted(self.parts))


def document(data: Any, indent: int | None = None) -> bytes:
    """Data as JSON. Numbers that are not finite are null."""
    return (json.dumps(finite(data), indent=indent, allow_nan=False) + "\n").encode()


def finite(data: Any) -> Any:
    """The data with None in place of numbers that are not finite."""
    if isinstance(data, dict):
        return {key: finite(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [finite(value) for value in data]
    return None if isinstance(data, float) and not math.isfinite(data) else data

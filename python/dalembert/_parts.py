"""The directory of an ensemble: a manifest, parts with rows and sums, a summary."""

from __future__ import annotations

import csv
import hashlib
import json
import math
import os
from pathlib import Path
from typing import Any, Iterator

from ._errors import EnsembleError, RequestError

#: The file that identifies the ensemble.
MANIFEST = "manifest.json"
#: The file of the sums over all members.
SUMMARY = "summary.json"


class Directory:
    """A directory in which an ensemble is kept. One run at a time writes it.

    Parameters
    ----------
    path
        The directory. It is created if it does not exist.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        self._lock: Any = None
        self.parts: dict[int, dict[str, Any]] = {}

    def begin(self, identity: dict[str, Any]) -> None:
        """Begins or continues an ensemble: reads the finished parts.

        Raises
        ------
        RequestError
            A directory that holds another ensemble or other files, or that another run is writing.
        EnsembleError
            A part that was altered.
        """
        self.path.mkdir(parents=True, exist_ok=True)
        manifest = self.path / MANIFEST
        text = document(identity, indent=1)
        if manifest.exists():
            self._compare(manifest, text)
        elif any(path.suffix != ".new" for path in self.path.iterdir()):
            raise RequestError(f"directory: `{self.path}` holds other files and no {MANIFEST}; give an empty directory")
        else:
            self._write(manifest, text)
        self._claim(manifest)
        self.read()

    def _compare(self, manifest: Path, text: bytes) -> None:
        before, now = json.loads(manifest.read_text(encoding="utf-8")), json.loads(text)
        for key in [*now, *before]:
            was, asked = (json.dumps(it.get(key)) for it in (before, now))
            if was != asked:
                raise RequestError(
                    f"directory: `{self.path}` holds another ensemble: {key} was {was} and is {asked}; give the same arguments, "
                    "or another directory"
                )

    def _claim(self, manifest: Path) -> None:
        """Locks the manifest, until :meth:`close` or the end of this process, on systems that have locks."""
        try:
            import fcntl
        except ImportError:
            return
        self._lock = open(manifest, "rb")
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self.close()
            raise RequestError(f"directory: another run is writing `{self.path}`") from None
        except OSError:
            self.close()

    def close(self) -> None:
        """Lets other runs write the directory."""
        if self._lock is not None:
            self._lock.close()
            self._lock = None

    def manifest(self) -> dict[str, Any]:
        """The content of the manifest."""
        try:
            return json.loads((self.path / MANIFEST).read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise RequestError(f"directory: `{self.path}` holds no ensemble: {MANIFEST} is missing") from None

    def read(self) -> None:
        """Reads the parts. Parts whose last file is missing were interrupted, and are not read."""
        self.parts = {}
        for path in sorted(self.path.glob("part-*.json")):
            part = json.loads(path.read_text(encoding="utf-8"))
            for name, told in part["files"].items():
                if digest(self.path / name) != told:
                    raise EnsembleError(
                        f"{self.path / name}: the file was altered or lost after it was written; remove {path.name} to run its "
                        "members again"
                    )
            self.parts[part["first"]] = part

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

    def add(self, first: int, header: bytes, unit: dict[str, Any]) -> None:
        """Writes a part. Its last file completes it."""
        name = f"part-{first:012}"
        part = {"first": first, **unit}
        rows, counts = header + part.pop("rows"), part.pop("counts")
        part["sums"] = [[*numbers, total.hex(), squares.hex()] for *numbers, total, squares in part["sums"]]
        part["files"] = {f"{name}.csv": hashlib.sha256(rows).hexdigest()}
        self._write(self.path / f"{name}.csv", rows)
        if counts is not None:
            part["files"][f"{name}.counts"] = hashlib.sha256(counts).hexdigest()
            self._write(self.path / f"{name}.counts", counts)
        text = document(part)
        self._write(self.path / f"{name}.json", text)
        self.parts[first] = json.loads(text)

    def finish(self, summary: dict[str, Any]) -> None:
        """Writes the summary."""
        self._write(self.path / SUMMARY, document(summary, indent=1))

    def summary(self) -> dict[str, Any]:
        """The summary of an ensemble whose members were all run."""
        try:
            return json.loads((self.path / SUMMARY).read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise RequestError(
                f"directory: the ensemble in `{self.path}` is not complete; run `ensemble` again with the same arguments"
            ) from None

    def counts(self) -> Iterator[bytes]:
        """Counts of the parts."""
        for first in sorted(self.parts):
            yield (self.path / f"part-{first:012}.counts").read_bytes()

    def files(self) -> list[Path]:
        """Files of rows, in the order of members."""
        return [self.path / f"part-{first:012}.csv" for first in sorted(self.parts)]

    def rows(self) -> Iterator[list[str]]:
        """Rows, in the order of members."""
        for path in self.files():
            with open(path, encoding="utf-8", newline="") as file:
                reader = csv.reader(file)
                next(reader)
                yield from reader

    @staticmethod
    def _write(path: Path, content: bytes) -> None:
        """Writes a file atomically: afterwards it exists as a whole or not at all."""
        new = path.with_name(path.name + ".new")
        with open(new, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(new, path)


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


def digest(path: Path) -> str | None:
    """The checksum of a file; None if there is no such file."""
    try:
        with open(path, "rb") as file:
            checksum = hashlib.sha256()
            while block := file.read(1 << 20):
                checksum.update(block)
            return checksum.hexdigest()
    except FileNotFoundError:
        return None

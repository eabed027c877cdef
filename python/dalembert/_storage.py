"""Where the files of an ensemble are: a directory of this machine, or a store of objects."""

from __future__ import annotations

import json
import os
import platform
import time
from pathlib import Path
from typing import Any, Protocol

from ._errors import RequestError

#: The object that keeps other runs from writing, in stores of objects.
LOCK = "lock.json"


class Storage(Protocol):
    """Files by name. Files are written as a whole: a reader finds the old content or the new one."""

    @property
    def place(self) -> Path | str:
        """The path, or the address."""

    def names(self) -> list[str]:
        """Names of the files, sorted."""

    def read(self, name: str) -> bytes:
        """The content of a file.

        Raises
        ------
        FileNotFoundError
            There is no such file.
        """

    def write(self, name: str, content: bytes) -> None:
        """Writes or replaces a file."""

    def claim(self) -> None:
        """Keeps other runs from writing, until :meth:`release`.

        Raises
        ------
        RequestError
            Another run is writing.
        """

    def release(self) -> None:
        """Lets other runs write."""


def storage(place: Any) -> Storage:
    """The storage at a path, at an address as ``s3://bucket/path``, or of a store of obstore.

    Raises
    ------
    RequestError
        The package obstore is needed and missing, or refuses the address.
    """
    if isinstance(place, (str, os.PathLike)) and "://" not in os.fspath(place):
        return Local(place)
    try:
        from obstore.store import from_url
    except ImportError:
        raise RequestError(f"directory: `{place}` needs the package obstore: pip install obstore") from None
    if not isinstance(place, str):
        return Objects(place, repr(place))
    try:
        return Objects(from_url(place), place)
    except Exception as error:  # One class for each kind of store.
        raise RequestError(f"directory: `{place}` is not accepted: {error}") from None


class Local:
    """A directory of this machine. It is created if it does not exist."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.place = Path(path)
        self._lock: Any = None

    def names(self) -> list[str]:
        """Names of the files, sorted, without those whose writing was interrupted."""
        if not self.place.is_dir():
            return []
        return sorted(path.name for path in self.place.iterdir() if path.suffix != ".new")

    def read(self, name: str) -> bytes:
        """The content of a file."""
        return (self.place / name).read_bytes()

    def write(self, name: str, content: bytes) -> None:
        """Writes or replaces a file, and makes sure that it is on the disk."""
        self.place.mkdir(parents=True, exist_ok=True)
        new = self.place / f"{name}.new"
        with open(new, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(new, self.place / name)

    def claim(self) -> None:
        """Locks the directory, until :meth:`release` or the end of this process, on systems that have locks."""
        try:
            import fcntl
        except ImportError:
            return
        self._lock = os.open(self.place, os.O_RDONLY)
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self.release()
            raise RequestError(f"directory: another run is writing `{self.place}`") from None
        except OSError:
            self.release()

    def release(self) -> None:
        """Lets other runs write the directory."""
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None


class Objects:
    """A store of objects: S3, Google Cloud Storage, Azure and others, by the package obstore."""

    def __init__(self, store: Any, place: str) -> None:
        self.place, self._store = place, store

    def names(self) -> list[str]:
        """Names of the objects, sorted, without the lock."""
        import obstore

        found = (item["path"] for item in obstore.list_with_delimiter(self._store)["objects"])
        return sorted(name for name in found if name != LOCK)

    def read(self, name: str) -> bytes:
        """The content of an object."""
        import obstore

        return bytes(obstore.get(self._store, name).bytes())

    def write(self, name: str, content: bytes) -> None:
        """Writes or replaces an object."""
        import obstore

        obstore.put(self._store, name, content)

    def claim(self) -> None:
        """Creates the lock, or takes over that of a process of this machine which has ended."""
        import obstore
        from obstore.exceptions import AlreadyExistsError, NotSupportedError, PreconditionError

        mine = {"host": platform.node(), "process": os.getpid(), "since": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())}
        text = json.dumps(mine).encode()
        try:
            obstore.put(self._store, LOCK, text, mode="create")
            return
        except (NotImplementedError, NotSupportedError):
            return  # A store without conditional writes has no locks.
        except AlreadyExistsError:
            found = obstore.get(self._store, LOCK)
        theirs, meta = json.loads(bytes(found.bytes())), found.meta
        if theirs["host"] == mine["host"] and has_ended(theirs["process"]):
            same = {key: meta[key] for key in ("e_tag", "version") if meta[key] is not None}
            try:
                obstore.put(self._store, LOCK, text, mode=same)
                return
            except (NotImplementedError, NotSupportedError, PreconditionError):
                pass  # Another run was faster.
        raise RequestError(
            f"directory: another run is writing `{self.place}`: process {theirs['process']} on {theirs['host']}, since "
            f"{theirs['since']}; if it has ended, delete {LOCK} there"
        )

    def release(self) -> None:
        """Removes the lock."""
        import obstore

        obstore.delete(self._store, LOCK)


def has_ended(process: int) -> bool:
    """True if this machine has no such process."""
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return True
    except OSError:
        return False
    return False

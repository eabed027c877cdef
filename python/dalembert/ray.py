"""Ray as an executor of ensembles.

>>> import dalembert, dalembert.ray                                                                            # doctest: +SKIP
>>> disks = dalembert.models.rolling_disk.ensemble({"theta_dot": (9, 11)}, members=64, until=10,
...                                                executor=dalembert.ray.RayExecutor())                       # doctest: +SKIP
"""

from __future__ import annotations

from concurrent.futures import Future
from typing import Any, Callable

import ray


class RayExecutor:
    """Calls as tasks of Ray, with futures of :mod:`concurrent.futures`.

    Connects to a running cluster, or starts Ray on this machine, unless :func:`ray.init` was called before. Ray itself repeats no task:
    :meth:`dalembert.Model.ensemble` counts the workers that its units lose.

    Parameters
    ----------
    **options
        Options of the tasks, as ``num_cpus=1`` (the default) or ``runtime_env={"pip": ["dalembert"]}``.
    """

    def __init__(self, **options: Any) -> None:
        if not ray.is_initialized():
            ray.init(log_to_driver=False)
        options = {"num_cpus": 1, "max_retries": 0} | options
        self._options = options
        self._task = ray.remote(_call).options(**options)

    @property
    def num_workers(self) -> int:
        """Number of tasks that run at once on the whole cluster."""
        return max(1, int(ray.cluster_resources().get("CPU", 1) / max(self._options["num_cpus"], 1e-3)))

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Future[Any]:
        """The future of a call.

        Parameters
        ----------
        function : callable
            The function, which is pickled.
        *arguments
            Its arguments.

        Returns
        -------
        concurrent.futures.Future
            Its result, or its error. A task whose future is cancelled is cancelled too.
        """
        reference = self._task.remote(function, *arguments)
        future = reference.future()
        future.add_done_callback(lambda ended: ray.cancel(reference) if ended.cancelled() else None)
        return future


def _call(function: Callable[..., Any], *arguments: Any) -> Any:
    return function(*arguments)

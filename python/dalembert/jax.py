"""Runs as functions of JAX, with exact derivatives across impacts.

>>> import jax, dalembert, dalembert.jax                                                   # doctest: +SKIP
>>> end = dalembert.jax.final_state(dalembert.models.bouncing_ball, ["x", "g"], until=2)   # doctest: +SKIP
>>> jax.jacobian(end)(jax.numpy.array([1.0, 9.81]))                                        # doctest: +SKIP
"""

from __future__ import annotations

from typing import Any, Callable, Sequence

import jax
import numpy as np

from ._final import Final
from ._model import Model


def final_state(model: Model, names: Sequence[str], **arguments: Any) -> Callable[[jax.Array], jax.Array]:
    """The end of a run as a function of JAX.

    Forward and reverse mode take the derivatives of :meth:`dalembert.Run.jacobian`, which are exact across impacts; the function may
    be jitted and mapped. JAX computes in single precision unless ``jax_enable_x64`` is set; the run itself is made in double.

    Parameters
    ----------
    model : Model
        The model.
    names : sequence of str
        Names of the varied initial coordinates, initial velocities and parameters.
    **arguments
        Arguments of :meth:`dalembert.Model.simulate`: ``until``, ``tol``, ``state`` for initial values that do not vary.

    Returns
    -------
    callable
        A function of an array with one number for each name. It returns the positions, then the velocities at the end. If a run has
        no derivative, as at a graze, JAX raises its error for callbacks, whose text names the reason, the surface and the time.
    """
    final = Final(model, names, arguments)

    def call(function: Callable[[Any], np.ndarray], shape: tuple[int, ...], values: jax.Array) -> jax.Array:
        kind = values.dtype
        result = jax.ShapeDtypeStruct(shape, kind)
        return jax.pure_callback(lambda item: function(item).astype(kind), result, values, vmap_method="sequential")

    @jax.custom_jvp
    def end(values: jax.Array) -> jax.Array:
        return call(final.end, (final.size,), values)

    # The result is linear in the tangents, so JAX obtains reverse mode by transposition.
    @end.defjvp
    def _(primals: tuple[jax.Array], tangents: tuple[jax.Array]) -> tuple[jax.Array, jax.Array]:
        (values,), (directions,) = primals, tangents
        return end(values), call(final.jacobian, (final.size, len(final.names)), values) @ directions

    return lambda values: end(jax.numpy.asarray(values, dtype=float))

"""Runs as functions of PyTorch, with exact derivatives across impacts.

>>> import torch, dalembert, dalembert.torch                                                 # doctest: +SKIP
>>> end = dalembert.torch.final_state(dalembert.models.bouncing_ball, ["x", "g"], until=2)   # doctest: +SKIP
>>> end(torch.tensor([1.0, 9.81], dtype=torch.float64, requires_grad=True))[0].backward()    # doctest: +SKIP
"""

from __future__ import annotations

from typing import Any, Callable, Sequence

import torch
from torch.autograd.function import once_differentiable

from ._final import Final
from ._model import Model


def final_state(model: Model, names: Sequence[str], **arguments: Any) -> Callable[[torch.Tensor], torch.Tensor]:
    """The end of a run as a function of PyTorch.

    Its derivatives are those of :meth:`dalembert.Run.jacobian`, which are exact across impacts, in reverse and forward mode.

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
        A function of a tensor whose last axis has one number for each name. It returns the positions, then the velocities at the
        end of each run.

    Raises
    ------
    RequestError
        In the backward pass: the run has no derivative, as at a graze. The text names the reason, the surface and the time.
    """
    final = Final(model, names, arguments)

    def tensor(array: Any, like: torch.Tensor) -> torch.Tensor:
        return torch.as_tensor(array, dtype=like.dtype, device=like.device)

    class End(torch.autograd.Function):
        @staticmethod
        def forward(ctx: Any, values: torch.Tensor) -> torch.Tensor:
            ctx.save_for_backward(values)
            ctx.save_for_forward(values)
            return tensor(final.end(values.detach().cpu().numpy()), values)

        @staticmethod
        @once_differentiable
        def backward(ctx: Any, cotangents: torch.Tensor) -> torch.Tensor:
            return torch.einsum("...ij,...i->...j", _jacobian(ctx), cotangents)

        @staticmethod
        def jvp(ctx: Any, directions: torch.Tensor) -> torch.Tensor:
            return torch.einsum("...ij,...j->...i", _jacobian(ctx), directions)

    def _jacobian(ctx: Any) -> torch.Tensor:
        (values,) = ctx.saved_tensors
        return tensor(final.jacobian(values.detach().cpu().numpy()), values)

    return End.apply

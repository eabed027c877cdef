"""Models: declarations with values for their parameters, and computations with them."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from functools import cached_property
from html import escape
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Callable, Iterable, Mapping, Sequence

from . import _events, _export, _native
from ._errors import RequestError
from ._ensemble import Swept
from ._events import Event, Occurrence, StateFunction
from ._request import array, floats, inputs as input_functions, laws, pairs, start
from ._report import Derivation, Expression, Verdict, derivations
from ._run import Run

if TYPE_CHECKING:
    import casadi
    import numpy as np

    from ._sympy import Symbolic

#: A law by its name, with its coefficient: ``"elastic"``, ``"newton:0.5"``.
Law = str


@dataclass(frozen=True)
class Parameter:
    """A parameter of a model.

    Attributes
    ----------
    name : str
        The name; a member of a family has its index after a dot, ``m.3``.
    value : float
        The value in this model; NaN if it has none.
    default : float or None
        The declared value.
    assumption : str
        The allowed values.
    documentation : str
        The doc comment of the declaration.
    """

    name: str
    value: float
    default: float | None
    assumption: str
    documentation: str


class Model(Swept):
    """A mechanical system with values for its parameters. Models are immutable: other values make another model.

    Values of parameters are attributes: ``disk.m``. Names with dots are items of :attr:`parameters`.

    Examples
    --------
    >>> from dalembert import Model
    >>> pendulum = Model.from_text('''
    ...     Pendulum {
    ...         coordinates { theta: angle; }
    ...         parameters { g > 0 = 9.81; }
    ...         lagrangian = dot(theta)^2/2 + g*cos(theta);
    ...         initial { theta = 1/2; until = 10; }
    ...     }
    ... ''')
    >>> float(pendulum.with_parameters(g=1.62).simulate()["theta"][0])
    0.5
    """

    def __init__(self, native: _native.NativeModel, claims: bool = True, scene: str = "all") -> None:
        self._native = native
        self._claims = claims
        self._scene = scene

    def __reduce__(self) -> Any:
        return _restored, (self.source, self._claims, self._scene, self._values())

    def _values(self) -> dict[str, float]:
        """The values of the parameters that have one."""
        return {name: value for name, value in self.parameters.items() if not math.isnan(value)}

    @cached_property
    def _description(self) -> dict[str, Any]:
        return self._native.description()

    # Construction ----------------------------------------------------------------------------------------------------------

    @classmethod
    def from_text(cls, text: str, name: str | None = None, claims: bool = True, *, file: str = "text") -> Model:
        """Load a model from a text of the language.

        Parameters
        ----------
        text : str
            One or more declarations.
        name : str, optional
            Name of the model, as declared or in snake case; needed if the text declares several models.
        claims : bool, default True
            Examine the claims. Without them a model loads faster, but facts that follow from a claim are not available.
        file : str, optional
            The name of the text in messages.

        Returns
        -------
        Model
            The model with the declared values of its parameters.

        Raises
        ------
        ModelError
            The text has mistakes, or a claim is refuted, with a counterexample, or left open.
        RequestError
            No model has this name, the text declares several and no name is given, or the model is too large.
        """
        models = [cls(native, claims) for native in _native.load(text, file, claims)]
        if name is None:
            if len(models) > 1:
                listed = ", ".join(model.name for model in models)
                raise RequestError(f"{file} declares several models, {listed}; say which one by name=")
            return models[0]
        for model in models:
            if name in (model.name, model._description["type_name"]):
                return model
        listed = ", ".join(model.name for model in models)
        raise RequestError(f"{file} declares no model `{name}`\n  accepted: {listed}")

    @classmethod
    def from_file(cls, path: str | os.PathLike[str], name: str | None = None, claims: bool = True) -> Model:
        """Load a model from a file, such as ``disk.dal``.

        Parameters
        ----------
        path : path
            The file, in UTF-8.
        name, claims
            As for :meth:`from_text`.

        Returns
        -------
        Model
            The model with the declared values of its parameters.
        """
        text = Path(path).read_text(encoding="utf-8")
        return cls.from_text(text, name, claims, file=os.fspath(path))

    def _changed(self, native: _native.NativeModel, scene: str | None = None) -> Model:
        return Model(native, self._claims, self._scene if scene is None else scene)

    def with_parameters(self, /, **values: float) -> Model:
        """The same model with other values for some parameters.

        Parameters
        ----------
        **values : float
            New values by name. Names with a dot are given as ``with_parameters(**{"m.3": 2})``.

        Returns
        -------
        Model
            The new model. This one does not change.

        Raises
        ------
        RequestError
            No such parameter, or a value that the declaration rules out.
        """
        return self._changed(self._native.with_parameters(pairs(values)))

    def with_feedback(self, /, **laws: str) -> Model:
        """The closed loop: the model with inputs replaced by laws in the language.

        The result is a model without these inputs. It has everything that a model has: derivatives, power series, ensembles,
        machine code. To close the loop with a Python function, use `inputs` of :meth:`simulate`.

        Parameters
        ----------
        **laws : str
            Expressions in time, coordinates, velocities, parameters and definitions, by input:
            ``with_feedback(u="-4*x - dot(x)")``. For a member of a family:
            ``with_feedback(**{"thrust[2]": "-x"})``.

        Returns
        -------
        Model
            The closed loop in the same scene, with the same values of the parameters.

        Raises
        ------
        RequestError
            No such input, or a law that is not one expression.
        ModelError
            A law that the language refuses.

        Examples
        --------
        >>> from dalembert import Model
        >>> cart = Model.from_text("Cart { coordinates { x; } inputs { u; } lagrangian = dot(x)^2/2; forces { push: u*d(x); } }")
        >>> run = cart.with_feedback(u="-4*x").simulate(state={"x": 1, "x_dot": 0}, until=1)
        >>> round(float(run.jacobian(["x"])[0, 0]), 10)  # cos(2)
        -0.4161468365
        """
        text = _native.close(self.source, f"{self.name} with feedback", list(laws.items()))
        return _restored(text, self._claims, self._scene, self._values())

    def scene(self, name: str) -> Model:
        """A declared scene of this model, with the same values of the parameters.

        Parameters
        ----------
        name : str
            One of :attr:`scenes`; ``"all"`` is the whole model.

        Returns
        -------
        Model
            The scene as a model.
        """
        return self._changed(self._native.in_scene(name), name)

    # Declaration -----------------------------------------------------------------------------------------------------------

    @property
    def name(self) -> str:
        """The name in snake case: `rolling_disk`."""
        return self._description["name"]

    @property
    def documentation(self) -> str:
        """The doc comment."""
        return self._description["documentation"]

    @property
    def source(self) -> str:
        """The declaration."""
        return self._description["source"]

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates."""
        return tuple(self._description["coordinates"])

    @property
    def velocities(self) -> tuple[str, ...]:
        """Names of the velocities: `x_dot`."""
        return tuple(self._description["velocities"])

    @property
    def momenta(self) -> tuple[str, ...]:
        """Names of the momenta: `p_x`."""
        return tuple(self._description["momenta"])

    @property
    def is_first_order(self) -> bool:
        """True if a field is declared in place of a Lagrangian."""
        return self._description["is_first_order"]

    @property
    def view(self) -> tuple[list[str], list[int] | None, bool] | None:
        """The declared view, or None: labels, indices of its coordinates (None for other quantities), true if it has a region."""
        return self._description["view"]

    @property
    def constraints(self) -> tuple[str, ...]:
        """Names of the constraints."""
        return tuple(self._description["constraints"])

    @property
    def surfaces(self) -> dict[str, str]:
        """The declared law of each surface, by name."""
        return dict(self._description["surfaces"])

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the declared outputs."""
        return tuple(self._description["outputs"])

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs."""
        return tuple(self._description["inputs"])

    @property
    def scenes(self) -> tuple[str, ...]:
        """Names of the scenes, `all` first."""
        return tuple(self._description["scenes"])

    @property
    def modes(self) -> tuple[str, ...]:
        """Names of the modes."""
        return tuple(mode for mode, _ in self._description["modes"])

    @property
    def quasi_velocities(self) -> tuple[str, ...]:
        """Names of the quasi-velocities: the independent velocities of the reduced form."""
        return tuple(self._description["quasi_velocities"])

    @cached_property
    def parameters(self) -> Mapping[str, float]:
        """Values of the parameters by name."""
        names = (name for name, _, _ in self._description["parameters"])
        return MappingProxyType(dict(zip(names, self._native.values())))

    @cached_property
    def declared_parameters(self) -> tuple[Parameter, ...]:
        """The parameters with their values, declared values, assumptions and doc comments."""
        docs = _native.documentation(self.source)
        return tuple(
            Parameter(name, self.parameters[name], default, assumption, docs.get(name.split(".")[0], ""))
            for name, assumption, default in self._description["parameters"]
        )

    @property
    def initial(self) -> dict[str, float]:
        """The declared part of the initial state, by name, and the declared ``until``."""
        q, qdot, placed, named, until = self._native.initial()
        positions = {name: value for name, value, given in zip(self.coordinates, q, placed) if given}
        velocities = {name: value for name, value, given in zip(self.velocities, qdot, named) if given}
        end = {} if until is None else {"until": until}
        return positions | velocities | end

    def __getattr__(self, name: str) -> float:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self.parameters[name]
        except KeyError:
            raise AttributeError(f"`{self.name}` has no parameter or attribute `{name}`") from None

    def __dir__(self) -> Iterable[str]:
        return [*super().__dir__(), *self.parameters]

    # Motion ----------------------------------------------------------------------------------------------------------------

    def simulate(
        self,
        *,
        until: float | None = None,
        impacts: int | None = None,
        state: Mapping[str, float] | None = None,
        q: Sequence[float] | None = None,
        qdot: Sequence[float] | None = None,
        p: Sequence[float] | None = None,
        off_constraint: str = "error",
        times: Sequence[float] | np.ndarray | None = None,
        samples: int = 1000,
        tol: float = 1e-10,
        integrator: str = "auto",
        step: float | None = None,
        max_step: float | None = None,
        steps: int | None = None,
        law: Law | Mapping[str, Law] | None = None,
        form: str | None = None,
        projection: bool | None = None,
        rest: str = "stop",
        penetration: str = "stop",
        corner: str = "stop",
        split: str = "first",
        inputs: Mapping[str, float | StateFunction] | None = None,
        period: float | None = None,
        mode: str | None = None,
        events: Sequence[str | StateFunction | tuple[Any, ...] | Event] = (),
        on_step: Callable[[float, np.ndarray, np.ndarray], Any] | None = None,
        on_event: Callable[[Occurrence], Any] | None = None,
        progress: bool = False,
    ) -> Run:
        """Run the model from a state at ``t = 0``.

        Other Python threads run meanwhile, and Ctrl-C interrupts. The numbers are those of the command line, to the bit.

        Parameters
        ----------
        until : float, optional
            The end time. Default: the declared one.
        impacts : int, optional
            Stop after this many impacts. Without `until`, the end time is then the declared one, but at least 3600.
        state : mapping of str to float, optional
            Changes of the declared initial state: coordinates ``x``, velocities ``x_dot``. Values that are neither declared nor
            given here are 0, or such that the constraints hold.
        q, qdot, p : sequence of float, optional
            All positions, with all velocities or all momenta, instead of `state`.
        off_constraint : {"error", "project", "keep"}
            Treatment of positions or velocities that violate the constraints.
        times : sequence of float, optional
            Times of the samples, in order.
        samples : int, default 1000
            Without `times`, the number of equally spaced times from 0 to the end, both included.
        tol : float, default 1e-10
            Relative error allowed per step, from 1e-15 to 0.1.
        integrator : {"auto", "dop853", "dopri5", "taylor", "rk4", "gauss4", "gauss6", "dla2", "dla4"}
            The integrator. "auto" takes "taylor" or "dop853", whichever needs less work, by counted operations of the model at
            this tolerance. The last five have a fixed step.
        step : float, optional
            The step of an integrator with a fixed step. Default: a step that suits `tol`.
        max_step : float, optional
            The largest step of an adaptive integrator.
        steps : int, optional
            Stop after this many steps.
        law : str or mapping of str to str, optional
            The impact law of all surfaces, or of each by name, instead of the declared ones: ``"elastic"``, ``"newton:0.5"``.
        form : {"reduced", "global"}, optional
            The form of the equations. Default: ``"reduced"`` if the model has this form.
        projection : bool, optional
            Project onto the constraints after each step, in global form.
        rest : {"stop", "contact"}
            Policy if the motion presses against a surface without leaving it.
        penetration : {"stop", "repeat", "contact"}
            Policy if the state still approaches the surface after the law.
        corner : {"stop", "ascending", "descending"}
            Policy for impacts on several surfaces at one time, if their order matters.
        split : {"first", "stop"}
            Policy at a transition from which the motion can continue in more than one way.
        inputs : mapping of str to float or callable, optional
            Constant values of inputs, or functions of ``t``, ``q`` and ``qdot``. Other inputs are 0.
        period : float, optional
            Call these functions at multiples of this time and hold their values. Without it they are called wherever the motion is
            evaluated, and should be smooth.
        mode : str, optional
            The initial mode of a model with modes.
        events : sequence, optional
            Functions of the state whose changes of sign are recorded in :attr:`Run.crossings`: an expression such as
            ``"x - 2*dot(theta)"``, a function of ``t``, ``q`` and ``qdot``, either of them with a direction, ``("x", 1)``, or an
            :class:`Event`. The motion is the same as without them, to the bit.
        on_step : callable, optional
            Called with ``t``, ``q`` and ``qdot`` after each step. If it returns True or ``"stop"``, the run ends there with the
            outcome ``stopped``.
        on_event : callable, optional
            Called with an :class:`Occurrence` at each impact, each beginning and end of a contact, and each event. It can end the
            run in the same way.
        progress : bool, default False
            Show the progress of the run, by tqdm if it is installed.

        Returns
        -------
        Run
            Samples, impacts and outcome. An early end is an outcome, not an exception.

        Raises
        ------
        RequestError
            Unknown names, values out of range, a state that is refused.
        """
        native = self._native
        numbers, control = input_functions(self.inputs, inputs or {})
        if numbers:
            native = native.with_inputs(numbers)
        if mode is not None:
            native = native.with_mode(mode)
        request = {
            "until": until, "impacts": impacts, "start": start(state, q, qdot, p), "off_constraint": off_constraint,
            "times": None if times is None else array(times),
            "samples": samples, "tol": tol, "integrator": integrator, "step": step, "max_step": max_step, "steps": steps,
            "laws": laws(law), "form": form, "projection": projection, "rest": rest, "penetration": penetration,
            "corner": corner, "split": split, "control": control, "period": period,
        }
        wanted = _events.taken(events)
        request |= {
            "events": [(None if isinstance(item.function, str) else item.function, item.direction, item.terminal) for item in wanted],
            "watched": _events.watched(self, wanted), "on_step": on_step,
            "on_event": _events.listener(self, wanted, on_event),
        }
        with _events.progress(progress, until or self.initial.get("until"), self.name) as shown:
            run = Run(self, native.simulate(request | {"on_progress": shown}), wanted)
            # Also runs that end before anything is shown show their end.
            if shown:
                shown(run.outcome.t)
            return run

    def evaluate(
        self,
        q: Sequence[float],
        qdot: Sequence[float] | None = None,
        p: Sequence[float] | None = None,
        t: float = 0.0,
    ) -> dict[str, Any]:
        """All derived quantities at a state.

        Parameters
        ----------
        q : sequence of float
            Positions.
        qdot, p : sequence of float
            Either velocities or momenta.
        t : float, default 0
            The time.

        Returns
        -------
        dict
            Numbers, vectors and matrices by name: ``qdot``, ``p``, ``pdot``, ``acceleration``, ``multipliers``, ``metric``,
            ``energy`` and others. Names are those of the command ``eval``.
        """
        return self._native.evaluate({"t": t, "q": floats(q), "qdot": floats(qdot), "p": floats(p)})

    # Equations -------------------------------------------------------------------------------------------------------------

    @cached_property
    def _derivations(self) -> dict[str, Derivation]:
        return derivations(self.source, self._claims, self.scenes)

    def derive(self, scene: str | None = None) -> Derivation:
        """The derivation of the equations, with the verdicts on the claims.

        Parameters
        ----------
        scene : str, optional
            One of :attr:`scenes`; for a model with modes, these are its modes. Default: the scene of this model.

        Returns
        -------
        Derivation
            Metric, forces, constraints, impact maps: as text, as LaTeX, and as data.
        """
        scene = self._scene if scene is None else scene
        if scene not in self._derivations:
            raise RequestError(f"unknown scene `{scene}`\n  accepted: {', '.join(self._derivations)}")
        return self._derivations[scene]

    def check(self) -> tuple[Verdict, ...]:
        """Verdicts on the claims of the model and of its scenes.

        Returns
        -------
        tuple of Verdict
            The verdicts in the order of the declaration.
        """
        return tuple(verdict for derivation in self._derivations.values() for verdict in derivation.verdicts)

    @property
    def lagrangian(self) -> Expression:
        """The Lagrangian, as text, LaTeX or an expression of SymPy."""
        return self.derive().lagrangian

    def to_sympy(self, scene: str | None = None) -> Symbolic:
        """The declaration in SymPy.

        Parameters
        ----------
        scene : str, optional
            As for :meth:`derive`. A model with modes needs it: each mode has a declaration of its own.

        Returns
        -------
        Symbolic
            Lagrangian, constraints, forces and surfaces, over functions of time.
        """
        from ._sympy import Symbolic

        declaration = self.derive(scene).declaration
        if declaration is None:
            raise RequestError(f"`{self.name}` has modes; say which one by scene=: {', '.join(self.modes)}")
        return Symbolic.of(declaration)

    def to_c(self, path: str | os.PathLike[str] | None = None) -> str:
        """The model as a C99 header, which allocates nothing and needs only ``math.h``.

        Parameters
        ----------
        path : path, optional
            A file to write.

        Returns
        -------
        str
            The text: functions for rate, velocity, energy, gaps, impacts and other quantities, for this scene or for each mode.
        """
        return _export.to_c(self, path)

    def to_casadi(self, function: str = "rate", scene: str | None = None) -> casadi.Function:
        """A function of the model in CasADi.

        Parameters
        ----------
        function : str, default "rate"
            A function of :meth:`to_c` by its name: ``"energy"``, ``"gaps"``, ``"impact_floor"``.
        scene : str, optional
            As for :meth:`derive`.

        Returns
        -------
        casadi.Function
            A function of the time ``t``, the state ``s`` (positions, then momenta or quasi-velocities) and the parameters ``k`` in
            their order, inputs last; ``"motion"`` is a function of ``t``, ``q``, ``v`` and ``k``. A result may be NaN.
        """
        return _export.to_casadi(self, function, scene)

    # Display ---------------------------------------------------------------------------------------------------------------

    def __repr__(self) -> str:
        lines = [f"Model {self.name}" + ("" if self._scene == "all" else f", scene {self._scene}")]
        lines += [f"  {line}" for line in self.documentation.splitlines()]
        lines.append(f"  coordinates  {', '.join(self.coordinates)}")
        for title, names in [("constraints", self.constraints), ("surfaces", self.surfaces), ("outputs", self.outputs)]:
            if names:
                lines.append(f"  {title:12} {', '.join(names)}")
        if self.parameters:
            lines.append("  parameters")
            width = max(map(len, self.parameters))
            for item in self.declared_parameters:
                about = "  ".join(part for part in [item.assumption, item.documentation] if part)
                lines.append(f"    {item.name:{width}} = {item.value:<12g} {about}".rstrip())
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{escape(item.name)}</td><td>{item.value:g}</td><td>{escape(item.assumption)}</td>"
            f"<td style='text-align: left'>{escape(item.documentation)}</td></tr>"
            for item in self.declared_parameters
        )
        table = f"<table><tr><th>parameter</th><th>value</th><th>values</th><th></th></tr>{rows}</table>" if rows else ""
        return f"<h3>{escape(self.name)}</h3><p>{escape(self.documentation)}</p>{table}{self.derive().to_html(heading=False)}"


def _restored(source: str, claims: bool, scene: str, values: dict[str, float]) -> Model:
    """The model that a text declares, in a scene, with these values of its parameters."""
    model = Model.from_text(source, claims=claims)
    return (model if scene == "all" else model.scene(scene)).with_parameters(**values)

"""Headers of C and functions of CasADi, against the model itself."""

import ctypes
import math
import re
import shutil
import subprocess

import numpy as np
import pytest
from test_equations import NAMES, admissible

import dalembert
from dalembert import RequestError, _native

#: The models of `test_equations`, and models with modes, fields and instantaneous constraints.
EXPORTED = [*NAMES, "compass_walker", "rolling_ball_wall", "spring_mass_walker", "filippov_field", "refracted_particle"]


@pytest.fixture(scope="module")
def compiler():
    found = shutil.which("cc")
    if found is None:
        pytest.skip("no compiler `cc`")
    return found


def compiled(compiler, header, folder, name):
    """Compiles the functions of a header.

    Returns a dictionary from their names to their numbers of results and of arrays, and `call`, which calls one by its name.
    """
    folder.joinpath("model.h").write_text(header, encoding="utf-8")
    source = '#include "model.h"\n'
    sizes = {}
    for size, function, arguments in re.findall(r"/\* out\[(\d+)\]:[^*]*\*/\nstatic inline int (\w+)\(([^)]*)\)", header):
        arrays = re.findall(r"double \*(\w+)", arguments)
        sizes[function] = (int(size), len(arrays) - 1)
        source += f"int call_{function}({arguments}) {{ return {function}(t, {', '.join(arrays)}); }}\n"
    folder.joinpath("model.c").write_text(source, encoding="utf-8")
    library = folder / f"{name}.so"
    flags = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O2", "-shared", "-fPIC"]
    subprocess.run([compiler, *flags, folder / "model.c", "-o", library, "-lm"], check=True)
    loaded = ctypes.CDLL(str(library))

    def call(function, t, *arrays):
        size, count = sizes[function]
        assert count == len(arrays)
        pointers = [np.ascontiguousarray(array, dtype=float) for array in arrays]
        out = np.full(size, np.nan)
        found = getattr(loaded, f"call_{function}")
        found.argtypes = [ctypes.c_double] + [ctypes.c_void_p] * (count + 1)
        code = found(t, *(item.ctypes.data for item in pointers), out.ctypes.data)
        return code, out

    return sizes, call


def parameters(model):
    return [*model.parameters.values(), *(0.1 for _ in model.inputs)]


def close(found, expected):
    """Asserts equality up to rounding errors, relative to each number or to the largest one."""
    expected = np.asarray(expected, dtype=float)
    np.testing.assert_allclose(found, expected, rtol=1e-13, atol=4e-15 * max(1.0, np.abs(expected).max(initial=0.0)))


@pytest.mark.parametrize("name", NAMES)
def test_a_header_of_c_is_the_model(name, compiler, tmp_path):
    model = getattr(dalembert.models, name)
    sizes, call = compiled(compiler, model.to_c(), tmp_path, name)
    generator, k, n = np.random.default_rng(11), list(model.parameters.values()), len(model.coordinates)
    for _ in range(3):
        q, qdot, derived = admissible(model, generator)
        code, motion = call(f"{name}_motion", 0.0, q, qdot, k)
        assert code == 0
        state = np.concatenate([q, motion])
        close(call(f"{name}_velocity", 0.0, state, k)[1], qdot)
        close(call(f"{name}_energy", 0.0, state, k)[1], [derived["energy"]])
        code, rate = call(f"{name}_rate", 0.0, state, k)
        assert code == 0
        close(rate[:n], qdot)
        if len(motion) == n and not model.constraints:
            np.testing.assert_allclose(rate[n:], derived["pdot"], rtol=1e-11, atol=1e-11)
        # The acceleration is the derivative of the velocity along the rate.
        h = 1e-6
        ahead, behind = (call(f"{name}_velocity", s * h, state + s * h * rate, k)[1] for s in (1, -1))
        np.testing.assert_allclose((ahead - behind) / (2 * h), derived["acceleration"], rtol=1e-5, atol=1e-7)


def test_impacts_of_a_header_are_those_of_a_run(compiler, tmp_path):
    for name in ["rolling_disk", "bouncing_ball", "point_billiard", "moving_wall_disk", "chaplygin_sleigh"]:
        model = getattr(dalembert.models, name)
        run = model.simulate(until=20)
        folder = tmp_path / name
        folder.mkdir()
        _, call = compiled(compiler, model.to_c(), folder, name)
        k = list(model.parameters.values())
        assert len(run.events) > 1, name
        for event in run.events[:20]:
            before, after = ([[event[side][item] for item in names] for names in (model.coordinates, model.velocities)]
                             for side in ("before", "after"))
            state = np.concatenate([before[0], call(f"{name}_motion", event["t"], *before, k)[1]])
            gaps = call(f"{name}_gaps", event["t"], state, k)[1]
            assert abs(gaps[list(model.surfaces).index(event["surface"])]) < 1e-12
            code, struck = call(f"{name}_impact_{event['surface']}", event["t"], state, k)
            assert code == 0
            np.testing.assert_allclose(call(f"{name}_velocity", event["t"], struck, k)[1], after[1], rtol=1e-12, atol=1e-12)


def test_impacts_with_instantaneous_constraints_begin_with_focusing(compiler, tmp_path):
    text = """
        Spun { coordinates { x; y; th; } lagrangian = (dot(x)^2 + dot(y)^2 + 0.4*dot(th)^2)/2;
            impacts { wall: y <= 1 => elastic, instantaneous { roll: dot(th) = 0.1*dot(x); }; } }
    """
    model = dalembert.Model.from_text(text)
    _, call = compiled(compiler, model.to_c(), tmp_path, "spun")
    state = np.array([0.5, 1, 0, 1, 1, 0.4 * 0.7])
    focused = call("spun_focus_wall", 0.0, state, [])[1]
    struck = call("spun_impact_wall", 0.0, focused, [])[1]
    along = (1 + 0.4 * 0.1 * 0.7) / (1 + 0.4 * 0.1**2)
    close(call("spun_velocity", 0.0, struck, [])[1], [along, -1, 0.1 * along])


def test_faults_have_numbers(compiler, tmp_path):
    text = """
        Thin { coordinates { x; y; } lagrangian = (1 - x)*dot(x)^2/2 + dot(y)^2/2; initial { x = 0; } }
    """
    model = dalembert.Model.from_text(text)
    _, call = compiled(compiler, model.to_c(), tmp_path, "thin")
    assert call("thin_rate", 0.0, [0.5, 0, 1, 1], [])[0] == 0
    assert call("thin_rate", 0.0, [2.0, 0, 1, 1], [])[0] == 1


def test_zeros_with_a_sign_are_zeros_for_atan2(compiler, tmp_path):
    text = """
        Turned { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2; outputs { a: atan2(y, x); b: atan2(-y, -x); } }
    """
    _, call = compiled(compiler, dalembert.Model.from_text(text).to_c(), tmp_path, "turned")
    for x, y in [(-1.0, -0.0), (-1.0, 0.0), (-0.0, 0.0), (-0.0, -0.0), (1.0, 0.0)]:
        angle, opposite = call("turned_outputs", 0.0, [x, y, 1, 1], [])[1]
        assert angle == (math.pi if x < 0 else 0)
        assert opposite == (math.pi if x > 0 else 0)


def test_a_header_has_no_unused_values(compiler, tmp_path):
    """The impact takes some of the values that the declared law computes. The compiler refuses unused ones."""
    text = """
        Jointed {
            coordinates { x; th: angle; u in (0.1, 5); p; q; }
            parameters { m > 0 = 1.5; a = 0.3; k > 0 = 1; l > 0 = 2; }
            inputs { w; }
            lagrangian = m/2*(dot(x)^2 + u^2*dot(th)^2 + dot(u)^2) + a*x*dot(th)*sin(th)/10
                + (1 + x^2/9)*(k*dot(p)^2 + l*dot(q)^2)/2 - (p^4 + q^4)/4;
            constraints { c: d(p) - u*d(x) = a*sin(t)*d(t); }
            impacts { low: u - 0.2 >= 0 => restitution(0.3); }
        }
    """
    compiled(compiler, dalembert.Model.from_text(text).to_c(), tmp_path, "jointed")


@pytest.mark.parametrize("name", EXPORTED)
def test_casadi_has_the_functions_of_c(name, compiler, tmp_path):
    casadi = pytest.importorskip("casadi")
    model = getattr(dalembert.models, name)
    sizes, call = compiled(compiler, model.to_c(), tmp_path, name)
    generator, compared = np.random.default_rng(5), 0
    for part in _native.lines(model.source, None):
        scene = part["name"].removeprefix(f"{model.name}_") if model.modes else None
        for item, (of_state, *_) in part["routines"].items():
            size, _ = sizes[f"{part['name']}_{item}"]
            function = model.to_casadi(item, scene)
            n = len(part["coordinates"])
            lengths = [n + len(part["motion"])] if of_state else [n, n]
            for _ in range(2):
                arrays = [generator.uniform(0.2, 0.8, length) for length in lengths] + [parameters(model)]
                code, out = call(f"{part['name']}_{item}", 0.3, *arrays)
                if code == 0 and np.isfinite(out).all():
                    close(np.array(casadi.DM(function(0.3, *arrays))).ravel(), out)
                    compared += len(out)
            assert function.numel_out() == size
    assert compared > 10


def test_casadi_differentiates(compiler):
    casadi = pytest.importorskip("casadi")
    pendulum = dalembert.models.double_pendulum
    rate = pendulum.to_casadi()
    jacobian = rate.jacobian()
    state, k = np.array([0.3, -0.4, 0.2, 0.1]), list(pendulum.parameters.values())
    exact = np.array(jacobian(0, state, k, 0)[1])
    columns = [(np.array(rate(0, state + h, k)) - np.array(rate(0, state - h, k))) / 2e-6 for h in 1e-6 * np.eye(4)]
    np.testing.assert_allclose(exact, np.hstack(columns), rtol=1e-7, atol=1e-7)
    assert casadi.Function is type(rate)


def test_exports_that_are_refused():
    pytest.importorskip("casadi")
    with pytest.raises(RequestError, match="has no function `rates`\n  accepted: velocity, rate"):
        dalembert.models.rolling_disk.to_casadi("rates")
    with pytest.raises(RequestError, match="has modes; say which one by scene=: "):
        dalembert.models.spring_mass_walker.to_casadi()
    with pytest.raises(RequestError, match="unknown scene `none`"):
        dalembert.models.rolling_disk.to_casadi(scene="none")


def test_headers_of_scenes_and_of_the_command(command, tmp_path):
    disk = dalembert.models.rolling_disk
    free = disk.scene("free")
    assert "impact_leading_edge" in disk.to_c() and "impact_" not in free.to_c()
    assert command("export", "rolling_disk", "--c", "-") == disk.to_c()
    command("export", "rolling_disk", "--scene", "free", "--c", str(tmp_path / "free.h"))
    assert (tmp_path / "free.h").read_text(encoding="utf-8") == free.to_c()
    assert disk.to_c(tmp_path / "disk.h") == (tmp_path / "disk.h").read_text(encoding="utf-8")

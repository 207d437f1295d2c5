"""The package as it is installed: names, data files, house rules."""

import ast
import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

import ves_twin

PACKAGE = Path(ves_twin.__file__).parent
ROOT = PACKAGE.parent


def test_every_public_name_exists():
    for name in ves_twin.__all__:
        assert getattr(ves_twin, name) is not None


def test_unknown_public_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'simulat'"):
        ves_twin.simulat  # noqa: B018


@pytest.mark.parametrize(
    "code", ["import ves_twin", "import ves_twin.cli.main as m; m.build_parser()"]
)
def test_package_and_help_load_nothing_heavy(code):
    """What keeps `import ves_twin` and `ves-twin --help` quick."""
    heavy = ("numpy", "scipy", "mujoco", "gymnasium", "pydantic", "numba", "matplotlib", "rerun")
    check = f"import sys; {code}; print([m for m in {heavy!r} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", check], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.nightly
@pytest.mark.timeout(900)  # builds, installs, compiles from nothing: a minute alone
def test_wheel_carries_models_and_scenarios_and_works_from_another_folder(tmp_path):
    build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"]
    subprocess.run([*build, "--wheel-dir", str(tmp_path), str(ROOT)], check=True)
    (wheel,) = tmp_path.glob("*.whl")
    site = tmp_path / "site"
    install = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--no-deps",
        "--target",
        str(site),
    ]
    subprocess.run([*install, str(wheel)], check=True)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    code = (
        "import ves_twin, ves_twin.cli.main as m, sys;"
        f"assert ves_twin.__file__.startswith({str(site)!r});"
        "sys.exit(m.main(['run', 'position_sine', '--no-rrd', '--set', 'run.duration=0.2']))"
    )
    environment = {**os.environ, "PYTHONPATH": str(site)}
    subprocess.run([sys.executable, "-c", code], cwd=elsewhere, env=environment, check=True)
    assert (elsewhere / "runs" / "position_sine" / "recording.parquet").is_file()


@cache
def sources():
    """Text of every file of the package."""
    return {str(p.relative_to(PACKAGE)): p.read_text() for p in sorted(PACKAGE.rglob("*.py"))}


@cache
def trees():
    """What the files say: not where tests are collected, since every worker collects all."""
    return {name: ast.parse(text) for name, text in sources().items()}


def functions():
    """Every function of the package: name of its file, its node."""
    for name, tree in trees().items():
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef):
                yield name, node


def test_no_file_is_longer_than_400_lines():
    assert [name for name, text in sources().items() if text.count("\n") > 400] == []


def test_the_first_line_of_every_file_says_what_it_holds():
    assert [name for name, tree in trees().items() if not ast.get_docstring(tree)] == []


def test_no_function_is_longer_than_75_lines():
    long = [f"{name}: {f.name}" for name, f in functions() if f.end_lineno - f.lineno > 75]
    assert long == []


def test_every_documented_argument_exists():
    """An Args section names only arguments that the function has."""
    made_up = {
        f"{name}: {f.name}": extra for name, f in functions() if (extra := without_argument(f))
    }
    assert made_up == {}


def without_argument(function: ast.FunctionDef) -> set[str]:
    """Names of its Args section that are no arguments."""
    lines = (ast.get_docstring(function) or "").split("\n")
    if "Args:" not in lines:
        return set()
    section = lines[lines.index("Args:") + 1 :]
    end = next((i for i, line in enumerate(section) if not line.startswith("    ")), len(section))
    named = {
        line.strip().split(":")[0]
        for line in section[:end]
        if line.startswith("    ") and not line.startswith("     ")
    }
    arguments = {a.arg for a in [*function.args.args, *function.args.kwonlyargs]}
    if function.args.vararg is not None:
        arguments.add(f"*{function.args.vararg.arg}")
    return named - arguments

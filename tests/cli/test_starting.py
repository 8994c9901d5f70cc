"""What starting costs and risks: what is loaded for which command, Ctrl-C meanwhile, and what is said of compiling."""

import ast
import inspect
import json
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import lightcube
from lightcube import io
from lightcube.cli import console, main
from lightcube.optics.cube import Cube
from lightcube.optics.grid import Grid
from lightcube.optics.setups import turntable

#: What takes long to load.
HEAVY = {"numba", "scipy", "zarr", "av", "matplotlib", "distributed"}
PRESSED = (130, "", "interrupted: no file was finished\n")
#: Loads the command line in a program that then names what it has loaded.
LISTING = """
import atexit, sys
atexit.register(lambda: sys.stderr.write("|" + " ".join(name for name in sys.modules if "." not in name)))
from lightcube.__main__ import main
main()
"""
#: Runs several commands in turn, and names the heads of all modules that are loaded after each.
LISTING_EACH = """
import json, sys
from lightcube.__main__ import main
for words in json.loads(sys.argv[1]):
    sys.argv[1:] = words
    try:
        main()
    except SystemExit as done:
        sys.stderr.write("|" + json.dumps([done.code, [name for name in sys.modules if "." not in name]]) + "\\n")
"""


def called(*words: object, **environment: str) -> tuple[int, str, str]:
    """Exit code, output and errors of the program, as people start it."""
    done = subprocess.run(
        [sys.executable, "-m", "lightcube", *map(str, words)],
        capture_output=True,
        text=True,
        env={**os.environ, **environment},
    )
    return done.returncode, done.stdout, done.stderr


def loaded(program: str, *words: object) -> tuple[int, set[str]]:
    """Exit code of a program and the packages that it has loaded in the end."""
    done = subprocess.run([sys.executable, "-c", program, *map(str, words)], capture_output=True, text=True)
    assert "Traceback" not in done.stderr
    return done.returncode, set(done.stderr.rpartition("|")[2].split())


def loaded_by_each(asked: Sequence[Sequence[str]]) -> list[tuple[int, set[str]]]:
    """As `loaded` by commands of one program, which starts once: what the first has loaded is there for all others."""
    words = [sys.executable, "-c", LISTING_EACH, json.dumps(asked)]
    done = subprocess.run(words, capture_output=True, text=True)
    assert "Traceback" not in done.stderr
    told = [json.loads(line[1:]) for line in done.stderr.splitlines() if line.startswith("|")]
    assert len(told) == len(asked)
    return [(code, set(found)) for code, found in told]


@pytest.fixture
def cube(tmp_path: Path) -> Path:
    grid = Grid((2, 3, 4))
    return io.save(Cube(np.ones((3, 2, 3, 4), np.float32), grid, turntable(grid, [10.0])), tmp_path / "cube.npz")


def test_the_package_loads_nothing_but_itself() -> None:
    code, found = loaded("import sys, lightcube; sys.stderr.write('|' + ' '.join(sys.modules))")
    assert code == 0
    assert "lightcube" in found
    assert not found & {*HEAVY, "numpy", "skimage", "pydantic", "PIL", "typer", "rich"}


@pytest.mark.parametrize("words", [("--help",), ("--version",), ("-h",), (), ("juggle",), ("--magic",)], ids=str)
def test_what_names_no_command_loads_none(words: tuple[str, ...]) -> None:
    code, found = loaded(LISTING, *words)
    assert code == (2 if words in (("juggle",), ("--magic",)) else 0)
    assert not found & {*HEAVY, "numpy", "skimage", "PIL"}


def test_help_of_a_command_and_options_that_it_lacks_load_no_compiler() -> None:
    asked = [(name, option) for name in main.COMMANDS for option in ("--help", "--magic")]
    for words, (code, found) in zip(asked, loaded_by_each(asked), strict=True):
        assert code == (0 if "--help" in words else 2), words
        assert not found & HEAVY, words


def test_what_cannot_be_is_said_before_a_compiler_is_loaded(cube: Path, tmp_path: Path) -> None:
    asked = [
        ("info", "{tmp}/none.zarr"),
        ("play", "{tmp}/none.zarr", "-o", "{tmp}/a.mp4"),
        ("play", "{cube}", "-o", "{tmp}/a.doc"),
        ("play", "{cube}", "-o", "{tmp}/a.gif", "--view", "room", "--picture-only"),
        ("view", "{tmp}/none.zarr", "-o", "{tmp}/a.html"),
        ("report", "{tmp}/none.npz", "-o", "{tmp}/a.html"),
        ("score", "{tmp}/none.zarr"),
        ("solve", "{tmp}/none", "-o", "{tmp}/a.zarr"),
        ("solve", "{tmp}/none", "-o", "{tmp}/a.zarr", "--method", "magic"),
        ("check", "{tmp}/none"),
        ("check", "{tmp}/none.toml"),
        ("draw", "{tmp}/none.toml", "-o", "{tmp}/a.svg"),
        ("draw", "{tmp}/none.zarr", "-o", "{tmp}/a.png"),
        ("trace", "{tmp}/none.toml", "-o", "{tmp}/a"),
        ("publish", "{tmp}/none.zarr.partial"),
    ]
    filled = [[word.format(tmp=tmp_path, cube=cube) for word in words] for words in asked]
    for words, (code, found) in zip(asked, loaded_by_each(filled), strict=True):
        assert code == 2, words
        assert not found & HEAVY, words


def test_what_is_in_a_cube_is_said_without_a_compiler(cube: Path) -> None:
    code, found = loaded(LISTING, "info", cube)
    assert code == 0
    assert not found & {*HEAVY, "PIL", "lightcube.backward", "lightcube.pictures"}  # nor how cubes are made


def test_the_version_is_that_of_the_package() -> None:
    assert called("--version") == (0, f"lightcube {version('lightcube')}\n", "")


def test_the_script_and_the_module_are_one_entry() -> None:
    declared = (Path(__file__).parents[2] / "pyproject.toml").read_text()
    assert '[project.scripts]\nlightcube = "lightcube.__main__:main"\n' in declared
    assert called("--help")[1].startswith("Usage: lightcube [OPTIONS] COMMAND")


@pytest.mark.parametrize("name", main.COMMANDS)
def test_the_list_of_commands_says_what_each_says_of_itself(name: str) -> None:
    said, _, _ = str(inspect.getdoc(getattr(import_module(f"lightcube.cli.{name}"), name))).partition("\n\n")
    assert main.COMMANDS[name] == said


def test_a_word_that_is_almost_a_command_is_answered_with_it() -> None:
    assert "Did you mean 'solve'" in called("slove")[2]


@pytest.mark.parametrize("package", [lightcube, io], ids=lambda package: package.__name__)
def test_a_package_and_its_stub_name_the_same(package: ModuleType) -> None:
    assert package.__file__ is not None
    stub = ast.parse(Path(package.__file__).with_suffix(".pyi").read_text())
    imported = {
        alias.name: node.module for node in stub.body if isinstance(node, ast.ImportFrom) for alias in node.names
    }
    listed = next(ast.literal_eval(node.value) for node in stub.body if isinstance(node, ast.Assign))
    assert sorted(imported) == sorted(listed) == sorted(package.__all__)
    assert {*package.__all__} <= {*dir(package)}
    for name, module in imported.items():
        assert getattr(package, name) is getattr(import_module(str(module)), name)


def test_a_name_that_is_none_is_said_to_be_missing() -> None:
    with pytest.raises(AttributeError, match="module 'lightcube' has no attribute 'juggle'"):
        _ = lightcube.juggle  # type: ignore[attr-defined]


@pytest.mark.skipif(os.name != "posix", reason="signals are sent as a terminal does on POSIX")
@pytest.mark.parametrize("slow", ["typer", "rich.console", "numpy", "lightcube.cli.main", "lightcube.cli.play"])
def test_ctrl_c_while_modules_load_is_one_line(slow: str, tmp_path: Path) -> None:
    """SIGINT comes in the middle of an import, from which an exception would be a traceback of somebody else's code."""
    (tmp_path / "sitecustomize.py").write_text(
        f"""
import builtins, signal
real = builtins.__import__

def slow(name, *rest, **more):
    if name == {slow!r} and signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        signal.raise_signal(signal.SIGINT)
    return real(name, *rest, **more)

builtins.__import__ = slow
import importlib
load = importlib.import_module
importlib.import_module = lambda name, *rest: slow(name) and load(name, *rest)
"""
    )
    place = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])])
    assert called("play", tmp_path / "none.zarr", "-o", tmp_path / "a.gif", PYTHONPATH=place) == PRESSED


@pytest.mark.skipif(os.name != "posix", reason="signals are sent as a terminal does on POSIX")
def test_ctrl_c_from_outside_while_modules_load_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "numpy.py").write_text("import time\nprint('loading', flush=True)\ntime.sleep(60)\n")
    place = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])])
    command = [sys.executable, "-m", "lightcube", "play", "none.zarr", "-o", "a.gif"]
    environment = {**os.environ, "PYTHONPATH": place}
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "loading\n"
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    assert (process.returncode, out, err) == PRESSED


@pytest.mark.skipif(os.name != "posix", reason="signals are sent as a terminal does on POSIX")
def test_who_starts_the_program_may_have_it_ignore_ctrl_c() -> None:
    program = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)\nfrom lightcube.__main__ import main\n"
    program += "import lightcube.cli.main as line\n"
    program += "line.run = lambda words: signal.raise_signal(signal.SIGINT) or 0\nmain()"
    assert subprocess.run([sys.executable, "-c", program]).returncode == 0


@pytest.mark.skipif(os.name != "posix", reason="signals are sent as a terminal does on POSIX")
def test_the_code_is_130_where_ctrl_c_comes_out_of_an_exec(tmp_path: Path) -> None:
    """As dataclasses and numba use it: Python remembers that, and a module that is run would end by the signal."""
    program = "import sys\nfrom lightcube.__main__ import main\nfrom lightcube.cli import main as line\n"
    program += "line.err.print = lambda text: sys.stderr.write(text + chr(10))\n"  # rich loads with execs of its own
    program += "line.application = lambda words: lambda **_: exec('import signal; signal.raise_signal(2)')\nmain()"
    (tmp_path / "program.py").write_text(program)
    done = subprocess.run([sys.executable, "-m", "program"], capture_output=True, text=True, cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == PRESSED


def test_compiling_is_said_once_and_not_to_machines(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    numba = pytest.importorskip("numba")
    if numba.config.DISABLE_JIT:
        pytest.skip("nothing is compiled")
    console._say_compiling.cache_clear()

    def compiled(*, as_json: bool) -> str:
        with console.compiling(as_json=as_json):
            for _ in range(2):
                numba.njit(lambda x: x + 1)(1)
        return capsys.readouterr().err

    assert compiled(as_json=True) == ""
    assert compiled(as_json=False) == "compiling, once: about 30 s\n"
    assert compiled(as_json=False) == ""


#: A function that C calls back, of LLVM's bindings by its name, in which a signal comes; then a second of other work.
CALLED_BACK = """
import ctypes, signal, sys, time
from lightcube.__main__ import main
from lightcube.cli import main as line

def run(words):
    line.prepare()
    exec(
        "import ctypes, signal\\n"
        "called = ctypes.CFUNCTYPE(None)(lambda: signal.raise_signal(signal.{name}))\\n"
        "called()",
        {{"__name__": "llvmlite.binding.executionengine"}},
    )
    try:
        time.sleep(5)
    except KeyboardInterrupt:
        return 130
    return 0

line.run = run
main()
"""


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_ctrl_c_in_what_compiled_code_calls_back_is_not_forgotten(name: str) -> None:
    """There Python prints an exception and goes on."""
    done = subprocess.run(
        [sys.executable, "-c", CALLED_BACK.format(name=name)], capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 130, done.stderr
    assert done.stderr == ""

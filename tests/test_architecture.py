"""Who may import whom, who may touch files and print, and the list of public names."""

import ast
import sys
from pathlib import Path
from types import ModuleType

import pytest

import lightcube
import lightcube.io

PACKAGE = Path(lightcube.__file__).parent
MODULES = sorted(PACKAGE.rglob("*.py"))

#: Rooms from the ground up: a file imports from its own room and from lower storeys, never from a neighbour.
STOREYS = [
    ["errors", "events", "kernels", "loading", "wording"],
    ["optics"],
    ["pictures", "projection", "solvers"],
    ["scene", "backward", "forward", "solids"],
    ["scoring", "io", "cores"],
    ["planning", "jobs", "drawing", "fabrication", "bench", "calibration"],
    ["viewer", "report"],
    ["verbs", ""],
    ["studio"],
    ["cli"],
    ["__main__"],
]
ALLOWED_IN_KERNELS = {
    *("numpy", "numba", "llvmlite", "math", "typing", "collections.abc", "functools", "threading"),
    *("contextlib", "os", "queue", "warnings"),
}
FILE_AND_SCREEN = {
    *("pathlib", "os", "shutil", "tempfile", "rich", "typer", "av", "tifffile", "zarr", "matplotlib", "fsspec"),
    "pi_heif",
}
#: A plot is made without being shown or written; of the system, kernels want the environment, and to know of forks.
HARMLESS = {"lightcube.drawing.plots": {"matplotlib"}, "lightcube.kernels": {"os"}, "lightcube.kernels.tasks": {"os"}}


def room(dotted: str) -> str:
    """The first name below ``lightcube``."""
    return dotted.split(".")[1] if dotted.startswith("lightcube.") else ""


def storey(name: str) -> int:
    return next(level for level, names in enumerate(STOREYS) if name in names)


def imports(file: Path) -> set[str]:
    """What a file imports; a package whose names load when they are used has a stub that says what they are."""
    found: set[str] = set()
    texts = [text.read_text() for text in (file, file.with_suffix(".pyi")) if text.is_file()]
    for node in (node for text in texts for node in ast.walk(ast.parse(text))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file}: relative import"
            module = node.module or ""
            found |= {f"{module}.{name.name}" if is_module(f"{module}.{name.name}") else module for name in node.names}
    return found


def is_module(name: str) -> bool:
    """Whether there is a file or a folder of the package for a dotted name."""
    place = PACKAGE.joinpath(*name.split(".")[1:])
    return name.startswith("lightcube.") and (place.with_suffix(".py").is_file() or place.is_dir())


def dotted(file: Path) -> str:
    return ".".join(["lightcube", *file.relative_to(PACKAGE).with_suffix("").parts]).removesuffix(".__init__")


def is_kernel(file: Path) -> bool:
    return "kernels" in file.relative_to(PACKAGE).parts


@pytest.mark.parametrize("file", MODULES, ids=dotted)
def test_imports_run_downhill(file: Path) -> None:
    own = room(dotted(file))
    for name in imports(file):
        if name.split(".")[0] == "lightcube":
            assert room(name) == own or storey(room(name)) < storey(own), f"{dotted(file)} imports {name}"


def test_files_of_a_room_form_no_circle() -> None:
    known = {dotted(file): {name for name in imports(file) if name.startswith("lightcube.")} for file in MODULES}
    left = {file: names & set(known) - {file} for file, names in known.items()}
    while left:
        free = {file for file, names in left.items() if not names & set(left)}
        assert free, f"a circle among {', '.join(sorted(left))}"
        left = {file: names for file, names in left.items() if file not in free}


@pytest.mark.parametrize("file", [file for file in MODULES if is_kernel(file)], ids=dotted)
def test_kernels_import_numpy_and_numba_only(file: Path) -> None:
    for name in imports(file):
        assert ALLOWED_IN_KERNELS & {name, name.split(".")[0]} or ".kernels" in name, f"{dotted(file)} imports {name}"


def test_solvers_never_import_the_projector() -> None:
    for file in (PACKAGE / "solvers").glob("*.py"):
        assert not any("projector" in name for name in imports(file)), file


@pytest.mark.parametrize("file", MODULES, ids=dotted)
def test_only_the_upper_rooms_touch_files_and_print(file: Path) -> None:
    if storey(room(dotted(file))) >= storey("io"):
        return
    forbidden = FILE_AND_SCREEN - HARMLESS.get(dotted(file), set())
    assert not {name.split(".")[0] for name in imports(file)} & forbidden
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            assert node.func.id not in ("open", "print"), f"{dotted(file)} line {node.lineno}"


def test_every_module_has_a_room() -> None:
    rooms = {room(dotted(file)) for file in MODULES}
    assert rooms - {""} == {name for names in STOREYS for name in names} - {""}
    assert {name.split(".")[0] for file in MODULES for name in imports(file)} <= {
        *sys.stdlib_module_names,
        *("lightcube", "numpy", "scipy", "numba", "skimage", "PIL", "av", "tifffile", "zarr", "typer", "click", "rich"),
        *("pydantic", "pydantic_core", "matplotlib", "fsspec", "llvmlite", "torch", "astra", "dask", "distributed"),
        "pi_heif",
        *("anywidget", "traitlets"),
        "reportlab",
        *("fastapi", "uvicorn", "starlette"),
    }


@pytest.mark.parametrize("package", [lightcube, lightcube.io], ids=lambda package: package.__name__)
def test_the_stub_lists_the_public_names_and_each_is_explained(package: ModuleType) -> None:
    stub = ast.parse(Path(str(package.__file__)).with_suffix(".pyi").read_text())
    listed = next(node.value for node in stub.body if isinstance(node, ast.Assign))
    assert sorted(package.__all__) == sorted(ast.literal_eval(listed))
    for name in package.__all__:
        assert name == "METHODS" or getattr(package, name).__doc__, name

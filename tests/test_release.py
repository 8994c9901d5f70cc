"""Releases are tried with every Python that is here, whoever keeps it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

FIND = Path(__file__).parent.parent / ".ci" / "python"
ABLE = f'#!/bin/sh\nexec {sys.executable} "$@"\n'


def program(path: Path, text: str) -> Path:
    """Write something that can be run."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    path.chmod(0o755)
    return path


def find(version: str, *folders: Path) -> subprocess.CompletedProcess[str]:
    """Look for a Python with these folders before the system's own."""
    environment = {"PATH": ":".join([*map(str, folders), "/usr/bin", "/bin"]), "HOME": os.environ.get("HOME", "/")}
    return subprocess.run([FIND, version], env=environment, capture_output=True, text=True, check=False)


@pytest.mark.skipif(os.name != "posix", reason="a script of the shell")
def test_a_python_is_found_by_its_name_and_where_uv_and_pyenv_keep_it(tmp_path: Path) -> None:
    named = program(tmp_path / "named" / "python3.97", ABLE)
    assert find("3.97", named.parent).stdout.split() == [str(named)]

    kept = program(tmp_path / "kept" / "bin" / "python", ABLE)
    uv = program(
        tmp_path / "uv" / "uv", f'#!/bin/sh\ncase "$*" in "python find"*3.98) echo {kept};; *) exit 2;; esac\n'
    )
    assert find("3.98", uv.parent).stdout.split() == [str(kept)]

    at = program(tmp_path / "root" / "versions" / "3.99.4" / "bin" / "python", ABLE)
    says = f'case "$*" in "latest 3.99") echo 3.99.4;; root) echo {tmp_path / "root"};; *) exit 1;; esac'
    pyenv = program(tmp_path / "pyenv" / "pyenv", f"#!/bin/sh\n{says}\n")
    shim = program(tmp_path / "shims" / "python3.99", "#!/bin/sh\nexit 127\n")  # pyenv's, for what is not chosen
    assert find("3.99", shim.parent, uv.parent, pyenv.parent).stdout.split() == [str(at)]


@pytest.mark.skipif(os.name != "posix", reason="a script of the shell")
def test_a_python_that_is_not_there_or_cannot_make_environments_is_not_taken(tmp_path: Path) -> None:
    bare = program(tmp_path / "python3.97", f'#!/bin/sh\nexec {sys.executable} -c "import no_such_package"\n')
    done = find("3.97", bare.parent)
    assert done.returncode == 1
    assert done.stdout == ""
    assert "there is no Python 3.97" in done.stderr

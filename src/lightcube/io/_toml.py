"""Reading TOML files."""

import re
import tomllib
from pathlib import Path
from typing import Any

from lightcube.errors import InputError
from lightcube.io._bounds import check_file
from lightcube.io._files import system_errors

#: More than a file that people write ever has; and tables in tables, where reading a key takes time with their square.
_MOST_BYTES, _MOST_PARTS = 1 << 20, 32
#: Reading takes time with what stands between values and the parts of keys; ten thousand pictures of a stage have half.
_MARKS, _MOST_MARKS = b"=,.[", 200_000
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"
_PART = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')"""
_DEEP_KEY = re.compile(rf"(?:^|[{{,\[])[ \t]*+{_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{_MOST_PARTS},}}", re.MULTILINE)


def read_tables(file: Path, called: str) -> dict[str, Any]:
    """The tables of a TOML file, which may begin with a byte order mark; sentences name it as it is `called`.

    Raises
    ------
    InputError
        Where the file cannot be read, is too large, or is not TOML.
    """
    with system_errors(file, "reading"), check_file(file).open("rb") as opened:
        data = opened.read(_MOST_BYTES + 1)
    if len(data) > _MOST_BYTES:
        raise InputError(f"{called} is larger than {_MOST_BYTES >> 20} MiB: make it shorter")
    if sum(map(data.count, _MARKS)) > _MOST_MARKS:
        raise InputError(f"{called} holds more values and keys than one of 10,000 pictures: make it shorter")
    try:
        text = data.removeprefix(_BYTE_ORDER_MARK).decode("utf-8")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise InputError(f"{called} is not a TOML file: line {line} is not in UTF-8, save it as UTF-8") from None
    if "\0" in text:
        raise InputError(f"{called} is not a TOML file: it holds bytes of 0, save it as UTF-8")
    if _DEEP_KEY.search(text):
        raise InputError(f"{called} is not a TOML file for us: a key of it has more than {_MOST_PARTS} dots")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{called} is not a TOML file: {error}") from None
    except RecursionError:
        raise InputError(f"{called} is not a TOML file for us: lists or tables in it are nested too deep") from None
    except ValueError:  # Python makes no number of thousands of digits
        raise InputError(f"{called} is not a TOML file for us: a number in it has thousands of digits") from None

"""The one exception whose message is written for the person at the keyboard, and names as text that is safe to show."""

import re
from unicodedata import category

#: Who asks, in a URL: up to the last @ before its path, or behind a colon in a path too, where that is no port.
_LOGIN = re.compile(r"(?<=://)(?:[^\s/?#]*@|[^\s/?#:@]*:(?!\d*/)[^\s@]*@)")
#: What is asked for, in a URL: signed ones have keys there. What ends a sentence is no part of it.
_QUERY = re.compile(r"(://[^\s?#]*\?)[^\s'\"<>]*[^\s'\"<>:,;.)]")


def shown(text: str) -> str:
    r"""`text` with nothing in it that a terminal or a reader could be led astray by.

    Control characters, line ends, marks that reverse the direction of writing or have no width, and bytes of a file's
    name that are no UTF-8 are written as Python writes them: ``\x1b``, ``\u202e``. Names, passwords and queries of URLs
    are left out.
    """
    text = without_secrets(text)
    if text.isprintable():
        return text
    return "".join(each if each.isprintable() or category(each) == "Zs" else _escaped(each) for each in text)


def without_secrets(text: str) -> str:
    """`text` with three stars in place of the names, passwords and queries in its URLs."""
    return _QUERY.sub(r"\1***", _LOGIN.sub("***@", text)) if "://" in text else text


def encodable(text: str) -> str:
    r"""`text` as files can hold it: bytes of a file's name that are no UTF-8 are written as ``\xff``."""
    return text if text.isascii() else "".join(_escaped(each) if category(each) == "Cs" else each for each in text)


def _escaped(letter: str) -> str:
    code = ord(letter)
    if 0xDC80 <= code <= 0xDCFF:  # where Python keeps a byte of a name that it cannot read (PEP 383)
        return f"\\x{code - 0xDC00:02x}"
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


class InputError(ValueError):
    """Something the user gave cannot be used.

    The message is one sentence: what is wrong, where (file, key, value), and what to do about it; names in it are
    safe to show. The command line prints it as it is and exits with code 2.
    """

    def __init__(self, message: str) -> None:
        super().__init__(shown(message))

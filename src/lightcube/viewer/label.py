"""What stands beside a work: what it is called, who made it, and for whom."""

from __future__ import annotations

from dataclasses import dataclass, fields

from lightcube.errors import InputError, encodable
from lightcube.optics.checks import check_fields

#: Letters that each part of a label may have.
_MOST = {"title": 200, "by": 200, "note": 600, "picture": 200}


@dataclass(frozen=True)
class Label:
    """The label of a cube on its page.

    Parameters
    ----------
    title
        What it is called.
    by
        Who made it.
    note
        A dedication, or a word on it.
    picture
        Name of a picture beside the page, which stands for it where its address is shared; empty = none.

    Raises
    ------
    InputError
        Where one of them is longer than 200 letters, or the note than 600.

    Examples
    --------
    >>> import lightcube as lc
    >>> lc.Label("Eight summers", by="Ada", note="for Bob").title
    'Eight summers'
    """

    title: str
    by: str = ""
    note: str = ""
    picture: str = ""

    def __post_init__(self) -> None:
        check_fields(self)
        for each in fields(self):
            text, most = encodable(getattr(self, each.name)), _MOST[each.name]
            if len(text) > most:
                raise InputError(f"a page's {each.name} has at most {most} letters, not {len(text)}: make it shorter")
            object.__setattr__(self, each.name, text)

    @classmethod
    def of(cls, label: str | Label) -> Label:
        """A label, or one with a title alone."""
        return label if isinstance(label, Label) else cls(label)

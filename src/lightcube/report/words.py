"""Numbers in words, for all parts of a report."""

from typing import Any

from numpy.typing import NDArray


def span(values: NDArray[Any], form: str = "g") -> str:
    """From the least to the largest number, or the one that all are."""
    least, most = f"{values.min():{form}}", f"{values.max():{form}}"
    return least if least == most else f"{least} to {most}"

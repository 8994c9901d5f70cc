"""The figures as tables in Markdown, for the terminal and for docs/performance.md."""

from collections.abc import Iterable, Iterator
from typing import Any


def markdown(found: dict[str, Any]) -> Iterator[str]:
    """Yield the lines."""
    machine, problem = found["machine"], found["problem"]
    yield f"{machine['processor']} ({machine['llvm_name']}, {machine['architecture']}), {machine['cores']} cores, "
    yield f"{', '.join(machine['caches']) or 'caches unknown'}; {machine['system']}, Python {machine['python']}, "
    yield f"NumPy {machine['numpy']}, Numba {machine['numba']}, LLVM {machine['llvm']}."
    yield f"n = {problem['n']}, {problem['views']} views, 3 colours, float32; least of {problem['repeats']} (median)."
    for part in (_ceilings, _kernels, _peers, _playback, _starts):
        yield ""
        yield from part(found)


def _table(head: list[str], rows: Iterable[list[str]]) -> Iterator[str]:
    yield f"| {' | '.join(head)} |"
    yield f"|{'---|' * len(head)}"
    for row in rows:
        yield f"| {' | '.join(row)} |"


def _ceilings(found: dict[str, Any]) -> Iterator[str]:
    rows = [("registers", "registers"), ("l1", "L1, 16 KB"), ("l2", "L2, 512 KB"), ("memory", "memory, 256 MB")]
    table = [
        [f"G multiply-adds/s from {text}", *(f"{each[name] / 1e9:.1f}" for each in found["ceilings"])]
        for name, text in rows
    ]
    table += [
        [f"GB/s, {name}", *(f"{each[name] / 1e9:.1f}" for each in found["ceilings"])] for name in ("read", "triad")
    ]
    return _table(["ceiling", *(_threads(each["threads"]) for each in found["ceilings"])], table)


def _kernels(found: dict[str, Any]) -> Iterator[str]:
    table = [
        [
            name,
            f"{each['elevation_deg']:g}°",
            _threads(each["threads"]),
            _seconds(each[name]),
            f"{each[name]['multiply_adds_per_second'] / 1e9:.1f}",
            f"{each[name]['share_of_l2']:.0%}",
        ]
        for each in found["kernels"]
        for name in ("forward", "adjoint", "pass")
    ]
    return _table(["kernel", "lamp", "", "s", "G multiply-adds/s", "of the rate from L2"], table)


def _peers(found: dict[str, Any]) -> Iterator[str]:
    table = [
        [f"{each['name']} {each['version']}", each["measured"], f"{each['parts']:g}", _seconds(each), _times(each)]
        if each["version"]
        else [each["name"], "absent: pip install 'lightcube[bench]'", "", "", ""]
        for each in found["peers"]
    ]
    return _table(["peer, 1 thread, level lamp", "measured", "times", "s a pass, extrapolated", "of ours"], table)


def _playback(found: dict[str, Any]) -> Iterator[str]:
    threads = _threads(found["machine"]["threads"])
    table = [
        [
            f"{each['columns']} x {each['rows']}",
            f"{each['elevation_deg']:g}°",
            f"{1e3 * each['seconds']:.1f} ({1e3 * each['median']:.1f})",
        ]
        for each in found["playback"]
    ]
    return _table([f"playback, {threads}", "lamp", "ms a picture"], table)


def _starts(found: dict[str, Any]) -> Iterator[str]:
    table = [[f"lightcube {each['command']}", f"{each['seconds']:.2f}"] for each in found["starts"]]
    return _table(["second start", "s"], table)


def _threads(count: int) -> str:
    return "1 thread" if count == 1 else f"{count} threads"


def _seconds(took: dict[str, float]) -> str:
    return f"{took['seconds']:.3g} ({took['median']:.3g})"


def _times(peer: dict[str, float]) -> str:
    return f"{peer['ratio']:.3g} x"

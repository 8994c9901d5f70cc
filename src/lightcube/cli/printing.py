"""What is printed of a solved cube and of its scores."""

from collections import Counter
from collections.abc import Mapping
from typing import Any

from lightcube.backward.solution import Solution
from lightcube.cli.console import out
from lightcube.optics.disturbance import SAID
from lightcube.optics.naming import is_dial, told_apart
from lightcube.optics.rig import Rig
from lightcube.optics.told import remembered
from lightcube.scoring.metrics import grain_word
from lightcube.verbs import words
from lightcube.wording import counted


def facts(solution: Solution) -> dict[str, Any]:
    """How a solver arrived, and how good its cube is, for JSON."""
    return {
        "iterations": len(solution.residuals),
        "residual": float(solution.residuals[-1]),
        "optimality": solution.optimality,
        "stop_reason": solution.stop_reason,
        "rejected": solution.rejected.tolist(),
        "undetermined": solution.undetermined,
        "predicted": remembered(solution.cube).get("predicted"),
        **solution.cube.scores,
    }


def solved(solution: Solution, opening: str, *, verbose: bool) -> None:
    """Print how good a cube is, after an opening; with all figures if `verbose`."""
    scores = solution.cube.scores
    out.print(opening)
    if len(solution.rejected):
        most = Counter(solution.cube.names[view] for view in solution.rejected[:, 0]).most_common(5)
        views = ", ".join(f"{count} in {name}" for name, count in most)
        out.print(f"{counted(len(solution.rejected), 'inconsistent pixel value')} thrown out: {views}")
    if solution.undetermined:
        out.print(f"{solution.undetermined} voxel values that nothing determines are transparent")
    for line in words.solved(solution):
        out.print(line)
    if verbose:
        out.print(
            f"PSNR {scores['psnr_mean']:.1f} dB (worst {scores['psnr_min']:.1f}), SSIM {scores['ssim_mean']:.3f}, "
            f"colour difference {scores['delta_e_mean']:.1f}{_beside(scores)}; "
            f"{counted(len(solution.residuals), 'pass')}"
        )


def _beside(scores: Mapping[str, Any]) -> str:
    """What is known beside the pictures: grain inside pixels, and how calm the mat is."""
    mat = f", mat off by {scores['mat_rms']:.3f}" if "mat_rms" in scores else ""
    return f", {grain_word(scores['grain_rms'])} grain ({scores['grain_rms']:.2f}){mat}"


def scored(scores: dict[str, Any], rig: Rig) -> None:
    """Print one line per view, the means, and what was asked for besides."""
    lobes = scores["between"]["lobe_deg"] if "between" in scores else []
    told = told_apart(rig) if is_dial(rig) else [f"{view['angle_deg']:.3f}" for view in scores["pictures"]]
    head, wide = "shown" if is_dial(rig) else "angle, °", max(9, *map(len, told))
    out.print(f"{'picture':>20} {head:>{wide}} {'PSNR':>7} {'SSIM':>7} {'dE2000':>7}" + " 30 dB over" * bool(lobes))
    for number, view in enumerate(scores["pictures"]):
        figures = f"{told[number]:>{wide}} {view['psnr']:7.2f} {view['ssim']:7.4f} {view['delta_e']:7.2f}"
        lobe = f" {lobes[number]:9.2f}°" if lobes else ""
        out.print(f"{view['name'][:20]:>20} {figures}{lobe}")
    names, psnr = (
        list(each) for each in zip(*((view["name"], view["psnr"]) for view in scores["pictures"]), strict=True)
    )
    out.print(words.judged(names, psnr, "are", rig))
    worst, mean = scores["psnr_min"], scores["psnr_mean"]
    out.print(
        f"mean PSNR {mean:.2f} dB (worst {worst:.2f}), SSIM {scores['ssim_mean']:.4f}, dE {scores['delta_e_mean']:.2f}"
    )
    thin = f"thin beams {scores['thin_psnr_mean']:.2f} dB (worst {scores['thin_psnr_min']:.2f})"
    out.print(f"{thin}{_beside(scores)}")
    for name, left in scores.get("robust", {}).items():
        figures = f"{left['psnr_mean']:6.2f} dB (worst {left['psnr_min']:5.2f})"
        relit = f", relit {left['relit_mean']:5.2f}" if "relit_mean" in left else ""
        out.print(f"  {figures}{relit}  {SAID[name]}")

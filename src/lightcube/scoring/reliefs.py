"""How near the shadows of a relief come to its pictures, in display values, as an eye further or nearer sees them."""

from __future__ import annotations

from typing import Any

import numpy as np

from lightcube.optics.arrays import Reals
from lightcube.optics.checks import checked
from lightcube.optics.transfer import encode
from lightcube.scoring import metrics
from lightcube.solids.relief import Relief
from lightcube.solids.relief_light import shown

#: How far an eye blurs, in columns, by the name of the figures: near by, and from where the plate looks like a picture.
BLURS = {"near": 1.0, "far": 2.0}
#: How all lamps may stand wrong: round and up, degrees.
OFF_DEG = {"2 deg round": (2.0, 0.0), "5 deg round": (5.0, 0.0), "3 deg higher": (0.0, 3.0), "3 deg lower": (0.0, -3.0)}


@checked
def score_relief(relief: Relief, *, off: bool = False) -> dict[str, Any]:
    """Compare what a relief shows under its lamps with what was wanted.

    Light is cast anew, at 55 points of each column; both pictures are blurred in linear light as an eye does it, by
    one column's side (``near``) and by two (``far``), and compared in display values.

    Parameters
    ----------
    off
        Whether lamps that all stand a little wrong are asked for too.

    Returns
    -------
    ``psnr_mean, psnr_min, ssim_mean`` (far), ``near_psnr_mean, near_psnr_min, near_ssim_mean``, ``pictures``, a list of
    ``name, azimuth_deg, psnr, ssim, near_psnr, near_ssim`` of each, ``black``, the display value of black, and
    ``off``, the mean PSNR by what is wrong.
    """
    light = shown(relief)
    far, near = (compared(relief, light, blur) for blur in (BLURS["far"], BLURS["near"]))
    pictures = [
        {"name": name, "azimuth_deg": azimuth, "psnr": p, "ssim": s, "near_psnr": near_p, "near_ssim": near_s}
        for name, azimuth, (p, s), (near_p, near_s) in zip(relief.names, relief.azimuths_deg, far, near, strict=True)
    ]
    found: dict[str, Any] = {}
    for opening, figures in (("", far), ("near_", near)):
        psnr, ssim = np.array(figures).T
        found |= {f"{opening}psnr_mean": float(psnr.mean()), f"{opening}psnr_min": float(psnr.min())}
        found[f"{opening}ssim_mean"] = float(ssim.mean())
    found |= {"pictures": pictures, "black": relief.recipe.black}
    if off:
        found["off"] = {
            what: float(np.mean(compared(relief, shown(relief, wrong), BLURS["far"]), axis=0)[0])
            for what, wrong in OFF_DEG.items()
        }
    return found


def compared(relief: Relief, light: Reals, blur: float) -> list[tuple[float, float]]:
    """PSNR and SSIM of each picture ``(row, column)`` of linear light, blurred by so many columns."""
    pairs = zip(blurred(relief, light, blur), blurred(relief, relief.wanted, blur), strict=True)
    weight = np.ones(light.shape[1:])
    found = []
    for picture, wanted in pairs:
        both = encode(picture)[..., None], encode(wanted)[..., None]
        found.append((metrics.psnr(*both, weight), metrics.ssim(*both, weight)))
    return found


def blurred(relief: Relief, light: Reals, blur: float) -> Reals:
    """Linear light ``(picture, row, column)`` of a relief's pixels as an eye sees it that blurs so many columns."""
    from scipy.ndimage import gaussian_filter

    return np.asarray(gaussian_filter(light, (0.0, blur / relief.cell, blur / relief.cell)))

"""AVIF and HEIC, the kinds of pictures that not every Pillow reads by itself."""

from pathlib import Path

from PIL import features

from lightcube.errors import InputError

#: What cameras and telephones write.
SUFFIXES = (".avif", ".heic", ".heif")


def learn(path: Path) -> None:
    """See that Pillow reads the kind of `path`; `InputError` where something is missing for it."""
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        return
    if suffix == ".avif":
        if not features.check("avif"):
            raise InputError(f"{path} is an AVIF, which this Pillow does not read: pip install --upgrade pillow")
        return
    try:
        from pi_heif import register_heif_opener
    except ImportError:
        raise InputError(f"{path} is a HEIC, which takes one more package: pip install 'lightcube[heif]'") from None
    register_heif_opener()

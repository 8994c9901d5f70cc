"""How a command's help is laid out, options in groups and examples at the end, and what it says of missing words."""

from collections.abc import Mapping, Sequence
from typing import Any

import typer
from typer.core import TyperCommand

from lightcube.errors import InputError

#: The groups in the order in which they are shown: beside what may be said of a cube, where it goes and who computes.
GROUPS = ("Output", "Pictures", "Geometry", "Lamp", "Material", "Quality", "Machine")
#: What a command's own options stand under that are in no group.
_OTHERS = "Options"

#: By command: what one might type, and what it is for.
EXAMPLES: Mapping[str, Sequence[tuple[str, str]]] = {
    "studio": [
        ("lightcube studio holidays", "a project in the folder holidays, new or old"),
        ("lightcube studio holidays --port 8080 --no-browser", "at a port of your choice, for a bookmark"),
    ],
    "solve": [
        ("lightcube solve photos -o cube.zarr", "a folder of photographs, all else is chosen"),
        ("lightcube solve photos -o cube.zarr --n 64 --quality draft", "smaller and quicker, to try"),
        ("lightcube solve photos -o cube.zarr --size-mm 60 --lamp-max 4", "60 mm wide, for a weaker lamp"),
        ("lightcube solve photos -o cube.zarr --material polyjet", "of resins that a printer mixes"),
        ("lightcube solve photos -o cube.zarr --dry-run", "how much memory and time it takes"),
    ],
    "check": [
        ("lightcube check photos", "how good they will be, and what would help"),
        (
            "lightcube check photos --sheet wanted.png --focus 0.5,0.3",
            "look at what will be cropped, a little higher up",
        ),
        ("lightcube check photos --n 64 --lamp-max 4", "the same of a smaller cube and a weaker lamp"),
        (
            "lightcube check front.png side.png top.png --opaque --walls --map why",
            "why a word cannot be built",
        ),
    ],
    "hull": [
        ("lightcube hull front.png side.png top.png --walls -o word.stl", "three letters for three walls"),
        (
            "lightcube hull letters --walls --placement best --overlay bent.png -o a.3mf",
            "a word, and how it was bent",
        ),
        (
            "lightcube hull photos --elevation-deg 0 --span-deg 360 -o a.3mf",
            "an object on a turntable, all around",
        ),
        ("lightcube hull room.toml -o a.shape.zarr", "any lamps and screens, kept with its silhouettes"),
    ],
    "carve": [
        ("lightcube carve word.shape.zarr -o lace.stl --carve lace", "a lace of what was made as a whole"),
        (
            "lightcube carve word.shape.zarr -o less.shape.zarr --carve lace --where ball.stl",
            "only where a mesh of yours lies over it",
        ),
        ("lightcube carve word.shape.zarr -o less.stl --ray front,40,52", "what one ray of light does not need"),
        ("lightcube carve less.shape.zarr -o word.stl --undo-to hull", "the whole of it again"),
    ],
    "trace": [
        ("lightcube trace carousel -o pictures", "a scene that comes with lightcube, as a folder of PNGs"),
        ("lightcube trace scene.toml -o film.mp4 --count 64", "a scene of your own, as a movie"),
    ],
    "play": [
        ("lightcube play cube.zarr -o turn.mp4", "the table turns, and rests at each picture"),
        ("lightcube play cube.zarr -o pictures --stops", "just the pictures, as a folder of PNGs"),
    ],
    "score": [
        ("lightcube score cube.zarr", "how near each picture comes"),
        ("lightcube score cube.zarr photos --sheet sheet.png", "wanted, shown and the difference, as one picture"),
        ("lightcube score print cube.zarr", "what a folder of exported slices would cast"),
        ("lightcube score cube.zarr --robust", "what is left where lamp and wall are a little off"),
        ("lightcube score word.stl front.png side.png top.png --walls", "what any mesh casts beside pictures"),
    ],
    "relief": [
        ("lightcube relief a.jpg b.jpg c.jpg d.jpg -o plate.stl --sheet sheet.png", "four photographs in one plate"),
        ("lightcube relief photo.jpg -o plate.3mf --colour", "one photograph in colour, by three coloured lamps"),
        ("lightcube relief a.png b.png -o plate.stl --layer-mm 0.2", "heights that the printer makes exactly"),
    ],
    "materials": [
        ("lightcube materials", "those that come along"),
        ("lightcube materials show polyjet", "what its resins absorb, and which colours they make"),
        ("lightcube materials import pixestl:palette.json -o pla.toml --only Cyan,Magenta,Yellow", "filaments"),
    ],
    "calibrate": [
        ("lightcube calibrate wedge -o wedge.png", "a page to print"),
        ("lightcube calibrate fit photo.jpg -o inkjet.toml", "its photograph, and what the inks are"),
        ("lightcube calibrate fit densities.csv -o inkjet.toml", "the same of densities that were typed"),
    ],
    "export": [
        ("lightcube export volume cube.zarr -o cube.vdb", "for Blender"),
        (
            "lightcube export polyjet cube.zarr -o print --resins polyjet --dry-run",
            "what slices would be",
        ),
        ("lightcube export schedule cube.zarr -o show.csv", "when the table turns, and how bright lamps are"),
    ],
    "draw": [
        ("lightcube draw cube.zarr -o room.png", "the room, at the cube's first stop"),
        ("lightcube draw room.toml -o room.svg", "a stage from above and from the side"),
    ],
}


class Laid(TyperCommand):
    """A command whose help has groups and examples, and which says what to do where words lack or are too many."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """What is left of the words: nothing, or `InputError`."""
        ctx.allow_extra_args = True  # they are refused below, with what to do
        try:
            left = super().parse_args(ctx, args)
        except typer.TyperException as error:
            said, examples = error.format_message(), EXAMPLES.get(str(self.name))
            if examples is None or not said.startswith("Missing "):
                raise
            raise InputError(f"{said.rstrip('.')}: give it, as in {examples[0][0]}") from error
        if left and not ctx.resilient_parsing:
            raise InputError(self._too_many(left))
        return left

    def _too_many(self, left: list[str]) -> str:
        """What is said of words that are left."""
        over = f"{', '.join(left)} {'is' if len(left) == 1 else 'are'} too much for lightcube {self.name}"
        if any(each.name == "pictures" for each in self.params):
            return f"{over}, which takes pictures from one place: put all of them into one folder, and give that"
        return f"{over}: leave it out, or see lightcube {self.name} --help"

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write arguments, options by groups, and last how help is asked for."""
        parameters = self.get_params(ctx)
        about: dict[str, list[tuple[str, str]]] = {}
        for parameter in parameters:
            record = parameter.get_help_record(ctx)
            if record is not None:
                argument = parameter.param_type_name == "argument"
                about.setdefault("Arguments" if argument else group_of(parameter), []).append(record)
        asked = about.get(_OTHERS, [])[-1:]  # --help itself is the last of all
        del about.get(_OTHERS, asked)[-1:]
        shown = [name for name in ("Arguments", _OTHERS, *GROUPS) if about.get(name)]
        about.setdefault(shown[-1], []).extend(asked)
        for name in shown:
            with formatter.section(name):
                formatter.write_dl(about[name])

    def format_epilog(self, ctx: Any, formatter: Any) -> None:
        """Write examples, each as it is typed."""
        examples = EXAMPLES.get(str(self.name), ())
        if examples:
            with formatter.section("Examples"):
                for typed, said in examples:
                    formatter.write(f"  # {said}\n  {typed}\n")


def group_of(parameter: Any) -> str:
    """The group that an option stands in."""
    return getattr(parameter, "rich_help_panel", None) or _OTHERS

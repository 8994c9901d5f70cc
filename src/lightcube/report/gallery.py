"""One page that shows several cubes: a picture of each, what there is to be seen, and where it is turned by hand."""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from lightcube.report.html import element, image, text
from lightcube.report.page import POLICY


@dataclass(frozen=True, eq=False)
class Card:
    """A cube on the page.

    Parameters
    ----------
    title, said
        What it is, and a sentence or two on what there is to be seen.
    picture
        ``(row, column, 3)`` levels.
    page
        The name of the page beside this one in which it is turned.
    """

    title: str
    said: str
    picture: NDArray[np.uint8]
    page: str


def gallery(title: str, lead: str, cards: Sequence[Card], commands: Sequence[str]) -> str:
    """The text of a page with cards, and below them the commands that make one's own."""
    shown = "\n".join(_card(card) for card in cards)
    own = element("pre", text("code", "\n".join(commands)))
    body = "\n".join(
        [
            text("h1", title),
            text("p", lead, class_="lead"),
            element("div", shown, class_="gallery"),
            text("h2", "Make your own"),
            text("p", "Put some photographs into a folder. The first line makes the cube, the second one its page."),
            own,
        ]
    )
    head = "\n".join(
        [
            '<meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">',
            text("title", title),
            element("style", files("lightcube.report").joinpath("style.css").read_text(encoding="utf-8")),
        ]
    )
    inside = element("head", f"\n{head}\n") + "\n" + element("body", f"\n{element('main', body)}\n")
    return "<!doctype html>\n" + element("html", f"\n{inside}\n", lang="en") + "\n"


def _card(card: Card) -> str:
    """A picture that leads to the cube's page, its title and what is said of it."""
    picture = element("a", image(card.picture, card.title, exact=False), href=card.page)
    title = element("h3", text("a", card.title, href=card.page))
    return element("article", picture + title + text("p", card.said), class_="exhibit")

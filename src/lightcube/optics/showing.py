"""Who shows a cube in a notebook: what can draw one stands above the cube, and says so here."""

TYPE_CHECKING = False  # this loads with the package itself, which leaves out even `typing`
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

#: Makes of a cube what a notebook shows, by MIME type; None = its text alone is shown.
by: "Callable[[Any], dict[str, Any]] | None" = None

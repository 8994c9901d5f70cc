"""Formulas as MathML, which browsers draw by themselves: nothing is fetched, and nothing runs, when a page is read."""

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator


def _within(page: HTML5Translator, node: nodes.math) -> None:
    page.body.append(tex2mathml(node.astext()))
    raise nodes.SkipNode


def _apart(page: HTML5Translator, node: nodes.math_block) -> None:
    page.body.append(f'<div class="math">{tex2mathml(node.astext(), as_block=True)}</div>\n')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer by the name `mathml`."""
    app.add_html_math_renderer("mathml", (_within, None), (_apart, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}

"""How the site is built: `make docs` writes it to out/site."""

import sys
import tomllib
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))

project = "lightcube"
author = "The lightcube developers"
release = version = tomllib.loads((HERE.parent / "pyproject.toml").read_text())["project"]["version"]
project_copyright = f"{author}. BSD-3-Clause. This is lightcube {release}."

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton"]
extensions += ["formulas", "docstrings", "made_pages", "made_things", "gallery", "dead_links"]  # our own, in _ext
exclude_patterns = ["_ext", "_static", "pictures"]

myst_enable_extensions = ["dollarmath", "colon_fence", "deflist", "attrs_block", "attrs_inline", "html_image"]
myst_heading_anchors = 4
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
autodoc_typehints = "description"
napoleon_attr_annotations = False
default_role = "py:obj"
python_maximum_signature_line_length = 90
napoleon_google_docstring = False
napoleon_use_rtype = False

html_math_renderer = "mathml"
highlight_language = "text"
copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True

html_theme = "furo"
html_title = f"lightcube {release}"
html_static_path = ["_static"]
html_favicon = "_static/cube.svg"
html_css_files = ["site.css"]
html_js_files = ["site.js"]
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {"navigation_with_keys": True}

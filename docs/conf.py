"""Settings for Sphinx.

pip install "dalembert[docs]"
sphinx-build -W docs docs/_build
"""

import sys
from importlib.util import find_spec
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import api_pages
import live_pages

import dalembert

project = "dalembert"
author = "The dalembert developers"
version = release = dalembert.__version__
root_doc = "contents"
extensions = ["myst_parser"]
if find_spec("sphinx-mathjax-offline"):  # MathJax and its fonts among the files of the site
    extensions += ["sphinx.ext.mathjax", "sphinx-mathjax-offline"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
exclude_patterns = ["_build"]
suppress_warnings = ["myst.xref_missing"]  # links to files of the repository
html_theme = "furo"
html_title = f"dalembert {release}"
html_static_path = ["static"]
html_css_files = ["pages.css"]
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0b63a5", "color-brand-content": "#0b63a5"},
    "dark_css_variables": {"color-brand-primary": "#5cb1f0", "color-brand-content": "#5cb1f0"},
}


def number_equations(app, doctree):
    """Unwrap equations of several lines: MathJax does not accept ``\\tag`` in ``split``."""
    from docutils import nodes

    for block in doctree.findall(nodes.math_block):
        text = block.astext()
        if r"\tag" in text and r"\\" in text:
            block["no-wrap"] = block["nowrap"] = True
            block.children = [nodes.Text(f"\\begin{{equation}}\n{text}\n\\end{{equation}}")]


def link_names(app, doctree, docname):
    """Public names in prose, such as ``solve_dynamics``, link to their entries."""
    from docutils import nodes

    for literal in list(doctree.findall(nodes.literal)):
        parents, parent = [], literal.parent
        while parent is not None:
            parents.append(parent)
            parent = parent.parent
        entry = api_pages.entry_of(literal.astext())
        if entry is None or any(isinstance(p, (nodes.reference, nodes.title)) for p in parents):
            continue
        page, anchor = entry
        uri = app.builder.get_relative_uri(docname, f"api/{page}") + f"#{nodes.make_id(anchor)}"
        reference = nodes.reference("", "", internal=True, refuri=uri)
        literal.parent.replace(literal, reference)
        reference += literal


def write_pages(app):
    """Write the generated pages before the site is built."""
    folder = Path(app.srcdir)
    api_pages.write(folder / "api")
    if app.builder.format == "html":
        live_pages.write(folder / "static" / "live")


def setup(app):
    app.connect("builder-inited", write_pages)
    app.connect("doctree-read", number_equations)
    app.connect("doctree-resolved", link_names)

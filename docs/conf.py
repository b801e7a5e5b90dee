"""Settings for Sphinx; the pages also read well as they are.

pip install sphinx myst-parser
sphinx-build docs docs/_build
"""

project = "dalembert"
author = "The dalembert developers"
root_doc = "contents"
extensions = ["myst_parser"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
exclude_patterns = ["_build"]
suppress_warnings = ["myst.xref_missing"]  # links to files of the repository
html_theme_options = {"description": "constrained mechanical systems", "page_width": "64em"}

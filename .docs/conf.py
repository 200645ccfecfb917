"""Sphinx settings of the documentation: ``python -m sphinx -W --keep-going -E .docs .docs/build/html``."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

project = "bemcontact"
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "generated", "mathml"]
exclude_patterns = ["build"]
default_role = "py:obj"  # docstrings name things in single backticks
highlight_language = "none"
smartquotes = False  # they would turn the two hyphens of an option into a dash
nitpicky = True
nitpick_ignore_regex = [
    ("py:obj", r"[a-z]\w*"),  # parameters and attributes of what is spoken of
    ("py:obj", r"Goal|Quantity"),  # names inside of their modules
    ("py:class", r"array|default .*"),  # words of `generated.tidy` in the types of fields
    ("py:class", r"(collections|cvxpy|numpy|os)\..*"),  # on other sites
]

myst_enable_extensions = ["attrs_inline", "colon_fence", "deflist", "dollarmath", "html_image"]
myst_heading_anchors = 4
nb_execution_mode = "force"
nb_merge_streams = True
nb_execution_in_temp = True
nb_execution_raise_on_error = True

add_module_names = False
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings give shapes and units, which types cannot
autodoc_class_signature = "separated"
autodoc_preserve_defaults = True
maximum_signature_line_length = 80
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_attr_annotations = False  # `generated.tidy` gives them shorter

html_math_renderer = "mathml"
html_show_copyright = False
html_show_sourcelink = False
html_copy_source = False
html_theme = "furo"
html_title = "bemcontact"
html_static_path = ["static"]
html_css_files = ["site.css"]

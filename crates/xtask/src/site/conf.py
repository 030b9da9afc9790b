"""Sphinx: how the pages become the site. `cargo xtask site` runs it, and any warning fails."""

project = "posewise"
extensions = ["myst_parser"]
root_doc = "index"
# Anchors of headings are those that forges make.
myst_heading_anchors = 4
# A page may begin below its title; code with an ellipsis is shown plainly.
suppress_warnings = ["myst.header", "misc.highlighting_failure"]
html_theme = "furo"
html_title = "posewise"
html_show_copyright = False
html_show_sphinx = False
html_copy_source = False
html_use_index = False
# Browsers let a page on a disk read no other for a summary.
html_show_search_summary = False
# The Rust reference and the demo, which are pages already.
html_extra_path = ["extra"]

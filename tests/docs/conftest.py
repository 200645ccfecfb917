"""The modules beside the pages, of which the site and these tests are made."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / ".docs"))

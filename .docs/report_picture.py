"""Make the picture of a report, .docs/pictures/report.png: the head of the page of the shipped cylinder, in Chromium.

Run it from the top of the tree, with the Python in which the package and its extra ``test`` are installed.
"""

import shutil
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

from bemcontact.cli import app

with tempfile.TemporaryDirectory() as folder:
    work = Path(folder)
    app(["compare", "models/cylinder_on_plane.yaml", "--out", f"{work}/report"], standalone_mode=False)
    flags = ["--no-sandbox", "--disable-background-networking"]
    with (
        sync_playwright() as playwright,
        playwright.chromium.launch(executable_path=shutil.which("chromium"), args=flags) as browser,
        browser.new_page(viewport={"width": 1100, "height": 1500}) as page,
    ):
        page.goto((work / "report" / "report.html").as_uri())
        page.screenshot(path=work / "report.png")
    picture = Image.open(work / "report.png").convert("RGB")
    size = round(picture.width * 0.8), round(picture.height * 0.8)
    small = picture.resize(size, Image.Resampling.LANCZOS)
    small.quantize(256, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(".docs/pictures/report.png", optimize=True)

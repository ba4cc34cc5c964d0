# SPDX-License-Identifier: BSD-3-Clause
"""Reports of ordinary and odd flights, read by parsers nobody here wrote.

ROSFLIGHT_BUILD names the build directory (default: build/release).
"""

import html.parser
import json
import math
import os
import pathlib
import re
import subprocess
import xml.etree.ElementTree as xml

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
BUILD = ROOT / os.environ.get("ROSFLIGHT_BUILD", "build/release")
SAMPLE = BUILD / "flight" / "report" / "report_sample"
KINDS = ["flight", "empty", "one", "nan", "wild", "hostile", "chatter"]
VOID = {"meta", "br", "hr", "img", "link", "input"}
SVG = "{http://www.w3.org/2000/svg}"


class Page(html.parser.HTMLParser):
    """Checks that tags nest, and collects what the page shows and asks for."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.tags, self.addresses, self.handlers, self.texts = [], [], [], [], {}
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.addresses += [value for name, value in attributes if name in ("src", "href", "action", "xlink:href")]
        self.handlers += [name for name, _ in attributes if name.startswith("on")]
        assert len({name for name, _ in attributes}) == len(attributes), attributes
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.texts.setdefault(self.open[-1] if self.open else "", []).append(data)


@pytest.fixture(scope="module", params=KINDS)
def report(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp(request.param)
    subprocess.run([SAMPLE, folder] + [request.param] * (request.param != "flight"), check=True)
    return request.param, (folder / "report.html").read_text("utf-8"), (folder / "path.svg").read_text("utf-8")


def test_tags_nest_and_nothing_is_fetched(report):
    _, text, _ = report
    page = Page(text)
    assert page.addresses == []
    assert page.handlers == []
    assert page.tags.count("script") == 2
    assert not re.search(r"https?:|url\(|@import|//\w+\.\w", text.replace("://", ":"))


def test_drawings_are_xml_with_finite_numbers(report):
    kind, text, _ = report
    drawings = re.findall(r"<svg.*?</svg>", text, re.DOTALL)
    estimate, wing = {"empty": (0, 0), "flight": (10, 0)}.get(kind, (10, 7))
    spectrum = 1 if kind == "flight" else 0
    assert len(drawings) == 4 + 1 + 16 + estimate + wing + spectrum  # Paths, states, charts.
    for drawing in drawings:
        xml.fromstring(drawing)
        for data in re.findall(r' d="([^"]*)"', drawing):
            assert re.fullmatch(r"[-MLHVhvZ0-9. ]*", data), (kind, data[:200])


def test_the_track_is_json(report):
    _, text, _ = report
    track = json.loads(re.search(r'id="track">(.*?)</script>', text, re.DOTALL)[1])
    assert len(track["t"]) == len(track["n"]) == len(track["e"]) == len(track["u"]) <= 1500
    assert all(value is None or math.isfinite(value) for value in track["n"])


def test_the_picture_stands_alone(report):
    _, _, picture = report
    root = xml.fromstring(picture)
    assert root.tag == SVG + "svg"
    assert len(root.findall(f".//{SVG}svg")) == 3
    assert "http" not in picture.replace(SVG[1:-1], "")
    assert "<script" not in picture


def test_size_does_not_run_away(report):
    _, text, picture = report
    assert len(text.encode()) < 1_500_000
    assert len(picture.encode()) < 100_000


def test_hostile_texts_are_shown_not_obeyed(tmp_path):
    subprocess.run([SAMPLE, tmp_path, "hostile"], check=True)
    page = Page((tmp_path / "report.html").read_text("utf-8"))
    shown = "</script><script>alert('x')</script>&amp;<b a=\"'>]]>--><!-- ??? ?[2J"
    assert page.texts["h1"] == page.texts["title"][:1] == [shown]
    assert "b" in page.tags  # Ours, around the name of the vehicle,
    assert page.texts["b"] == [shown] * 3  # and only ours.
    assert not any("alert" in script for script in page.texts["script"])


def test_a_folder_that_is_not_there_is_one_line(tmp_path):
    done = subprocess.run([SAMPLE, tmp_path / "missing"], capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr == f"{tmp_path}/missing/report.html.part: cannot create: No such file or directory\n"

# SPDX-License-Identifier: GPL-3.0-or-later
"""Links, anchors, paper keys and pictures of the documentation resolve."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FOLDERS = ("docs", "blend_scenes", "native", "addon", "tests", "tools")
PAGES = sorted(
    [*ROOT.glob("*.md"), *(page for folder in FOLDERS for page in (ROOT / folder).rglob("*.md"))]
)
MOST_BYTES = {"strip": 400_000, "gallery": 600_000, "tutorial": 1_600_000}  # of a page's pictures
SOURCES = (".h", ".cpp", ".py", ".txt", ".toml", ".cff")
CODE = re.compile(r"```.*?```|`[^`\n]*`", re.S)
LINK = re.compile(r"\[[^\]]*\]\(\s*<?([^)\s>]+)>?[^)]*\)")
KEY = re.compile(r"\[([A-Z][A-Za-z]+\d\d[a-z]?)(?:[ ,][^\]]*)?\](?!\()")


def name(page: Path) -> str:
    return str(page.relative_to(ROOT))


def text(page: Path) -> str:
    """What a page says, without code."""
    return CODE.sub("", page.read_text())


def anchor(heading: str) -> str:
    """What GitHub makes of a heading for links."""
    heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.strip()).lower()
    return re.sub(r"[^\w\- ]", "", heading).replace(" ", "-")


def anchors(page: Path) -> set[str]:
    headings = re.findall(
        r"^#+ +(.*)$", re.sub(r"```.*?```", "", page.read_text(), flags=re.S), re.M
    )
    found: set[str] = set()
    for heading in map(anchor, headings):
        number = 0
        while (unique := f"{heading}-{number}" if number else heading) in found:
            number += 1
        found.add(unique)
    return found


def broken(page: Path, content: str) -> Iterator[str]:
    """The links of `page` that lead nowhere; those to other sites are not followed."""
    for target in LINK.findall(content):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, fragment = target.partition("#")
        file = (page.parent / path).resolve() if path else page
        inside = file.is_relative_to(ROOT) and file.exists()
        if not inside or (fragment and fragment not in anchors(file)):
            yield target


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_links_resolve(page):
    assert not list(broken(page, text(page)))


def test_broken_links_are_noticed():
    page = ROOT / "docs" / "style.md"
    good = "[a](architecture.md) [b](#tests) [c](../README.md) [d](https://example.org/none)"
    assert not list(broken(page, good))
    bad = ["none.md", "#none", "architecture.md#none", "../../outside.md"]
    assert list(broken(page, " ".join(f"[x]({target})" for target in bad))) == bad


def test_keys_of_papers_are_in_the_references():
    references = (ROOT / "native" / "REFERENCES.md").read_text()
    known = set(re.findall(r"^\| \[(\w+)\]", references, re.M))
    assert "Zeltner20" in known
    for page in PAGES:
        assert set(KEY.findall(text(page))) <= known, name(page)


def test_pages_that_sources_name_exist():
    pattern = re.compile(r"\b(?:docs|native|blend_scenes)/[\w/]+\.md\b")
    for folder in ("native", "addon", "tests", "tools", "blend_scenes"):
        for source in (ROOT / folder).rglob("*"):
            if source.suffix in SOURCES and source != Path(__file__).resolve():
                for mention in pattern.findall(source.read_text()):
                    assert (ROOT / mention).exists(), f"{name(source)}: {mention}"


def test_files_that_pages_name_exist():
    pattern = re.compile(r"`((?:native|addon|blend_scenes|tests|tools)/[\w/.*-]+)`")
    for page in PAGES:
        for mention in pattern.findall(page.read_text()):
            assert list(ROOT.glob(mention.rstrip("/"))), f"{name(page)}: {mention}"


def test_every_picture_of_the_docs_is_shown():
    shown = {
        (page.parent / target).resolve() for page in PAGES for target in LINK.findall(text(page))
    }
    images = ROOT / "docs" / "images"
    unused = [name(image) for image in images.rglob("*.*") if image.resolve() not in shown]
    assert not unused


@pytest.mark.parametrize("folder", MOST_BYTES)
def test_pages_load_fast(folder):
    pictures = list((ROOT / "docs" / "images" / folder).iterdir())
    assert pictures
    assert sum(picture.stat().st_size for picture in pictures) <= MOST_BYTES[folder]

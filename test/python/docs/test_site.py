"""The website of the docs is built without warnings, opens with a playable mission, and asks no other host."""

from __future__ import annotations

import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest
from playwright.sync_api import Browser

pytestmark = pytest.mark.slow

DOCS = Path(__file__).parents[3] / "docs"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the website; a warning is an error."""
    folder = tmp_path_factory.mktemp("site") / "html"
    words = [sys.executable, str(DOCS / "build_site.py"), str(folder)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    return folder


def test_first_page_plays_a_mission_and_asks_no_other_host(browser: Browser, site: Path) -> None:
    page, wrong = browser.new_page(), []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("request", lambda request: wrong.append(request.url) if request.url.startswith("http") else None)
    page.goto(f"file://{site / 'index.html'}")
    player = page.frame_locator("iframe")
    player.locator("body[data-ready]").wait_for(state="attached", timeout=120_000)
    assert player.locator(".view").get_attribute("data-robots", timeout=60_000) == "3"
    for name in ("python_api", "scenario_keys", "ros_messages", "notebook", "world"):
        page.goto(f"file://{site / name}.html")
    assert wrong == []
    page.close()


def test_each_page_of_the_docs_is_in_the_menu(site: Path) -> None:
    menu = (site / "index.html").read_text(encoding="utf-8")
    for page in DOCS.glob("*.md"):
        assert f'href="{page.stem}.html"' in menu


def test_reference_has_every_key_and_the_public_functions(site: Path) -> None:
    keys = (site / "scenario_keys.html").read_text(encoding="utf-8")
    row = re.sub("<[^>]*>", "", keys[keys.index('<span class="pre">slope_db</span>') :]).split()
    assert row[:3] == ["slope_db", "number", "23.2"]
    api = (site / "python_api.html").read_text(encoding="utf-8")
    for name in (
        "notebook.simulate",
        "recording.mcap_writer.McapWriter",
        "sensing.readings.RobotReading.ranges_m",
        "interface.decision.Decision.outbox",
        "control.driving.path_controller.PathController.drive",
        "control.driving.known_map.KnownMap.reaches",
        "_core.plan.PlanningGrid.distance_map",
    ):
        assert api.count(f'id="robotteamsim.{name}"') == 1, name


def test_arguments_and_errors_of_functions_are_laid_out(site: Path) -> None:
    api = (site / "python_api.html").read_text(encoding="utf-8")
    assert "Args:" not in re.sub("<[^>]*>", "", api)
    begin = api.index('id="robotteamsim.simulation.simulation.Simulation"')
    fields = re.findall(r"<dt class=\"field-\w+\">(\w+)<.*?<dd.*?>(.*?)</dd>", api[begin:], re.DOTALL)[:2]
    named = [(field, re.findall(r"<strong>(\w+)</strong>", body)) for field, body in fields]
    assert named == [("Parameters", ["of", "controllers"]), ("Raises", ["PlacementError", "ScenarioError"])]


def test_examples_in_docstrings_are_code(site: Path) -> None:
    api = (site / "python_api.html").read_text(encoding="utf-8")
    examples = re.findall(r'<div class="highlight-python notranslate">(.*?)</div>', api, re.DOTALL)
    assert ["from robotteamsim.notebook import read_bag, read_campaign, simulate", ""] in [
        re.sub("<[^>]*>", "", example).splitlines()[:2] for example in examples
    ]
    assert any("LiveView(simulation)" in re.sub("<[^>]*>", "", example) for example in examples)


def test_text_and_pages_need_no_other_host(site: Path) -> None:
    for path in site.glob("*.html"):
        loaded = re.findall(r'<(?:script|img|link|iframe)[^>]+(?:src|href)="(https?://[^"]+)"', path.read_text())
        assert loaded == [], path.name


def test_every_attribute_of_messages_and_services_has_a_comment() -> None:
    attributes_of = runpy.run_path(str(DOCS / "build_site.py"))["message_attributes"]
    for path in (*DOCS.parent.glob("msg/*.msg"), *DOCS.parent.glob("srv/*.srv")):
        about, attributes = attributes_of(path.read_text(encoding="utf-8"))
        assert about, path.name
        assert [name for _, name, comment in attributes if not comment] == [], path.name


def test_reference_of_messages_has_the_attributes_of_requests_and_answers(site: Path) -> None:
    page = re.sub("<[^>]*>", "", (site / "ros_messages.html").read_text(encoding="utf-8"))
    for words in ("hops (18-20); 0 on the diagonal", "false: outside the floor plan or inside a wall"):
        assert words in page

"""A Chromium for all tests of the page, and pages that must not complain."""

from __future__ import annotations

import pytest
from view_server import ARGUMENTS, CHROMIUM, serving_a_bus

from pilotfish.harness.ports import private_lcm_url


@pytest.fixture
def url():
    return private_lcm_url()


@pytest.fixture(scope="session")
def shared(tmp_path_factory):
    """One server for many tests: each has a robot of its own on its bus (`shared.url`)."""
    with serving_a_bus(tmp_path_factory.mktemp("view")) as server:
        yield server


@pytest.fixture(scope="session")
def chromium():
    playwright = pytest.importorskip("playwright.sync_api")
    if not CHROMIUM.exists():
        pytest.skip("no Chromium: apt install chromium")
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=str(CHROMIUM), args=ARGUMENTS)
        yield browser
        browser.close()


class Watched:
    """Pages of one test, what they said on the console and whom they asked."""

    def __init__(self, browser):
        self.browser = browser
        self.complaints, self.requests, self.contexts = [], [], []

    def open(self, address, *, wait="live", width=1400, height=1000, scheme="light"):
        context = self.browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme)
        self.contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(20_000)
        page.on("console", lambda m: self.complaints.append(m.text) if m.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self.requests.append(request.url))
        page.on("websocket", lambda socket: self.requests.append(socket.url))
        page.goto(address)
        if wait:
            page.wait_for_selector(f'body[data-live="{wait}"]')
        return page


@pytest.fixture
def browser(chromium):
    watched = Watched(chromium)
    yield watched
    for context in watched.contexts:
        context.close()

"""``pilotfish top`` on a screen that a test reads and presses keys on: Textual's pilot."""

import asyncio
import time
from concurrent.futures import ThreadPoolExecutor

PATIENCE_S = 20.0


async def until(pilot, condition, what):
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < deadline, f"{what}: not within {PATIENCE_S} s"
        await pilot.pause(0.02)


def on_screen(app, scenario, size=(160, 40)):
    async def run():
        async with app.run_test(size=size) as pilot:
            await scenario(pilot)

    # In a thread of its own: a browser's test before this one has left a loop running in this thread.
    with ThreadPoolExecutor(1) as executor:
        executor.submit(lambda: asyncio.run(run())).result()

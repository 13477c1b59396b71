"""Who is let in, who is displaced and who is turned away, without HTTP."""

from __future__ import annotations

import asyncio
import errno
import logging
import os
import socket
from concurrent.futures import ThreadPoolExecutor

from pilotfish.view.descriptors import Limits
from pilotfish.view.gate import Gate

LIMITS = Limits(total=6, per_address=4)


class Connection(asyncio.Protocol):
    """Displaceable unless it is busy."""

    def __init__(self, busy):
        self.busy, self.transport = busy, None

    def connection_made(self, transport):
        self.transport = transport
        transport.write(b"in")

    def is_displaceable(self):
        return self.transport is not None and not self.busy

    def displace(self):
        self.transport.abort()


def at_a_gate(scenario, *, busy=False, listening=None):
    """Runs ``scenario(come)``: ``come(address)`` connects from there, and waits until it was let in or turned away."""

    async def run():
        with listening or socket.create_server(("127.0.0.1", 0)) as door:
            inside, outside = [], []

            def let_in():
                inside.append(Connection(busy))
                return inside[-1]

            gate = Gate(door, LIMITS, let_in)
            gate.open()

            async def come(address="127.0.0.1"):
                reader, writer = await asyncio.open_connection(*door.getsockname(), local_addr=(address, 0))
                outside.append(writer)
                try:
                    return await reader.read(2) == b"in", reader, writer
                except ConnectionError:
                    return False, reader, writer

            try:
                return await asyncio.wait_for(scenario(come), 10.0)
            finally:
                gate.close()
                for one in (*inside, *outside):
                    one.transport.abort()
                await asyncio.sleep(0.01)  # the loop closes their sockets

    # In a thread of its own: Playwright's browser keeps an event loop in this one.
    with ThreadPoolExecutor(1) as executor:
        return executor.submit(lambda: asyncio.run(run())).result()


async def is_closed(reader):
    try:
        return await asyncio.wait_for(reader.read(1), 5.0) == b""
    except ConnectionError:
        return True


def test_whoever_comes_takes_the_place_of_the_one_of_its_address_that_waits_longest():
    async def scenario(come):
        other = await come("127.0.0.2")
        first, *rest = [await come() for _ in range(LIMITS.per_address)]
        new = await come()
        assert new[0]
        assert await is_closed(first[1])
        assert not any(writer.transport.is_closing() or reader.at_eof() for _, reader, writer in (other, new, *rest))

    at_a_gate(scenario)


def test_a_full_server_displaces_a_connection_of_the_address_that_has_most():
    async def scenario(come):
        few = [await come("127.0.0.2") for _ in range(2)]
        many = [await come() for _ in range(4)]
        assert (await come("127.0.0.3"))[0]
        assert await is_closed(many[0][1])
        assert not any(reader.at_eof() for _, reader, _ in few)

    at_a_gate(scenario)


def test_where_all_are_busy_the_new_one_is_turned_away_until_one_goes():
    async def scenario(come):
        inside = [await come() for _ in range(LIMITS.per_address)]
        assert not (await come())[0]
        assert (await come("127.0.0.2"))[0]
        inside[0][2].close()
        while not (await come())[0]:  # as soon as the server has noticed; bounded by the scenario's 10 s
            await asyncio.sleep(0)

    at_a_gate(scenario, busy=True)


class Exhausted(socket.socket):
    """A listening socket of a computer without descriptors, for the first ``times`` tries."""

    times = tries = 0

    def accept(self):
        self.tries += 1
        if self.tries <= self.times:
            raise OSError(errno.EMFILE, os.strerror(errno.EMFILE))
        return super().accept()


def test_a_computer_without_descriptors_is_named_once_and_asked_again_after_a_pause(caplog):
    door = Exhausted(socket.AF_INET, socket.SOCK_STREAM)
    door.bind(("127.0.0.1", 0))
    door.listen()
    door.times = 3

    async def scenario(come):
        return (await come())[0]

    with caplog.at_level(logging.ERROR):
        assert at_a_gate(scenario, listening=door)
    assert door.tries <= door.times + 2  # it lets one in, and looks whether there is another
    assert [record.getMessage() for record in caplog.records] == [
        "no new connection can be accepted: Too many open files; trying again every 0.5 s"
    ]

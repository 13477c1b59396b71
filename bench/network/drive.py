"""One drive: every robot with its simulator and its coordinator on a host of its own, and one host that watches."""

from __future__ import annotations

import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import lcm
import numpy as np
import yaml
from disturbances import DISTURBANCES, DOWN, FROM
from forward import BUFFER, LOCAL_URL, SHARED_URL
from hosts import HERE, Host, Listener, hosts

from bench.common.configuration import shipped_scenario
from pilotfish import data, sim
from pilotfish.harness.child import Child
from pilotfish.harness.executables import COORDINATOR, SIM, find_executable
from pilotfish.harness.scenario import Scenario
from pilotfish.lcmtypes.pilotfish.motion_t import motion_t
from pilotfish.recording import Recording, read_csv

READY_S = 20.0
OUT = "{0}_(STATUS|POSE|OBSERVATION|COMMAND|BASE)"
IN = "LEADER_MOTION|{0}_SETPOINT"


@dataclass(frozen=True)
class Plan:
    scenarios: tuple[str, ...]  # one robot each
    disturbance: str = "none"
    nonideal: bool = False
    images: str = "local"  # or "shared": everything is on the bus between the hosts
    switch: str = "relay"
    intent: bool = False  # a host "leader" announces how the leader moves, and the coordinators listen
    lockstep: bool = False
    duration_s: float = 20.0
    relay_seed: int = 1


@dataclass
class Driven:
    """Of one robot; the first 40 % of the drive do not count (FROM)."""

    robot: str
    scenario: str
    rms_mm: float
    closest_mm: float  # the largest e(t) = d_p - d(t) from then on
    tracking: float  # share of frames from then on
    frames: int  # that the simulator had the time to render
    frames_due: int
    watched: int = 0  # messages of it that reached who watches
    watched_gap_s: float = 0.0  # longest time between two of its statuses there
    recording: Recording | None = field(default=None, repr=False)


def drive(plan: Plan) -> list[Driven]:
    """Raises HarnessError with what a failing program said. To be called in a network namespace of the caller's own."""
    names = [f"robot{number}" for number in range(1, len(plan.scenarios) + 1)]
    everybody = [*names, "watcher", *(["leader"] if plan.intent else [])]
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="pilotfish-network-")))
        lan = stack.enter_context(hosts(everybody, plan.disturbance, seed=plan.relay_seed, switch=plan.switch))
        url = LOCAL_URL if plan.images == "local" else SHARED_URL
        scenarios = [_scenario(folder, name, which, plan) for name, which in zip(names, plan.scenarios, strict=True)]
        for scenario in scenarios:
            _start_robot(stack, lan[scenario.robots[0].name], folder, scenario, plan, url + BUFFER)
        watcher = Listener(lan["watcher"], SHARED_URL + BUFFER)
        sims = [_start_sim(stack, lan[s.robots[0].name], folder, s, plan, url + BUFFER) for s in scenarios]
        start_s = _begun(lan[names[0]], url + BUFFER, sims)
        if plan.intent:
            stack.enter_context(_leader_announces(lan["leader"], scenarios[0], start_s))
        _let_drive(plan, [lan[name] for name in names], watcher, sims, start_s)
        records = [read_csv(folder / f"{name}.csv")[name] for name in names]
    return [
        _driven(scenario, which, record, watcher, plan)
        for scenario, which, record in zip(scenarios, plan.scenarios, records, strict=True)
    ]


def _scenario(folder: Path, name: str, which: str, plan: Plan) -> Scenario:
    """The shipped one; its robot has this name, and noise of its own."""
    content = shipped_scenario(which)
    content["robots"][1]["name"] = name
    content["seed"] = int(name[-1])
    if plan.nonideal:
        content["hardware"] = str(data.path("hardware/nonideal.yaml"))
    file = folder / f"{name}.yaml"
    file.write_text(yaml.safe_dump(content))
    return Scenario.load(file)


def _start_robot(stack: ExitStack, host: Host, folder: Path, scenario: Scenario, plan: Plan, url: str) -> None:
    robot = scenario.robots[0]
    words = [find_executable(COORDINATOR), "--config", robot.coordinator_file, "--name", robot.name, "--lcm-url", url]
    words += ["--source", "lcm"]
    words += ["--simulated-time"] if plan.lockstep else []
    words += ["--leader-intent-from", "leader"] if plan.intent else []
    started = [stack.enter_context(Child(host.command(words), folder, robot.name))]
    if plan.images == "local":
        channels = ["--out", OUT.format(robot.name.upper()), "--in", IN.format(robot.name.upper())]
        words = [sys.executable, HERE / "forward.py", *channels]
        started.append(stack.enter_context(Child(host.command(words), folder, f"{robot.name}-forward")))
    for child in started:
        child.wait_until(lambda child=child: "ready" in child.stderr() + child.stdout(), READY_S, "being ready")


def _start_sim(stack: ExitStack, host: Host, folder: Path, scenario: Scenario, plan: Plan, url: str) -> Child:
    name = scenario.robots[0].name
    words = [find_executable(SIM), "--scenario", scenario.file, "--lcm-url", url]
    words += ["--record", folder / f"{name}.csv", "--duration-s", str(plan.duration_s)]
    words += ["--lockstep" if plan.lockstep else "--realtime"]
    return stack.enter_context(Child(host.command(words), folder, f"{name}-sim"))


def _begun(host: Host, url: str, simulators: list[Child]) -> float:
    """When the first robot's world has begun to move, on the monotonic clock."""
    listener = Listener(host, url, "ROBOT1_POSE")
    end_s = time.monotonic() + READY_S
    while not listener.count:
        listener.listen(0.02)
        for simulator in simulators:
            if simulator.process.poll() not in (None, 0):
                raise simulator.error(f"ended with {simulator.process.returncode} before it began")
        if time.monotonic() > end_s:
            raise simulators[0].error("does not begin")
    return time.monotonic()


def _let_drive(plan: Plan, robots: list[Host], watcher: Listener, simulators: list[Child], start_s: float) -> None:
    """To the end, with the link down in the middle of it if that is asked for. In lock-step nothing waits for the
    clock, and a drive takes less than its time: there it is down from the beginning on."""
    down = DISTURBANCES[plan.disturbance].down
    from_s = 0.0 if plan.lockstep else FROM * plan.duration_s
    changes = [(start_s + from_s, True), (start_s + from_s + DOWN * plan.duration_s, False)] if down else []
    end_s = start_s + 10.0 * plan.duration_s + READY_S
    while any(simulator.process.poll() is None for simulator in simulators):
        watcher.listen(0.02)
        if changes and time.monotonic() >= changes[0][0]:
            for host in robots:
                host.set_down(down, changes[0][1])
            changes.pop(0)
        if time.monotonic() > end_s:
            raise simulators[0].error("does not end")
    for simulator in simulators:
        if simulator.process.returncode:
            raise simulator.error(f"ended with {simulator.process.returncode}")


@contextmanager
def _leader_announces(host: Host, scenario: Scenario, start_s: float) -> Iterator[None]:
    """30 times a second, on the shared bus; in time with the pictures to within 20 ms."""
    world = sim.World(sim.load_scenario(scenario.file))
    start_us = world.utime
    with host.entered():
        bus = lcm.LCM(SHARED_URL + BUFFER)
    ended = threading.Event()

    def announce() -> None:
        while not ended.wait(1 / 30):
            time_s = time.monotonic() - start_s
            world.advance_to(time_s)
            twist = world.state("leader").twist
            message = motion_t()
            message.utime = start_us + round(1e6 * time_s)
            message.linear_mps, message.angular_radps = twist.linear_mps, twist.angular_radps
            bus.publish("LEADER_MOTION", message.encode())

    thread = threading.Thread(target=announce)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def _driven(scenario: Scenario, which: str, record: Recording, watcher: Listener, plan: Plan) -> Driven:
    robot = scenario.robots[0]
    record = scenario.annotate(record, "anticipate", "lcm")
    late = record.time_s >= FROM * plan.duration_s
    error_mm = 1e3 * record.distance_error_m[late]
    upper = robot.name.upper()
    return Driven(
        robot=robot.name,
        scenario=which,
        rms_mm=float(np.sqrt(np.mean(error_mm**2))),
        closest_mm=float(error_mm.max()),
        tracking=float(np.mean(record.status[late] == "tracking")),
        frames=len(record),
        frames_due=scenario.frame_count(plan.duration_s),
        watched=sum(count for channel, count in watcher.count.items() if channel.startswith(upper + "_")),
        watched_gap_s=watcher.longest_gap_s.get(f"{upper}_STATUS", 0.0),
        recording=record if plan.lockstep else None,
    )

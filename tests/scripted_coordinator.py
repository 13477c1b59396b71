"""A coordinator's receiver and sender without its vision: gate, heartbeats and status on a real bus, in a thread."""

from __future__ import annotations

import threading

from pilotfish import bus, core


class ScriptedCoordinator:
    """Obeys setpoints as pilotfish-coordinator does, and says so with every beat. Use as a context manager."""

    def __init__(
        self,
        url,
        robot="robot1",
        *,
        key=None,
        ignores_setpoints=False,
        answers_pictures=False,
        before_beat=lambda played: None,
    ):
        self.bus = bus.Bus(url)
        if key is not None:
            self.bus.set_key(key)
        self.robot = robot
        self.before_beat = before_beat
        self.gate = core.SetpointGate(session=bus.new_session_id(), stop_distance_m=0.4)
        self.setpoint = core.Setpoint(distance_m=1.0, bearing_rad=0.0, run=True)
        self.verdicts = []
        self.rejected = {}
        self.base_stopped = None  # what a pilotfish-base beside it says; None: there is none
        self._counter = 0
        self._stop = threading.Event()
        if not ignores_setpoints:
            self.bus.on_setpoint(robot, self._decide)
        if answers_pictures:
            self.bus.on_image(bus.channel(robot, "IMAGE"), lambda frame: self._command(frame.utime))
        self._thread = threading.Thread(target=self._run)

    def _decide(self, report):
        decision = self.gate.decide(
            session=report.session, counter=report.counter, asked=report.setpoint, kept=self.setpoint
        )
        self.setpoint = decision.setpoint
        self.verdicts.append(decision.verdict)
        if decision.verdict not in (core.SetpointVerdict.accepted, core.SetpointVerdict.stopped):
            name = decision.verdict.counted_as
            self.rejected[name] = self.rejected.get(name, 0) + 1

    def beat(self):
        self._command(0)
        report = bus.StatusReport(utime=0, status=self._status(), reason=self._reason(), setpoint=self.setpoint)
        report.rejected = self.rejected | self.bus.rejected
        report.session, report.setpoint_counter = self.gate.session, self.gate.last_counter
        self.bus.publish_status(self.robot, report)
        if self.base_stopped is not None:
            state = bus.BaseReport.State.stopped if self.base_stopped else bus.BaseReport.State.waiting
            self.bus.publish_base(self.robot, bus.BaseReport(utime=0, stopped=self.base_stopped, state=state))

    def _command(self, utime):
        self._counter += 1
        command = bus.CommandReport(
            utime=utime,
            session=self.gate.session,
            counter=self._counter,
            status=self._status(),
            reason=self._reason(),
        )
        self.bus.publish_command(self.robot, command)

    def _status(self):
        return core.Status.searching if self.setpoint.run else core.Status.stopped

    def _reason(self):
        return core.Reason.no_frame if self.setpoint.run else core.Reason.stop_requested

    def _run(self):
        while not self._stop.is_set():
            self.bus.handle(10)
            self.before_beat(self)
            self.beat()

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._stop.set()
        self._thread.join()

"""The robot in a browser: what ``pilotfish view`` serves.

A ``Listener`` takes LCM's datagrams from the bus, a ``Feed`` per robot keeps the newest of every message and a minute
of samples, and a Starlette application (``server.make_app``) sends both to whoever watches, newest first. While
nobody watches, messages are kept as bytes and nothing is decoded.

    bus -> datagrams.Reassembly -> listener.Listener -> robot_feed.RobotFeed -> watcher.Watcher -> page (static/)
    camera -> camera_feed.CameraFeed ----------------------------------------^
    page -> commands.Commander -> pilotfish.operating.Operator -> bus
"""

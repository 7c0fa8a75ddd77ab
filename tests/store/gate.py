"""A door between a program and a server that shuts in the middle of a transfer."""

import socket
import threading

UP, DOWN = "up", "down"
HOLD, CUT, DEAF = "hold", "cut", "deaf"
CHUNK = 4096


class Shutter:
    """What happens to connections that begin now."""

    def __init__(self, direction=None, limit=None, action=None, spared=0):
        self.direction, self.limit, self.action, self.spared = direction, limit, action, spared
        self.reached, self.released = threading.Event(), threading.Event()

    def shuts(self):
        """Waits where a connection has its limit. Returns whether it ends there."""
        if self.spared:
            self.spared -= 1
            return False
        self.reached.set()
        if self.action == HOLD:
            self.released.wait()
        return self.action == CUT


class Gate:
    """Passes bytes between clients and a server on this machine.

    After `limit` bytes in one direction, a connection is held (nothing more passes), cut, or deaf: it
    ends with the server's reply, which does not pass. Without a limit everything passes.
    """

    def __init__(self, server_port):
        self.server_port = server_port
        self.shutter = Shutter()
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def shut(self, direction, limit, action, spared=0):
        """Shuts connections after `limit` bytes in a direction, but for the first that have as many."""
        self.shutter = Shutter(direction, limit, action, spared)

    def open(self, then=HOLD):
        """Lets everything pass from now on. What is held passes, too, or is cut."""
        before, self.shutter = self.shutter, Shutter()
        before.action = then
        before.released.set()

    def reached(self, longest_s):
        """Waits until a connection is shut. Returns false if none is after this time."""
        return self.shutter.reached.wait(longest_s)

    def _accept(self):
        while True:
            client, _ = self.listener.accept()
            server = socket.create_connection(("127.0.0.1", self.server_port))
            deaf = threading.Event()
            for direction, source, sink in ((UP, client, server), (DOWN, server, client)):
                arguments = (self.shutter, deaf, direction, source, sink)
                threading.Thread(target=self._pass, args=arguments, daemon=True).start()

    def _pass(self, shutter, deaf, direction, source, sink):
        passed = 0
        limit = shutter.limit if direction == shutter.direction else None
        try:
            while data := source.recv(CHUNK):
                passed += len(data)
                if limit is not None and passed > limit:
                    limit = None
                    if shutter.shuts():
                        break
                    if shutter.action == DEAF:
                        deaf.set()
                if deaf.is_set() and direction == DOWN:
                    break
                sink.sendall(data)
        except OSError:
            pass
        for end in (source, sink):
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass
            end.close()

"""A person who types: the world listens on this machine only, and `play` connects a terminal to it."""

import socket
import time

from aos_protocol.errors import DeployError
from aos_skills.pybullet.parts.scene import Scene
from aos_skills.pybullet.worlds.tictactoe.rules import empty_cells

LOOK_EVERY_S = 0.05
_ENDS = {"X": "You have won.", "O": "The robot has won.", None: "Nobody has won."}


class PersonAtTerminal:
    """Asks whoever is connected for a cell; somebody else may connect later.

    Simulated time goes on meanwhile, in step with the clock.
    """

    def __init__(self, port: int, scene: Scene) -> None:
        self._scene = scene
        try:
            self._listener = socket.create_server(("127.0.0.1", port))
        except OSError as error:
            message = f"port {port} for the person's terminal: {error.strerror}"
            raise DeployError(message, hint="Give another `port:` in the world file") from error
        self._listener.settimeout(0)
        self.port: int = self._listener.getsockname()[1]
        self._terminal: socket.socket | None = None
        self._has_told_end = False

    def __call__(self, board: str) -> int:
        """Returns when a cell was typed. What ends the skill's call, ends the waiting."""
        cells = empty_cells(board)
        is_asked, typed, refused = False, b"", ""
        while True:
            if self._terminal is None:
                is_asked, typed, refused = False, b"", ""
                self._accept()
            if self._terminal is not None and not is_asked:
                numbers = ", ".join(str(cell + 1) for cell in cells)
                self._say(f"{_drawn(board)}\n{refused}Your cell ({numbers}): ")
                is_asked = True
            typed += self._heard()
            if b"\n" in typed:
                answer = typed.decode(errors="replace").strip()
                if answer.isdecimal() and int(answer) - 1 in cells:
                    return int(answer) - 1
                refused = f"{answer!r} is no cell that is free.\n"
                is_asked, typed = False, b""
            self._scene.wait(LOOK_EVERY_S)
            time.sleep(LOOK_EVERY_S)

    def tell_end(self, board: str, won: str | None, *, is_over: bool) -> None:
        """The last board and who has won, to whoever is connected. Only the first time counts."""
        if self._has_told_end:
            return
        self._has_told_end = True
        if self._terminal is None:
            self._accept()
        ended = _ENDS[won] if is_over else "The game was ended before it was over."
        self._say(f"{_drawn(board)}\n{ended}\n")

    def close(self) -> None:
        """Hangs up."""
        self._listener.close()
        self._hang_up()

    def _hang_up(self) -> None:
        if self._terminal is not None:
            self._terminal.close()
            self._terminal = None

    def _accept(self) -> None:
        try:
            self._terminal, _ = self._listener.accept()
            self._terminal.settimeout(0)
        except BlockingIOError:
            return

    def _say(self, text: str) -> None:
        try:
            if self._terminal is not None:
                self._terminal.sendall(text.encode())
        except OSError:
            self._hang_up()

    def _heard(self) -> bytes:
        if self._terminal is None:
            return b""
        try:
            heard = self._terminal.recv(100)
        except BlockingIOError:
            return b""
        except OSError:
            heard = b""
        if heard == b"":
            self._hang_up()
        return heard


def _drawn(board: str) -> str:
    """The board in three lines; a cell that is free shows its number."""
    shown = [mark if mark in "XO" else str(cell + 1) for cell, mark in enumerate(board)]
    return "\n" + "\n".join(" ".join(shown[start : start + 3]) for start in (0, 3, 6))

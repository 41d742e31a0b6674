"""Play against the robot: `python -m aos_skills.pybullet.worlds.tictactoe.play`, while `aos-up` runs."""

import argparse
import codecs
import socket
import sys
import threading
import time

PATIENCE_S = 120.0


def main() -> None:
    """Connects this terminal to the world, which shows the board and asks for the number of a cell."""
    parser = argparse.ArgumentParser(prog="play", description=main.__doc__)
    parser.add_argument("--port", type=int, default=7450, help="as in the world file (default: 7450)")
    options = parser.parse_args()
    world = connected(options.port)
    if world is None:
        sys.exit(f"play: nobody listens on port {options.port}: start aos-up deploy/tictactoe-person.yaml")
    sys.stdout.write("Connected. You draw crosses. Cells are 1 to 9, row by row; wait until you are asked.\n")
    sys.stdout.flush()
    has_left = threading.Event()
    threading.Thread(target=send_lines, args=(world, has_left), daemon=True).start()
    try:
        show(world)
    except KeyboardInterrupt:
        has_left.set()
    if has_left.is_set():
        sys.stdout.write("\nYou have left; somebody else may connect.\n")
    else:
        sys.stdout.write("\nThe game has ended.\n")


def connected(port: int) -> socket.socket | None:
    """A connection to the world, which may take a while to be there."""
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        try:
            return socket.create_connection(("127.0.0.1", port))
        except ConnectionRefusedError:
            time.sleep(0.5)
    return None


def show(world: socket.socket) -> None:
    """Shows what the world says, until it hangs up: also in the middle of a line that was typed."""
    decoder = codecs.getincrementaldecoder("utf-8")("replace")
    while True:
        try:
            heard = world.recv(1000)
        except ConnectionError:
            return
        if not heard:
            return
        sys.stdout.write(decoder.decode(heard))
        sys.stdout.flush()


def send_lines(world: socket.socket, has_left: threading.Event) -> None:
    """Sends what is typed, line by line. Who ends the input of a terminal (Ctrl-D) leaves."""
    try:
        for line in sys.stdin:
            world.sendall(line.encode())
        if sys.stdin.isatty():
            has_left.set()
            world.shutdown(socket.SHUT_RDWR)
    except OSError:
        return  # The world has hung up, which `show` says.


if __name__ == "__main__":
    main()

"""A program of a user's own, small: it serves the path /sense if the router listens, and answers nothing.

It does not wait for the router: where none listens it ends with status 3. After SIGUSR1 it serves nothing.
"""

import json
import os
import signal
import socket
import sys
import threading
from pathlib import Path

import zenoh

password = Path(os.environ["AOS_PASSWORD_FILE"]).read_text().strip()
host, port = os.environ["AOS_ENDPOINT"].removeprefix("tcp/").rsplit(":", 1)
try:
    socket.create_connection((host, int(port))).close()
except OSError:
    sys.exit(3)
settings = {
    "mode": "client",
    "connect": {"endpoints": [os.environ["AOS_ENDPOINT"]]},
    "scouting": {"multicast": {"enabled": False}},
    "transport": {
        "shared_memory": {"enabled": False},
        "link": {"tx": {"lease": 800}},
        "auth": {"usrpwd": {"user": os.environ["AOS_USER"], "password": password}},
    },
}
with zenoh.open(zenoh.Config.from_json5(json.dumps(settings))) as session:
    name = os.environ["AOS_ADAPTER"]
    key = f"aos/{os.environ['AOS_ROBOT']}/serve/{name}/1/{session.zid()}/sense"
    token = session.liveliness().declare_token(key)
    signal.signal(signal.SIGUSR1, lambda *_: token.undeclare())
    threading.Event().wait()

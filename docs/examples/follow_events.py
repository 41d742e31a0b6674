"""Follows the decisions of a mission over HTTP, with nothing but Python's standard library.

TOKEN=... python docs/examples/follow_events.py [ADDRESS] [MISSION]
"""

import json
import os
import signal
import sys
from urllib.error import HTTPError, URLError
from urllib.request import Request, urlopen


def main(address: str = "http://127.0.0.1:7480", mission: str = "latest") -> None:
    request = Request(f"{address}/v1/events?mission={mission}")
    request.add_header("Authorization", f"Bearer {os.environ.get('TOKEN', '')}")
    kind = ""
    with urlopen(request) as stream:
        for raw in stream:
            name, _, text = raw.decode().rstrip("\n").partition(": ")
            if name == "event":
                kind = text
            elif name == "data" and kind == "decision":
                record = json.loads(text)["record"]
                if "outcome" in record:
                    told = record["outcome"].get("response") or f"nothing ({record['outcome']['status']})"
                    print(f"step {record['step']}: {told}", flush=True)
                else:
                    print(f"step {record['step']}: {record['action']}", flush=True)
            elif name == "data" and kind == "state" and json.loads(text)["phase"] == "ended":
                print(f"ended: {json.loads(text)['ending']}")
                return


if __name__ == "__main__":
    for ending in (signal.SIGINT, signal.SIGPIPE):  # Ctrl-C, and a reader such as `head` that has enough.
        signal.signal(ending, signal.SIG_DFL)
    try:
        main(*sys.argv[1:])
    except HTTPError as error:
        problem = json.load(error)
        sys.exit(f"{problem['code']}: {problem['detail']}. {problem.get('hint', '')}")
    except URLError as error:
        sys.exit(f"nobody answers there: {error.reason}")

"""One adapter as a process.

    python -m aos_runtime.adapters MODULE:CLASS [NAME=VALUE]...
    python -m aos_runtime.adapters SETTINGS.json

The first is the command of an adapter `command`, which finds in its environment where the bus is. The second
is how aos-up starts an adapter of the kind `class`.
"""

import sys

from aos_runtime.adapters.host import serve_adapter
from aos_runtime.adapters.settings import AdapterSettings, settings_told
from aos_runtime.bus.config import ADAPTER_LEASE_S
from aos_runtime.processes.lifecycle import run_service

if __name__ == "__main__":
    settings = settings_told(sys.argv[1:])
    run_service(AdapterSettings, serve_adapter, lease_s=ADAPTER_LEASE_S, settings=settings, leave=sys.exit)

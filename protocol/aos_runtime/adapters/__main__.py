"""`python -m aos_runtime.adapters SETTINGS.json`: one adapter as a process."""

from __future__ import annotations

from aos_runtime.adapters.host import serve_adapter
from aos_runtime.adapters.settings import AdapterSettings
from aos_runtime.bus_config import ADAPTER_LEASE_S
from aos_runtime.lifecycle import run_service

if __name__ == "__main__":
    run_service(AdapterSettings, serve_adapter, lease_s=ADAPTER_LEASE_S)

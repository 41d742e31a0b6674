"""A systemd unit that starts a mission when the machine does, and confines what it need not reach."""

import getpass
import sys
from pathlib import Path

from aos_deploy.deployment.reading import Deployment
from aos_protocol.errors import DeployError

_UNIT = """\
# The mission of {robot}, from the start of the machine on. To take it into use, as root:
#   cp {name} /etc/systemd/system/ && systemctl daemon-reload && systemctl enable --now {name}
# What it says: journalctl -u {name}. Its runs: {runs}
[Unit]
Description=AOS, the mission of {robot}
After=network.target

[Service]
Type=exec
User={user}
WorkingDirectory={folder}
ExecStart={command} --plain
# Ctrl-C, to aos-up alone: it stops the solver, what moves, and then the rest.
KillMode=mixed
KillSignal=SIGINT
TimeoutStopSec={stop_s:.0f}
# A mission that ended is not begun again by itself: the robot would move.
Restart=no
SuccessExitStatus=0 4 5 6 130

CacheDirectory={cache}
CacheDirectoryMode=0700
RuntimeDirectory={cache}
RuntimeDirectoryMode=0700
Environment=AOS_CACHE_DIR=%C/{cache} XDG_RUNTIME_DIR=%t/{cache}
UMask=0077

# Adapters and programs of the deploy file are confined by these, too. If one needs more, such as a device
# (PrivateDevices=no), a file to write (ReadWritePaths=) or a home folder (ProtectHome=), say so in
# `systemctl edit {name}`.
NoNewPrivileges=yes
ProtectSystem=strict
ProtectHome={home}
ReadWritePaths={written}
PrivateTmp=yes
PrivateDevices=yes
ProtectKernelTunables=yes
ProtectKernelModules=yes
ProtectKernelLogs=yes
ProtectControlGroups=yes
ProtectClock=yes
ProtectHostname=yes
RestrictNamespaces=yes
RestrictRealtime=yes
RestrictSUIDSGID=yes
LockPersonality=yes
RemoveIPC=yes
CapabilityBoundingSet=
AmbientCapabilities=
SystemCallArchitectures=native
SystemCallFilter=@system-service
# The documents' code is confined by these.
SystemCallFilter=landlock_create_ruleset landlock_add_rule landlock_restrict_self seccomp prctl
RestrictAddressFamilies=AF_UNIX AF_INET AF_INET6 AF_NETLINK

[Install]
WantedBy=multi-user.target
"""

_STOP_S = 30.0
"""The stop may take this time, beside that of adapters and programs."""
_UNUSUAL = set(" \t\n\"'\\%$;")
"""systemd reads these characters of a path as something else."""


def unit_name(deployment: Deployment) -> str:
    """The name of the unit's file."""
    return f"aos-{deployment.file.robot}.service"


def unit_of(deployment: Deployment, user: str = "") -> str:
    """The text of the unit, for the Python and the deploy file that are in use now.

    DeployError AOS801 for paths that a unit cannot name.
    """
    command = Path(sys.executable).with_name("aos-up")
    folder = deployment.path.parent
    written = [deployment.runs, *([deployment.watch] if deployment.watch else [])]
    for path in (command, deployment.path, *written):
        if _UNUSUAL & set(str(path)):
            raise DeployError(
                f"a systemd unit cannot name {path}", hint="Move it to a path of letters, digits, / . - and _"
            )
    stops_s = [plan.kind.stop_s for plan in deployment.adapters]
    stops_s += [part.stop_s for part in deployment.file.programs.values()]
    return _UNIT.format(
        robot=deployment.file.robot,
        name=unit_name(deployment),
        cache=f"aos-{deployment.file.robot}",
        user=user or getpass.getuser(),
        folder=folder,
        command=f"{command} {deployment.path}",
        runs=deployment.runs,
        stop_s=_STOP_S + 2 * sum(stops_s),
        # Also the Python that an environment was made of, and a checkout that is installed in place.
        home="read-only" if _is_below_home(command, folder, Path(sys.base_prefix), Path(__file__)) else "yes",
        written=" ".join(str(path) for path in written),
    )


def _is_below_home(*paths: Path) -> bool:
    """Says whether any of these can be read only where home folders can."""
    return any(str(path.resolve()).startswith(("/home/", "/root/", "/run/user/")) for path in paths)

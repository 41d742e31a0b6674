"""The gateway: runs of this machine, and systems elsewhere, over HTTP, and the page that shows them.

It stands above `aos_deploy`, since it reads runs as the commands do. It starts `aos-up` as a process of its
own. Not in here is how a mission runs: it asks a system, and reads what that has written.
"""

"""The look at a database that a stranger may have sent: is it made of plain tables?

A view or a computed column is a program. SQLite runs it for whoever reads, who waits for ever, out of reach
of Ctrl-C, where it has no end.
"""

import sqlite3


def require_plain_tables(connection: sqlite3.Connection) -> None:
    """Raises sqlite3.DatabaseError where something that can be read is no plain table."""
    found = connection.execute("SELECT name, type, sql FROM sqlite_schema WHERE type IN ('table', 'view')")
    for name, kind, sql in found.fetchall():
        is_table = kind == "table" and not str(sql).lstrip().upper().startswith("CREATE VIRTUAL")
        columns = connection.execute("SELECT hidden FROM pragma_table_xinfo(?)", (name,)) if is_table else ()
        if not is_table or any(hidden for (hidden,) in columns):
            raise sqlite3.DatabaseError(f"{name} is no plain table")
